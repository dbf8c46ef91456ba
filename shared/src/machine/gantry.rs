//! The gantries of a machine: the command of each second motor, and the skew of each beam.
//!
//! | | command of the second motor less that of the first | skew is counted from |
//! |---|---|---|
//! | off, or held | as the motors are | as below |
//! | not homed | as when the drives came on | the positions at power-up, or at the last settings |
//! | both references known | goes to 0 at [`SQUARING_M_PER_S`](crate::config::GantrySettings::SQUARING_M_PER_S) | 0: the square beam |
//!
//! Both motors have the command of one path, in which the second has no coordinate: this is added behind the path, so that curves, look-ahead
//! and filters are those of an axis with one motor.

use crate::config::GantryConfig;
use crate::units::Position;

/// A gantry.
#[derive(Clone, Copy, Debug)]
struct Gantry {
    config: GantryConfig,
    /// Command of the second motor less that of the first, position units.
    offset: i64,
    /// Position of the second motor less that of the first without skew, as far as it is known.
    zero: i64,
    /// Whether the references of both motors are known, so that the beam is made square.
    is_referenced: bool,
    /// The last skew.
    skew: i64,
}

/// The gantries of N axes, each at the axis of its second motor.
#[derive(Clone, Debug)]
pub(super) struct Gantries<const N: usize> {
    of_second: [Option<Gantry>; N],
}

impl<const N: usize> Gantries<N> {
    /// No gantry.
    pub const NONE: Self = Self { of_second: [None; N] };

    /// At rest at absolute positions.
    pub fn reset(&mut self, configs: &[Option<GantryConfig>; N], start: &[Position; N]) {
        let new = |config| Gantry { config, offset: 0, zero: 0, is_referenced: true, skew: 0 };
        self.of_second = configs.map(|config| config.map(new));
        self.rest_at(start);
    }

    /// The commands of the path, with those of the second motors.
    pub fn couple(&self, commands: &mut [Position; N]) {
        for (second, gantry) in self.of_second.iter().enumerate() {
            let Some(gantry) = gantry else { continue };
            if let Some(first) = commands.get(gantry.config.first).copied()
                && let Some(command) = commands.get_mut(second)
            {
                *command = first + gantry.offset;
            }
        }
    }

    /// The next position tick: the second motors are moved towards a square beam.
    pub fn advance(&mut self) {
        for gantry in self.of_second.iter_mut().flatten().filter(|gantry| gantry.is_referenced) {
            let step = gantry.config.squaring_step;
            // Not `clamp`, which could panic.
            gantry.offset -= gantry.offset.max(-step).min(step);
        }
    }

    /// The machine rests at commands.
    pub fn rest_at(&mut self, commands: &[Position; N]) {
        for (gantry, difference) in self.with_differences(commands) {
            (gantry.offset, gantry.skew) = (difference, difference - gantry.zero);
        }
    }

    /// The axis of the first gantry with more skew than its limit at positions.
    pub fn skewed(&mut self, positions: &[Position; N]) -> Option<usize> {
        for (gantry, difference) in self.with_differences(positions) {
            gantry.skew = difference - gantry.zero;
        }
        self.of_second.iter().position(|gantry| {
            gantry.is_some_and(|gantry| gantry.skew.unsigned_abs() > gantry.config.skew_limit)
        })
    }

