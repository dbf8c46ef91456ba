//! A circular arc in the plane of two of N axes.
//!
//! The radius vector of the start point is turned by the phase that belongs to the distance:
//! x = cx + dx·cos φ − dy·sin φ, y = cy + dx·sin φ + dy·cos φ. So the arc starts on its start point
//! exactly, and a whole turn closes exactly. An end point that is given, and lies on the circle only to
//! the digits it was written with, is met exactly: what it is off is spread evenly over the arc.

use super::error::{Field, PathError};
use super::turn::{ONE, sin_cos};
use crate::integer::{mul_high, mul_q32, mul_shift};
use crate::units::{PER_M, PER_NM, Position, TRAVEL_LIMIT_M};

/// 2π with 61 fraction bits.
const TAU_Q61: u128 = 14_488_038_916_154_245_685;

/// Turns that keep the phase within 0.1 nm on a radius of 1 m.
const MOST_TURNS: f64 = 1000.0;

/// One turn, of which turns have 48 fraction bits.
const TURN_Q48: f64 = 281_474_976_710_656.0;

/// An end point may lie so far off the circle, nm: coordinates written in µm do.
pub const END_TOLERANCE_NM: i64 = 2000;

/// The travel, position units.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "100 m")]
const MOST_REACH: u128 = (TRAVEL_LIMIT_M * PER_M) as u128;

/// And by no more than this share of the arc's length, 32 fraction bits: a 1024th.
const MOST_OFF_PER_LENGTH: u128 = 1 << 22;

/// An arc as a function of the distance along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arc<const N: usize> {
    start: [Position; N],
    end: [Position; N],
    plane: [usize; 2],
    centre: [Position; 2],
    /// Start − centre, position units.
    radius: [i64; 2],
    /// Turns per position unit, with `phase_shift` + 64 fraction bits: 62 bits of it, so that the phase at the
    /// end of the longest arc is exact to 2⁻⁶¹ of it.
    phase_per_unit: u64,
    phase_shift: u32,
    clockwise: bool,
    length: i64,
    /// Length of the radius, position units.
    curvature_radius: i64,
    off: Option<Off>,
}

