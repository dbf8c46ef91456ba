//! A circular arc in the plane of two of N axes.
//!
//! The phase φ grows from that of the start point with the path length: x = cx + R·cos φ, y = cy + R·sin φ. The arc starts
//! within a position unit of its start point, and a full turn closes exactly. A given end point, which lies on the circle only to
//! the digits of the program, is met exactly by [`EndCorrection`].

mod end_correction;
#[cfg(test)]
mod tests;

use end_correction::EndCorrection;

use super::error::{Field, PathError};
use super::sincos::sin_cos;
use crate::integer::{Words, shifted_product};
use crate::units::{PER_M, PER_NM, Position, TRAVEL_LIMIT_M};

/// Fraction bits of the radius, so that a product with a sine has two of them.
const RADIUS_BITS: u32 = 4;

/// 2π with 61 fraction bits.
const TAU_Q61: u128 = 14_488_038_916_154_245_685;

/// Greatest number of turns: it keeps the phase within 0.1 nm on a radius of 1 m.
const MAX_TURNS: f64 = 1000.0;

/// One turn with 48 fraction bits.
const TURN_Q48: f64 = 281_474_976_710_656.0;

/// One turn as a phase.
const TURN_Q64: f64 = 18_446_744_073_709_551_616.0;

/// Greatest distance of a given end point from the circle, nm: enough for coordinates written in µm.
pub const END_TOLERANCE_NM: i64 = 2000;

/// The travel limit, position units.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "100 m")]
const MAX_REACH: u128 = (TRAVEL_LIMIT_M * PER_M) as u128;

/// Greatest end correction as a fraction of the arc length, 32 fraction bits: 1/1024.
const MAX_CORRECTION_PER_LENGTH: u128 = 1 << 22;

/// An arc as a function of path length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arc<const N: usize> {
    start: [Position; N],
    end: [Position; N],
    /// In ascending order.
    plane: [usize; 2],
    /// Position units with two fraction bits, half a unit further: the shift by these then rounds to nearest.
    centre_q2: [i64; 2],
    /// Radius, position units with [`RADIUS_BITS`] fraction bits.
    radius: Words,
    /// Phase of the start point, 2⁶⁴ per turn.
    start_phase: u64,
    /// Turns per position unit with `phase_shift` + 64 fraction bits. It has 64 significant bits, so that the phase at
    /// the end of the longest arc has a relative error of 2⁻⁶¹.
    phase_per_unit: u64,
    phase_shift: u32,
    /// All bits set for an arc in the negative direction.
    backwards: u64,
    length: i64,
    /// Length of the radius, position units.
    curvature_radius: i64,
    correction: Option<EndCorrection>,
}