    /// Each gantry, with the position of its second motor less that of its first.
    fn with_differences<'a>(
        &'a mut self,
        positions: &'a [Position; N],
    ) -> impl Iterator<Item = (&'a mut Gantry, i64)> {
        self.of_second.iter_mut().zip(positions).filter_map(|(gantry, second)| {
            let gantry = gantry.as_mut()?;
            let first = positions.get(gantry.config.first)?;
            Some((gantry, *second - *first))
        })
    }

    /// The readings and the command of an axis have been shifted.
    pub fn shift(&mut self, axis: usize, shift: i64) {
        for (second, gantry) in self.of_second.iter_mut().enumerate() {
            let Some(gantry) = gantry else { continue };
            let shift = if axis == second {
                shift
            } else if axis == gantry.config.first {
                -shift
            } else {
                continue;
            };
            (gantry.offset, gantry.zero) = (gantry.offset + shift, gantry.zero + shift);
        }
    }

    /// The references of both motors of a gantry are known from here on, or unknown. Skew goes on from the same positions if they are lost.
    pub fn set_referenced(&mut self, second: usize, is_referenced: bool) {
        if let Some(gantry) = self.gantry_mut(second) {
            gantry.is_referenced = is_referenced;
            if is_referenced {
                gantry.zero = 0;
            }
        }
    }

    /// Takes the present difference of the motors of a gantry as that without skew.
    pub fn set_zero(&mut self, second: usize) {
        if let Some(gantry) = self.gantry_mut(second) {
            (gantry.zero, gantry.skew) = (gantry.offset, 0);
        }
    }

    fn gantry_mut(&mut self, second: usize) -> Option<&mut Gantry> {
        self.of_second.get_mut(second)?.as_mut()
    }

    /// Whether the second motor has the command of a square beam.
    pub fn is_square(&self, second: usize) -> bool {
        let gantry = self.of_second.get(second).and_then(Option::as_ref);
        gantry.is_some_and(|gantry| gantry.is_referenced && gantry.offset == 0)
    }

    /// The last skew of the gantry of a second motor, position units.
    pub fn skew(&self, second: usize) -> Option<i64> {
        Some(self.of_second.get(second)?.as_ref()?.skew)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: GantryConfig = GantryConfig { first: 1, skew_limit: 50, squaring_step: 4 };

    fn gantries() -> Gantries<3> {
        let mut gantries = Gantries::NONE;
        gantries.reset(&[None, None, Some(CONFIG)], &at([7, 100, 110]));
        gantries
    }

    fn at(units: [i64; 3]) -> [Position; 3] {
        units.map(Position)
    }

    fn coupled(gantries: &Gantries<3>, units: [i64; 3]) -> [Position; 3] {
        let mut commands = at(units);
        gantries.couple(&mut commands);
        commands
    }

    /// 10 units at 4 per tick: 6, 2, 0, and it stays there.
    #[test]
    fn a_second_motor_goes_from_where_it_is_to_the_command_of_the_first() {
        let mut gantries = gantries();
        assert_eq!(coupled(&gantries, [1, 200, -5]), at([1, 200, 210]));
        for (offset, is_square) in [(6, false), (2, false), (0, true), (0, true)] {
            gantries.advance();
            assert_eq!(coupled(&gantries, [1, 200, -5]), at([1, 200, 200 + offset]));
            assert_eq!(gantries.is_square(2), is_square);
        }
    }

    /// The limit itself is allowed in both directions, and one unit more is not.
    #[test]
    fn skew_beyond_the_limit_is_that_of_the_second_motor() {
        let mut gantries = gantries();
        for (second, expected) in [(1050, None), (1051, Some(2)), (950, None), (949, Some(2))] {
            assert_eq!(gantries.skewed(&at([0, 1000, second])), expected, "{second}");
            assert_eq!(gantries.skew(2), Some(second - 1000));
        }
        assert_eq!((gantries.skew(1), gantries.skew(7)), (None, None));
    }

    /// Where the machine rests, skew is counted from the difference without skew as well: 25 units less 10.
    #[test]
    fn skew_at_rest_is_counted_from_the_difference_without_skew() {
        let mut gantries = gantries();
        gantries.set_zero(2);
        assert_eq!(gantries.skew(2), Some(0));
        gantries.rest_at(&at([0, 100, 125]));
        assert_eq!(gantries.skew(2), Some(15));
    }

    /// Without references the beam is neither square nor moved, and its skew is that from where it was, also when an origin is shifted.
    #[test]
    fn an_origin_is_no_skew_and_a_lost_reference_keeps_the_difference() {
        let mut gantries = gantries();
        gantries.set_referenced(2, false);
        gantries.rest_at(&at([0, 0, 30]));
        gantries.advance();
        assert_eq!((coupled(&gantries, [0; 3])[2], gantries.skew(2)), (Position(30), Some(30)));
        gantries.shift(1, 1000);
        gantries.shift(2, -500);
        assert_eq!(gantries.skewed(&at([0, 1000, -470])), None);
        assert_eq!((gantries.skew(2), coupled(&gantries, [0, 1000, 0])[2]), (Some(30), Position(-470)));
        gantries.set_zero(2);
        assert_eq!(gantries.skewed(&at([0, 1000, -470])), None);
        assert_eq!(gantries.skew(2), Some(0));
        gantries.set_referenced(2, true);
        assert_eq!((gantries.skewed(&at([0, 1000, -470])), gantries.is_square(2)), (Some(2), false));
    }
}