/// How far the given end lies off the circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Off {
    /// In the axes of the plane, position units.
    by: [i64; 2],
    /// Of the arc, per position unit, with `shift` + 32 fraction bits.
    share_per_unit: u64,
    shift: u32,
    /// Of the length, 32 fraction bits.
    per_length: u64,
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
        if !turns.is_finite() {
            return Err(PathError::NotFinite(Field::Turns));
        }
        if turns == 0.0 {
            return Err(PathError::ZeroLength);
        }
        if turns.abs() > MOST_TURNS {
            return Err(PathError::TooLarge(Field::Turns));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 < turns ≤ 1000: below 2⁵⁸"
        )]
        let turns_q48 = libm::rint(libm::fabs(turns) * TURN_Q48) as u64;
        let mut arc = Self::circle(start, plane, centre)?;
        arc.clockwise = turns < 0.0;
        let length = (u128::from(arc.length.unsigned_abs()) * u128::from(turns_q48)) >> 48;
        arc.length = i64::try_from(length).map_err(|_| PathError::TooLarge(Field::Turns))?;
        if arc.length == 0 {
            return Err(PathError::ZeroLength);
        }
        // The fraction of a turn decides the end point; whole turns end where they start.
        arc.end = arc.turned(turns_q48 << 16);
        Ok(arc)
    }

    /// Plans the arc from `start` around `centre` to `end` (both in the plane's two axes).
    ///
    /// # Errors
    /// As [`Arc::plan`]; [`PathError::CoincidentEndPoints`] where start and end are one point,
    /// [`PathError::EndOffArc`] where the end lies further off the circle than [`END_TOLERANCE_NM`].
    pub fn plan_to(
        start: [Position; N],
        plane: [usize; 2],
        centre: [Position; 2],
        end: [Position; 2],
        positive: bool,
    ) -> Result<Self, PathError> {
        let circle = Self::circle(start, plane, centre)?;
        let to = [end[0] - centre[0], end[1] - centre[1]];
        if to == circle.radius {
            return Err(PathError::CoincidentEndPoints);
        }
        let off = length_of(to).abs_diff(circle.curvature_radius.unsigned_abs().into());
        if off > u128::from((END_TOLERANCE_NM * PER_NM).unsigned_abs()) {
            return Err(PathError::EndOffArc);
        }
        let angle = |[x, y]: [i64; 2]| libm::atan2(y as f64, x as f64) / core::f64::consts::TAU;
        let turn = angle(to) - angle(circle.radius);
        let forward = if turn > 0.0 { turn } else { turn + 1.0 };
        let mut arc = Self::plan(start, plane, centre, if positive { forward } else { forward - 1.0 })?;
        let [x, y] = plane;
        let (Some(end_x), Some(end_y)) = (arc.end.get_mut(x).copied(), arc.end.get_mut(y).copied()) else {
            return Err(PathError::BadPlane);
        };
        let by = [end[0] - end_x, end[1] - end_y];
        let length = u128::from(arc.length.unsigned_abs().max(1));
        let per_length = (length_of(by) << 32) / length;
        if off > 0 && per_length > MOST_OFF_PER_LENGTH {
            return Err(PathError::EndOffArc);
        }
        // 63 or 64 bits of it, whatever the length.
        let shift = length.ilog2();
        #[expect(clippy::cast_possible_truncation, reason = "see above, and at most 2²²")]
        let (share_per_unit, per_length) = (((1u128 << (shift + 63)) / length) as u64, per_length as u64);
        arc.off = (by != [0; 2]).then_some(Off { by, share_per_unit, shift: shift + 31, per_length });
        for (axis, place) in plane.into_iter().zip(end) {
            if let Some(end) = arc.end.get_mut(axis) {
                *end = place;
            }
        }
        Ok(arc)
    }

    /// One whole turn.
    fn circle(start: [Position; N], plane: [usize; 2], centre: [Position; 2]) -> Result<Self, PathError> {
        let [first, second] = plane;
        let (Some(&x), Some(&y)) = (start.get(first), start.get(second)) else {
            return Err(PathError::BadPlane);
        };
        if first == second {
            return Err(PathError::BadPlane);
        }
        let radius = [x - centre[0], y - centre[1]];
        let length_of_radius = length_of(radius);
        // All of the circle lies within the travel.
        let reach = |c: Position| u128::from((c - Position(0)).unsigned_abs()) + length_of_radius;
        if centre.into_iter().any(|c| reach(c) > MOST_REACH) {
            return Err(PathError::TooLarge(Field::Centre));
        }
        if length_of_radius < 1000 * u128::from(PER_NM.unsigned_abs()) {
            return Err(PathError::ZeroRadius);
        }
        // 2πR, with R below 2⁵⁹, is below 2⁶².
        let circumference = (length_of_radius * TAU_Q61) >> 61;
        // 2^(shift + 64)/circumference has 63 or 64 bits; by the least radius the shift is 31 at least.
        let phase_shift = circumference.ilog2() - 1;
        #[expect(clippy::cast_possible_truncation, reason = "see above")]
        Ok(Self {
            start,
            end: start,
            plane,
            centre,
            radius,
            phase_per_unit: ((1u128 << (phase_shift + 64)) / circumference) as u64,
            phase_shift,
            clockwise: false,
            length: circumference as i64,
            curvature_radius: length_of_radius as i64,
            off: None,
        })
    }

    /// Distance from start to end along the arc, position units.
    #[must_use]
    pub const fn length(&self) -> i64 {
        self.length
    }

    /// Length of the radius, position units.
    #[must_use]
    pub const fn curvature_radius(&self) -> i64 {
        self.curvature_radius
    }

    /// How far the arc is drawn aside to its given end, as a share of its length, 32 fraction bits.
    #[must_use]
    pub fn off_per_length(&self) -> u64 {
        self.off.as_ref().map_or(0, |off| off.per_length)
    }

    /// Where the arc ends.
    #[must_use]
    pub const fn end(&self) -> [Position; N] {
        self.end
    }

    /// The least and the greatest position of each axis, to the 2 µm that the arc may be drawn aside to its end.
    #[must_use]
    pub fn extent(&self) -> [[Position; 2]; N] {
        let mut extent =
            core::array::from_fn(|i| [self.start[i].min(self.end[i]), self.start[i].max(self.end[i])]);
        let [x, y] = self.radius.map(|r| r as f64);
        let turns = self.length as f64 / (core::f64::consts::TAU * self.curvature_radius as f64);
        let from = libm::atan2(y, x) / core::f64::consts::TAU;
        let [from, to] = if self.clockwise { [from - turns, from] } else { [from, from + turns] };
        // A quarter of the circle is passed where a whole number of turns brings it between start and end.
        let passes = |quarter: f64| libm::ceil(from - quarter) <= to - quarter;
        let radius = self.curvature_radius;
        for ((axis, centre), quarter) in self.plane.into_iter().zip(self.centre).zip([0.0, 0.25]) {
            let Some([least, greatest]) = extent.get_mut(axis) else { continue };
            if passes(quarter) {
                *greatest = (*greatest).max(centre + radius);
            }
            if passes(quarter + 0.5) {
                *least = (*least).min(centre - radius);
            }
        }
        extent
    }

    /// Direction of travel at a distance from the start, 62 fraction bits.
    #[must_use]
    pub fn direction(&self, distance: i64) -> [i64; N] {
        let mut direction = [0; N];
        let (sine, cosine) = self.phase(self.phase_of(distance));
        // The radius of length one, turned by the phase and a quarter more.
        let length = i128::from(self.curvature_radius.max(1));
        #[expect(clippy::cast_possible_truncation, reason = "at most the length")]
        let [x, y] = self.radius.map(|r| (i128::from(r) * i128::from(ONE) / length) as i64);
        let sign = if self.clockwise { -1 } else { 1 };
        let tangent = [
            -(mul_shift::<62>(x, sine) + mul_shift::<62>(y, cosine)) * sign,
            (mul_shift::<62>(x, cosine) - mul_shift::<62>(y, sine)) * sign,
        ];
        let aside = self.off.as_ref().map_or([0; 2], |off| {
            #[expect(clippy::cast_possible_truncation, reason = "a 1024th at most")]
            off.by.map(|by| ((i128::from(by) << 62) / i128::from(self.length.max(1))) as i64)
        });
        for ((axis, along), aside) in self.plane.into_iter().zip(tangent).zip(aside) {
            if let Some(place) = direction.get_mut(axis) {
                *place = along + aside;
            }
        }
        direction
    }

    /// The point at a distance from the start.
    #[must_use]
    pub fn at(&self, distance: i64) -> [Position; N] {
        let mut point = self.turned(self.phase_of(distance));
        if let Some(off) = &self.off {
            let part = (u128::from(distance.unsigned_abs()) * u128::from(off.share_per_unit)) >> off.shift;
            let part = u32::try_from(part).unwrap_or(u32::MAX);
            for (axis, by) in self.plane.into_iter().zip(off.by) {
                if let Some(place) = point.get_mut(axis) {
                    *place += mul_q32(by, part);
                }
            }
        }
        point
    }

    /// The phase for a distance, 2⁶⁴ a turn; whole turns drop out.
    fn phase_of(&self, distance: i64) -> u64 {
        let phase =
            (u128::from(distance.unsigned_abs()) * u128::from(self.phase_per_unit)) >> self.phase_shift;
        #[expect(clippy::cast_possible_truncation, reason = "whole turns drop out")]
        let phase = phase as u64;
        phase
    }

    /// Sine and cosine of a phase in the arc's direction.
    fn phase(&self, phase: u64) -> (i64, i64) {
        sin_cos(if self.clockwise { phase.wrapping_neg() } else { phase })
    }

    /// The start point turned about the centre by a phase (2⁶⁴ a turn) in the arc's direction.
    fn turned(&self, phase: u64) -> [Position; N] {
        let (sine, cosine) = self.phase(phase);
        // Two more fraction bits, so that the products together are within a unit.
        let [dx, dy] = self.radius.map(|r| r << 4);
        let rounded = |quarters: i64| (quarters + 2) >> 2;
        let x = self.centre[0] + rounded(mul_high(dx, cosine) - mul_high(dy, sine));
        let y = self.centre[1] + rounded(mul_high(dx, sine) + mul_high(dy, cosine));
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

/// √(x² + y²), rounded down.
fn length_of(vector: [i64; 2]) -> u128 {
    let [x, y] = vector.map(|r| u128::from(r.unsigned_abs()).pow(2));
    (x + y).isqrt()
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
                (square(p[0] - about[0]) + square(p[1] - about[1])).unsigned_abs().isqrt()
            };
            let distance = (arc.length() as f64 * way) as i64;
            let off = r(arc.at(distance)).abs_diff(r(start));
            prop_assert!(off < u128::from(PER_NM.unsigned_abs()) / 10, "{off} units off");
            // The last point before the end joins it: 2π·R·turns fits the phase to 0.1 nm.
            let last = arc.at(arc.length());
            prop_assert!((last[0] - start[0]).abs() < PER_NM / 5);
            prop_assert!((last[1] - start[1]).abs() < PER_NM / 5);
        }
    }

    proptest! {
        /// Every point lies within the extent, and the extent is no larger than the points: of 4096 of them one lies
        /// within half a step, 2πR·turns/8192, of an extreme, and there R·(1 − cos) = step²/2R short of it.
        #[test]
        fn reaches_its_extent_and_no_further(
            radius in 1e-3..1.0f64, angle in 0.0..core::f64::consts::TAU, turns in -1.5..1.5f64,
        ) {
            prop_assume!(turns.abs() > 1e-3);
            let start = [metres(radius * angle.cos()), metres(radius * angle.sin())];
            let arc = Arc::plan(start, [0, 1], [metres(0.0); 2], turns).unwrap();
            let [mut least, mut greatest] = [start; 2];
            for k in 0..=4096 {
                let point = arc.at((i128::from(arc.length()) * k / 4096) as i64);
                least = core::array::from_fn(|i| least[i].min(point[i]));
                greatest = core::array::from_fn(|i| greatest[i].max(point[i]));
            }
            let half_step = arc.length() as f64 / 8192.0;
            let short = (half_step * half_step / 2.0 / arc.curvature_radius() as f64) as i64 + PER_NM;
            for (i, [low, high]) in arc.extent().into_iter().enumerate() {
                prop_assert!((-PER_NM..=short).contains(&(least[i] - low)), "{i}: {}", least[i] - low);
                prop_assert!((-PER_NM..=short).contains(&(high - greatest[i])), "{i}: {}", high - greatest[i]);
            }
        }
    }

    #[test]
    fn a_quarter_turn_ends_where_geometry_says() {
        let arc = Arc::plan([metres(0.05), metres(0.0)], [0, 1], [metres(0.0); 2], 0.25).unwrap();
        assert_eq!(arc.end(), [metres(0.0), metres(0.05)]);
        // 2π·50 mm/4 = 78.539816339744831 mm, to a position unit of circumference.
        let exact = (0.05 * core::f64::consts::FRAC_PI_2 * PER_M) as i64;
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