impl<const N: usize> Arc<N> {
    /// Plans the arc from `start` around `centre` (in the axes of the plane) by a signed number of turns, positive from the
    /// first axis of the plane towards the second.
    ///
    /// # Errors
    /// [`PathError::BadPlane`], [`PathError::ZeroRadius`], [`PathError::TooLarge`] for a circle beyond the travel; for a
    /// number of turns that is zero, not finite or above 1000 in magnitude, the error that names it.
    pub fn plan(
        start: [Position; N],
        plane: [usize; 2],
        centre: [Position; 2],
        turns: f64,
    ) -> Result<Self, PathError> {
        // Seen from the other side, the axes of the plane are in ascending order.
        let ([x, y], [centre_x, centre_y]) = (plane, centre);
        let (plane, centre, turns) =
            if x > y { ([y, x], [centre_y, centre_x], -turns) } else { (plane, centre, turns) };
        if !turns.is_finite() {
            return Err(PathError::NotFinite(Field::Turns));
        }
        if turns == 0.0 {
            return Err(PathError::ZeroLength);
        }
        if turns.abs() > MAX_TURNS {
            return Err(PathError::TooLarge(Field::Turns));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 < turns ≤ 1000: below 2⁵⁸"
        )]
        let turns_q48 = libm::rint(libm::fabs(turns) * TURN_Q48) as u64;
        let mut arc = Self::circle(start, plane, centre)?;
        arc.backwards = if turns < 0.0 { u64::MAX } else { 0 };
        let length = (u128::from(arc.length.unsigned_abs()) * u128::from(turns_q48)) >> 48;
        arc.length = i64::try_from(length).map_err(|_| PathError::TooLarge(Field::Turns))?;
        if arc.length == 0 {
            return Err(PathError::ZeroLength);
        }
        // Whole turns are shifted out: they end at the start point.
        if turns_q48 << 16 != 0 {
            let mut end = start;
            arc.set_on_circle(&mut end, arc.turned_by(turns_q48 << 16));
            arc.end = end;
        }
        Ok(arc)
    }

    /// Plans the arc from `start` around `centre` to `end` (both in the axes of the plane).
    ///
    /// # Errors
    /// As [`Arc::plan`]; [`PathError::CoincidentEndPoints`] if start and end are the same point, [`PathError::EndOffArc`] if
    /// the end lies off the circle by more than [`END_TOLERANCE_NM`].
    pub fn plan_to(
        start: [Position; N],
        plane: [usize; 2],
        centre: [Position; 2],
        end: [Position; 2],
        positive: bool,
    ) -> Result<Self, PathError> {
        let ([x, y], [centre_x, centre_y], [end_x, end_y]) = (plane, centre, end);
        let (plane, centre, end, positive) = if x > y {
            ([y, x], [centre_y, centre_x], [end_y, end_x], !positive)
        } else {
            (plane, centre, end, positive)
        };
        let circle = Self::circle(start, plane, centre)?;
        let to = [end[0] - centre[0], end[1] - centre[1]];
        if plane.map(|axis| start.get(axis).copied()) == end.map(Some) {
            return Err(PathError::CoincidentEndPoints);
        }
        let off = magnitude(to).abs_diff(circle.curvature_radius.unsigned_abs().into());
        if off > u128::from((END_TOLERANCE_NM * PER_NM).unsigned_abs()) {
            return Err(PathError::EndOffArc);
        }
        let turn = phase_of(to).wrapping_sub(circle.start_phase);
        let forward = if turn == 0 { 1.0 } else { turn as f64 / TURN_Q64 };
        let mut arc = Self::plan(start, plane, centre, if positive { forward } else { forward - 1.0 })?;
        let [x, y] = plane;
        let (Some(end_x), Some(end_y)) = (arc.end.get_mut(x).copied(), arc.end.get_mut(y).copied()) else {
            return Err(PathError::BadPlane);
        };
        let difference = [end[0] - end_x, end[1] - end_y];
        let length = u128::from(arc.length.unsigned_abs().max(1));
        let per_length = (magnitude(difference) << 32) / length;
        if off > 0 && per_length > MAX_CORRECTION_PER_LENGTH {
            return Err(PathError::EndOffArc);
        }
        arc.correction = EndCorrection::new(difference, length, per_length);
        for (axis, position) in plane.into_iter().zip(end) {
            if let Some(end) = arc.end.get_mut(axis) {
                *end = position;
            }
        }
        Ok(arc)
    }

    /// One full turn.
    fn circle(start: [Position; N], plane: [usize; 2], centre: [Position; 2]) -> Result<Self, PathError> {
        let [first, second] = plane;
        let (Some(&x), Some(&y)) = (start.get(first), start.get(second)) else {
            return Err(PathError::BadPlane);
        };
        if first == second {
            return Err(PathError::BadPlane);
        }
        let radius = [x - centre[0], y - centre[1]];
        let radius_q4 = magnitude(radius.map(|r| r << RADIUS_BITS));
        let curvature_radius = radius_q4 >> RADIUS_BITS;
        // The whole circle must lie within the travel limit.
        let reach = |c: Position| u128::from((c - Position(0)).unsigned_abs()) + curvature_radius;
        if centre.into_iter().any(|c| reach(c) > MAX_REACH) {
            return Err(PathError::TooLarge(Field::Centre));
        }
        if curvature_radius < 1000 * u128::from(PER_NM.unsigned_abs()) {
            return Err(PathError::ZeroRadius);
        }
        // 2πR, with R below 2⁵⁹, is below 2⁶².
        let circumference = (curvature_radius * TAU_Q61) >> 61;
        // 2^(shift + 64)/circumference has 64 bits. With the least radius the shift is at least 32.
        let phase_shift = circumference.ilog2();
        let phase_per_unit = ((1u128 << (phase_shift + 64)) / circumference).min(u128::from(u64::MAX));
        #[expect(clippy::cast_possible_truncation, reason = "see above")]
        Ok(Self {
            start,
            end: start,
            plane,
            centre_q2: centre.map(|c| ((c - Position(0)) << 2) + 2),
            radius: Words::of(radius_q4 as i64),
            start_phase: phase_of(radius),
            phase_per_unit: phase_per_unit as u64,
            phase_shift,
            backwards: 0,
            length: circumference as i64,
            curvature_radius: curvature_radius as i64,
            correction: None,
        })
    }

    /// Length of the arc, position units.
    #[must_use]
    pub const fn length(&self) -> i64 {
        self.length
    }

    /// Radius, position units.
    #[must_use]
    pub const fn curvature_radius(&self) -> i64 {
        self.curvature_radius
    }

    /// Magnitude of the end correction as a fraction of the arc length, 32 fraction bits.
    #[must_use]
    pub fn correction_per_length(&self) -> u64 {
        self.correction.as_ref().map_or(0, EndCorrection::per_length)
    }

    /// End point.
    #[must_use]
    pub const fn end(&self) -> [Position; N] {
        self.end
    }

    /// The least and the greatest position of each axis, without the end correction (at most 2 µm).
    #[must_use]
    pub fn bounds(&self) -> [[Position; 2]; N] {
        let mut bounds =
            core::array::from_fn(|i| [self.start[i].min(self.end[i]), self.start[i].max(self.end[i])]);
        let turns = self.length as f64 / (core::f64::consts::TAU * self.curvature_radius as f64);
        let from = self.start_phase as f64 / TURN_Q64;
        let [from, to] = if self.backwards != 0 { [from - turns, from] } else { [from, from + turns] };
        // The arc passes an angle if the angle plus a whole number of turns lies between its ends.
        let passes = |angle: f64| libm::ceil(from - angle) <= to - angle;
        let radius = self.curvature_radius;
        let centre = self.centre_q2.map(|centre| Position(centre >> 2));
        for ((axis, centre), angle) in self.plane.into_iter().zip(centre).zip([0.0, 0.25]) {
            let Some([min, max]) = bounds.get_mut(axis) else { continue };
            if passes(angle) {
                *max = (*max).max(centre + radius);
            }
            if passes(angle + 0.5) {
                *min = (*min).min(centre - radius);
            }
        }
        bounds
    }

    /// Direction of travel at a path length, a unit vector with 62 fraction bits.
    #[must_use]
    pub fn direction(&self, length: i64) -> [i64; N] {
        let mut direction = [0; N];
        let (sine, cosine) = sin_cos(self.phase_at(length));
        let tangent = if self.backwards != 0 { [sine, -cosine] } else { [-sine, cosine] };
        let correction = self.correction.as_ref().map_or([0; 2], |c| c.direction(self.length));
        for ((axis, tangent), correction) in self.plane.into_iter().zip(tangent).zip(correction) {
            if let Some(component) = direction.get_mut(axis) {
                *component = tangent + correction;
            }
        }
        direction
    }

    /// Sets a point to that at a path length.
    pub fn set_to(&self, point: &mut [Position; N], length: i64) {
        self.set_on_circle(point, self.phase_at(length));
        if let Some(correction) = &self.correction {
            for (axis, offset) in self.plane.into_iter().zip(correction.at(length)) {
                if let Some(position) = point.get_mut(axis) {
                    *position += offset;
                }
            }
        }
    }

    /// The phase at a path length, 2⁶⁴ per turn, without whole turns.
    fn phase_at(&self, length: i64) -> u64 {
        self.turned_by(shifted_product(length.cast_unsigned(), self.phase_per_unit, self.phase_shift))
    }

    /// The phase after a part of a turn in the direction of the arc. The complement is the negative, to 2⁻⁶⁴ turns.
    const fn turned_by(&self, phase: u64) -> u64 {
        self.start_phase.wrapping_add(phase ^ self.backwards)
    }

    /// Sets a point to that of the circle at a phase.
    fn set_on_circle(&self, point: &mut [Position; N], phase: u64) {
        let (sine, cosine) = sin_cos(phase);
        let coordinate =
            |centre_q2: i64, value: i64| Position((centre_q2 + self.radius.mul_high(Words::of(value))) >> 2);
        let [x, y] = self.centre_q2;
        let coordinates = [coordinate(x, cosine), coordinate(y, sine)];
        if let Ok(both) = <&mut [Position; 2]>::try_from(point.as_mut_slice()) {
            // With two axes, both are in the plane.
            *both = coordinates;
            return;
        }
        *point = self.start;
        // `plan` has checked the plane; `get_mut` compiles to no panic.
        for (axis, coordinate) in self.plane.into_iter().zip(coordinates) {
            if let Some(position) = point.get_mut(axis) {
                *position = coordinate;
            }
        }
    }
}

/// The phase of a vector, 2⁶⁴ per turn, such that [`sin_cos`] gives its direction.
#[expect(clippy::cast_possible_truncation, reason = "at most half a turn, and the correction of a double")]
fn phase_of([x, y]: [i64; 2]) -> u64 {
    const PER_RADIAN: f64 = TURN_Q64 / core::f64::consts::TAU;
    let phase = ((libm::atan2(y as f64, x as f64) * PER_RADIAN) as i64).cast_unsigned();
    // A double has 53 bits. The angle that remains is the component across the direction.
    let (sine, cosine) = sin_cos(phase);
    let across = i128::from(y) * i128::from(cosine) - i128::from(x) * i128::from(sine);
    let along = i128::from(x) * i128::from(cosine) + i128::from(y) * i128::from(sine);
    let remaining = across as f64 / (along as f64).max(1.0) * PER_RADIAN;
    phase.wrapping_add_signed(remaining as i64)
}

/// √(x² + y²), rounded down.
fn magnitude(vector: [i64; 2]) -> u128 {
    let [x, y] = vector.map(|r| u128::from(r.unsigned_abs()).pow(2));
    (x + y).isqrt()
}
