//! From phases to a position: a resolver on a screw, a linear scale, a counter.
//!
//! All of them measure the position within a cycle only. The differences between phases are accumulated in an integer, and
//! the position is a pure function of that sum:
//!
//! ```text
//! travelled += step·(phase − last)      a cycle is step·2³²
//! position   = travelled·pitch/2⁶⁴      rounded down
//! ```
//!
//! so there is no drift, and a phase that recurs gives the same position again.
//!
//! The pitch is a distance, a whole number of position units, over a number of cycles (lead over pole pairs). `step` is a
//! power of two that gives it a relative error of 2⁻⁶¹. A pitch of whole position units is exact; for any other, such as a
//! third of 10 mm, the position error is below a quarter of a unit (0.25 fm) in 100 m, independent of the history.
//!
//! # Example
//!
//! A resolver with 3 pole pairs on a screw of 10 mm lead, turned by a quarter of an electrical cycle.
//!
//! ```
//! use shared::feedback::phase::Phase;
//! use shared::feedback::transducer::Transducer;
//!
//! let mut resolver = Transducer::new(0.01, 3, Phase(0)).unwrap();
//! let position = resolver.read(Phase(1 << 30));
//! assert!((position.to_m() - 0.01 / 3.0 / 4.0).abs() < 1e-15);
//! ```

use super::phase::Phase;
use crate::units::Position;

/// Shortest cycle, m: the sum holds 2³¹ cycles, 107 m.
pub const MIN_PITCH_M: f64 = 50e-9;

/// A sensor that measures a phase, converted to a position.
#[derive(Clone, Copy, Debug)]
pub struct Transducer {
    /// Position units per cycle, times 2³²/step.
    pitch: i64,
    /// 2⁶⁴ over the position units per cycle.
    inverse: i64,
    /// A power of two.
    step: i32,
    last: Phase,
    travelled: i64,
}

impl Transducer {
    /// A transducer with `cycles` cycles in `distance_m` that is at position zero at the phase `start`. The distance is rounded
    /// to a position unit; it is negative if the phase decreases in the positive direction of the axis.
    ///
    /// For a resolver: lead and pole pairs. For a linear scale: pitch and 1, or length and number of cycles. For a 16-bit
    /// counter: 65,536 times the lead, and counts per lead.
    ///
    /// `None` if a cycle is shorter than [`MIN_PITCH_M`] or the distance exceeds [`crate::units::TRAVEL_LIMIT_M`].
    #[must_use]
    pub fn new(distance_m: f64, cycles: u32, start: Phase) -> Option<Self> {
        let distance = Position::from_m(distance_m)?.0;
        if cycles == 0 || distance_m.abs() / f64::from(cycles) < MIN_PITCH_M {
            return None;
        }
        let bits = 64 - (distance.unsigned_abs() / u64::from(cycles)).leading_zeros();
        // A pitch of 30 bits or more is scaled to 62 bits; a shorter one by 2³².
        let step_bits = bits.saturating_sub(30);
        let (distance, cycles) = (i128::from(distance), i128::from(cycles));
        Some(Self {
            pitch: nearest(distance << (32 - step_bits), cycles)?,
            inverse: nearest(cycles << 64, distance)?,
            step: 1 << step_bits,
            last: start,
            travelled: 0,
        })
    }

    /// The position at a phase. It must have moved by less than half a cycle since the last call.
    pub fn read(&mut self, phase: Phase) -> Position {
        let increment = i64::from(phase.difference(self.last)) * i64::from(self.step);
        self.last = phase;
        self.travelled = self.travelled.wrapping_add(increment);
        Position(mul_shift_64(self.travelled, self.pitch, 0))
    }

    /// The position at a phase after the signal was lost for any time. The phase gives the position within a cycle, and `near`
    /// the cycle.
    ///
    /// `near` is the position by another sensor to less than half a cycle: for a scale, the motor position plus their last
    /// difference. If it is further off, the result is wrong by whole cycles.
    pub fn resume(&mut self, phase: Phase, near: Position) -> Position {
        let in_last_cycle = self.read(phase);
        let cycles = mul_shift_64(near - in_last_cycle, self.inverse, 1 << 63);
        let missed = cycles.wrapping_mul(i64::from(self.step)) << 32;
        self.travelled = self.travelled.wrapping_add(missed);
        self.read(phase)
    }
}

/// The nearest integer to a ratio, if it fits.
fn nearest(numerator: i128, denominator: i128) -> Option<i64> {
    let same_sign = numerator.signum() == denominator.signum();
    let half = if same_sign { denominator / 2 } else { -denominator / 2 };
    i64::try_from((numerator + half).checked_div(denominator)?).ok()
}

