//! A circular arc in the plane of two of N axes.
//!
//! The radius vector of the start point is turned by the phase that belongs to the distance:
//! x = cx + dx·cos φ − dy·sin φ, y = cy + dx·sin φ + dy·cos φ. So the arc starts on its start point
//! exactly, and a whole turn closes exactly.

use super::turn::sin_cos;
use super::{Field, PathError, scaled};
use crate::units::{PER_NM, Position};

/// 2π with 61 fraction bits.
const TAU_Q61: u128 = 14_488_038_916_154_245_685;

/// Turns that keep the phase within 0.1 nm on a radius of 1 m.
const MOST_TURNS: f64 = 1000.0;

/// An arc as a function of the distance along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arc<const N: usize> {
    start: [Position; N],
    end: [Position; N],
    plane: [usize; 2],
    centre: [Position; 2],
    /// Start − centre, position units.
    radius: [i64; 2],
    /// 2⁻⁹⁶ turns per position unit, sign included in `clockwise`.
    phase_per_unit: u64,
    clockwise: bool,
    length: i64,
}

impl<const N: usize> Arc<N> {
    /// Plans the arc from `start` around `centre` (in the plane's two axes) by a signed number of
    /// turns, positive from the plane's first axis towards its second.
    ///
    /// # Errors
    /// [`PathError::BadPlane`], [`PathError::ZeroRadius`], and for turns that are zero, not finite or
    /// more than 1000 either way the error that names them.
    pub fn plan(
        start: [Position; N],
        plane: [usize; 2],
        centre: [Position; 2],
        turns: f64,
    ) -> Result<Self, PathError> {
        let [first, second] = plane;
        let (Some(&x), Some(&y)) = (start.get(first), start.get(second)) else {
            return Err(PathError::BadPlane);
        };
        if first == second {
            return Err(PathError::BadPlane);
        }
        if !turns.is_finite() {
            return Err(PathError::NotFinite(Field::Turns));
        }
        if turns == 0.0 {
            return Err(PathError::ZeroLength);
        }
        if turns.abs() > MOST_TURNS {
            return Err(PathError::TooLarge(Field::Turns));
        }
        let radius = [x.beyond(centre[0]), y.beyond(centre[1])];
        let squares = radius.map(|r| u128::from(r.unsigned_abs()).pow(2));
        let length_of_radius = (squares[0] + squares[1]).isqrt();
        if length_of_radius < 1000 * u128::from(PER_NM.unsigned_abs()) {
            return Err(PathError::ZeroRadius);
        }
        // One turn: 2πR, with R below 2⁵⁹ the product stays below 2¹²³.
        let circumference = (length_of_radius * TAU_Q61) >> 61;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 < turns ≤ 1000: below 2⁴²; the phase rate is below 2⁶⁴ by the least radius"
        )]
        let (turns_q32, phase_per_unit) =
            (libm::rint(libm::fabs(turns) * 4_294_967_296.0) as u128, ((1u128 << 96) / circumference) as u64);
        // circumference < 2⁶²·turns < 2¹⁰ could leave i64: such an arc is 4,000 km long.
        let length = ((circumference >> 8) * turns_q32) >> 24;
        let length = i64::try_from(length).map_err(|_| PathError::TooLarge(Field::Turns))?;
        let mut arc =
            Self { start, end: start, plane, centre, radius, phase_per_unit, clockwise: turns < 0.0, length };
        // The fraction of a turn decides the end point; whole turns end where they start.
        #[expect(clippy::cast_possible_truncation, reason = "the lower 32 bits are the fraction")]
        let fraction = (turns_q32 as u64) << 32;
        arc.end = arc.turned(fraction);
        Ok(arc)
    }

    /// Distance from start to end along the arc, position units.
    #[must_use]
    pub const fn length(&self) -> i64 {
        self.length
    }

    /// Where the arc ends.
    #[must_use]
    pub const fn end(&self) -> [Position; N] {
        self.end
    }

    /// The point at a distance from the start.
    #[must_use]
    pub fn at(&self, distance: i64) -> [Position; N] {
        let phase = (u128::from(distance.unsigned_abs()) * u128::from(self.phase_per_unit)) >> 32;
        #[expect(clippy::cast_possible_truncation, reason = "whole turns drop out")]
        self.turned(phase as u64)
    }

    /// The start point turned about the centre by a phase (2⁶⁴ a turn) in the arc's direction.
    fn turned(&self, phase: u64) -> [Position; N] {
        let (sine, cosine) = sin_cos(if self.clockwise { phase.wrapping_neg() } else { phase });
        let [dx, dy] = self.radius;
        let x = self.centre[0].moved(scaled::<62>(dx, cosine).wrapping_sub(scaled::<62>(dy, sine)));
        let y = self.centre[1].moved(scaled::<62>(dx, sine).wrapping_add(scaled::<62>(dy, cosine)));
        let mut point = self.start;
        // `get_mut` leaves no panic behind; `plan` has checked the plane.
        if let Some(place) = point.get_mut(self.plane[0]) {
            *place = x;
        }
        if let Some(place) = point.get_mut(self.plane[1]) {
            *place = y;
        }
        point
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "lengths below 2⁵³ as f64 and back")]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn metres(m: f64) -> Position {
        Position::from_m(m).unwrap()
    }

    proptest! {
        /// Radius 1 mm to 1 m anywhere on ±2 m: every point lies within 0.1 nm of the circle (20 pm of
        /// sine, the rounding of the radius), and a whole number of turns closes exactly.
        #[test]
        fn stays_on_the_circle(
            centre in -2.0..2.0f64, radius in 1e-3..1.0f64, angle in 0.0..core::f64::consts::TAU, way in 0.0..1.0f64,
            turns in -3i32..=3,
        ) {
            prop_assume!(turns != 0);
            let start = [metres(centre + radius * angle.cos()), metres(-centre + radius * angle.sin())];
            let about = [metres(centre), metres(-centre)];
            let arc = Arc::plan(start, [0, 1], about, f64::from(turns)).unwrap();
            prop_assert_eq!(arc.end(), start);
            let r = |p: [Position; 2]| {
                let square = |d: i64| i128::from(d) * i128::from(d);
                (square(p[0].beyond(about[0])) + square(p[1].beyond(about[1]))).unsigned_abs().isqrt()
            };
            let distance = (arc.length() as f64 * way) as i64;
            let off = r(arc.at(distance)).abs_diff(r(start));
            prop_assert!(off < u128::from(PER_NM.unsigned_abs()) / 10, "{off} units off");
            // The last point before the end joins it: 2π·R·turns fits the phase to 0.1 nm.
            let last = arc.at(arc.length());
            prop_assert!(last[0].beyond(start[0]).abs() < PER_NM / 5);
            prop_assert!(last[1].beyond(start[1]).abs() < PER_NM / 5);
        }
    }

    #[test]
    fn a_quarter_turn_ends_where_geometry_says() {
        let arc = Arc::plan([metres(0.05), metres(0.0)], [0, 1], [metres(0.0); 2], 0.25).unwrap();
        assert_eq!(arc.end(), [metres(0.0), metres(0.05)]);
        // 2π·50 mm/4 = 78.539816339744831 mm, to a position unit of circumference.
        let exact = (0.05 * core::f64::consts::FRAC_PI_2 * crate::units::PER_M) as i64;
        assert!((arc.length() - exact).abs() < 200, "{}", arc.length() - exact);
    }

    #[test]
    fn refuses_what_is_no_arc() {
        let at = [metres(0.0); 2];
        let plan = |plane, centre, turns| Arc::plan(at, plane, centre, turns).unwrap_err();
        assert_eq!(plan([0, 0], [metres(1.0); 2], 1.0), PathError::BadPlane);
        assert_eq!(plan([0, 2], [metres(1.0); 2], 1.0), PathError::BadPlane);
        assert_eq!(plan([0, 1], at, 1.0), PathError::ZeroRadius);
        assert_eq!(plan([0, 1], [metres(1.0); 2], 0.0), PathError::ZeroLength);
        assert_eq!(plan([0, 1], [metres(1.0); 2], f64::NAN), PathError::NotFinite(Field::Turns));
        assert_eq!(plan([0, 1], [metres(1.0); 2], 1e9), PathError::TooLarge(Field::Turns));
    }
}