/// (a·b + rounding)/2⁶⁴, rounded towards −∞.
fn mul_shift_64(a: i64, b: i64, rounding: i128) -> i64 {
    ((i128::from(a) * i128::from(b) + rounding) >> 64) as i64
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const QUARTER: u32 = 1 << 30;

    /// The position after a number of quarters of a cycle, one at a time.
    fn after(transducer: &mut Transducer, quarters: i64) -> Position {
        let mut position = Position(0);
        for _ in 0..quarters.abs() {
            let step = if quarters < 0 { QUARTER.wrapping_neg() } else { QUARTER };
            position = transducer.read(Phase(transducer.last.0.wrapping_add(step)));
        }
        position
    }

    #[test]
    fn a_resolver_of_three_pole_pairs_is_exact_after_whole_turns() {
        // 10 mm is a whole number of position units, a third of it is not.
        let lead = Position::from_m(0.01).unwrap().0;
        let mut resolver = Transducer::new(0.01, 3, Phase(77)).unwrap();
        // 25,000 turns are 250 m, beyond the travel limit: exact to a unit.
        let position = after(&mut resolver, 4 * 3 * 25_000).0;
        assert!((position - 25_000 * lead).abs() <= 1, "{}", position - 25_000 * lead);
        assert_eq!(after(&mut resolver, -4 * 3 * 25_000), Position(0));
    }

    #[test]
    #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
    fn a_scale_of_whole_units_is_exact() {
        // A quarter of 2 mm is a whole number of units.
        let pitch = Position::from_m(0.002).unwrap().0;
        let mut scale = Transducer::new(0.002, 1, Phase(0)).unwrap();
        for quarters in 1..=200_000 {
            assert_eq!(after(&mut scale, 1).0, pitch / 4 * quarters);
        }
    }

    #[test]
    fn a_negative_distance_reverses_the_direction() {
        let mut forward = Transducer::new(0.002, 7, Phase(5)).unwrap();
        let mut reverse = Transducer::new(-0.002, 7, Phase(5)).unwrap();
        for k in 1..1000u32 {
            let phase = Phase(k.wrapping_mul(987_654_321));
            assert!((forward.read(phase).0 + reverse.read(phase).0).abs() <= 1);
        }
    }

    #[test]
    fn invalid_transducers_are_rejected() {
        let invalid = [
            (f64::NAN, 1),
            (f64::INFINITY, 1),
            (0.0, 1),
            (0.01, 0),
            (49e-9, 1),
            (0.01, 1_000_000),
            (101.0, 1),
        ];
        for (distance_m, cycles) in invalid {
            assert!(Transducer::new(distance_m, cycles, Phase(0)).is_none(), "{distance_m} {cycles}");
        }
        assert!(
            Transducer::new(50e-9, 1, Phase(0)).is_some() && Transducer::new(-100.0, 1, Phase(0)).is_some()
        );
    }

    proptest! {
        /// The remainder of the nearest integer is at most half of the denominator, whatever the signs.
        #[test]
        fn a_ratio_is_rounded_to_the_nearest_integer(numerator in -1_000_000i128..1_000_000, denominator in -1000i128..1000) {
            let Some(quotient) = nearest(numerator, denominator) else {
                prop_assert_eq!(denominator, 0);
                return Ok(());
            };
            let remainder = numerator - i128::from(quotient) * denominator;
            prop_assert!(2 * remainder.abs() <= denominator.abs(), "{}", remainder);
        }

        /// However far the axis has moved without a signal, the position is as if the signal had never been lost.
        #[test]
        fn a_signal_that_returns_is_assigned_to_its_cycle(
            nm in 50i64..100_000_000, backwards: bool, cycles in 1u32..1000, start: u32,
            fraction in -1.0f64..1.0, within: u32, off in -0.49f64..0.49,
        ) {
            let distance_m = nm as f64 * 1e-9 * f64::from(cycles) * if backwards { -1.0 } else { 1.0 };
            prop_assume!(distance_m.abs() <= 100.0);
            let pitch_m = distance_m / f64::from(cycles);
            let mut never_lost = Transducer::new(distance_m, cycles, Phase(start)).unwrap();
            let mut lost = never_lost;
            // Up to a hundred metres away.
            #[expect(clippy::cast_possible_truncation, reason = "below 2³¹ cycles")]
            let away = (fraction * 99.0 / pitch_m) as i64;
            let phase = Phase(start.wrapping_add(within));
            never_lost.travelled = (away * i64::from(never_lost.step)) << 32;
            let position = never_lost.read(phase);
            let near = Position::from_m(position.to_m() + off * pitch_m).unwrap();
            prop_assert_eq!(lost.resume(phase, near), position);
            prop_assert_eq!(lost.travelled, never_lost.travelled);
        }

        /// Against the same ratio in 128 bits. Before they are rounded down, both differ by ¼ unit, afterwards by at most one.
        #[test]
        fn any_sequence_of_steps_is_exact(
            nm in 50i64..100_000_000, cycles in 1u32..1000,
            steps in prop::collection::vec(any::<i32>(), 1..200), start: u32,
        ) {
            let distance_m = nm as f64 * 1e-9 * f64::from(cycles);
            prop_assume!(distance_m <= 100.0);
            let mut transducer = Transducer::new(distance_m, cycles, Phase(start)).unwrap();
            let distance = i128::from(Position::from_m(distance_m).unwrap().0);
            let (mut phase, mut sum) = (start, 0i128);
            for step in steps {
                phase = phase.wrapping_add_signed(step);
                sum += i128::from(step);
                let exact = (sum * distance).div_euclid(i128::from(cycles) << 32);
                let found = i128::from(transducer.read(Phase(phase)).0);
                prop_assert!((found - exact).abs() <= 1, "{} {}", found, exact);
            }
        }
    }
}
