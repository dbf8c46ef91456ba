//! Gain schedule: Kv of the velocity loop over the command of an axis, or over the magnitude of its speed.
//!
//! Where the mass, or the friction, of an axis differs along its travel or with its speed, one Kv is too low in one place or too high in
//! another. A schedule has two to [`SCHEDULE_POINTS`] points with a ratio each: Kv = ratio·[`velocity_gain_n_s_per_m`], linear in between and
//! constant beyond the ends. The integral time Ti stays, so that the gain of the integral part, Kv/Ti, follows.
//!
//! It is evaluated before each position tick, for the command, or the change of the command, of the position tick before: it depends on commands only, not on
//! readings, and makes no loop of its own. An axis that is not homed has the ratio 1 over position, because its position is not known.
//!
//! The integral is a force and is kept when the gain changes. The force then changes by the proportional part alone, Kv·|e|·Δratio with
//! the velocity error e.
//!
//! [`velocity_gain_n_s_per_m`]: crate::config::AxisSettings::velocity_gain_n_s_per_m

use serde::{Deserialize, Serialize};

use crate::scalar::Scalar;

/// Greatest number of points of a gain schedule.
pub const SCHEDULE_POINTS: usize = 6;

/// What a gain schedule depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ScheduledOver {
    /// The command, m.
    Position,
    /// The magnitude of the change of the command over time, m/s.
    Speed,
}

/// The gains of the velocity loop that a schedule changes.
#[derive(Clone, Copy, Debug)]
pub struct Gains<S: Scalar> {
    /// [`proportional`](crate::control::velocity::VelocityControl::proportional).
    pub proportional: S::Gain,
    /// [`integral`](crate::control::velocity::VelocityControl::integral).
    pub integral: S::Gain,
}

/// A schedule in machine units.
#[derive(Clone, Copy, Debug)]
pub struct Schedule<S: Scalar> {
    /// What the gains depend on.
    pub over: ScheduledOver,
    /// For the ratio 1.
    pub base: Gains<S>,
    /// At and below the first point.
    pub first: Gains<S>,
    /// Between the points, ascending; the first `None` ends them.
    pub segments: [Option<Segment<S>>; SCHEDULE_POINTS - 1],
}

/// From one point to the next.
#[derive(Clone, Copy, Debug)]
pub struct Segment<S: Scalar> {
    start: i64,
    end: i64,
    /// Places by which the length has its highest bit in the highest place of 64.
    shift: u32,
    /// 2⁶³ over the upper half of the shifted length.
    reciprocal: u32,
    from: Gains<S>,
    to: Gains<S>,
}

impl<S: Scalar> Gains<S> {
    /// Linear interpolation; `fraction_q32` has 32 fraction bits.
    fn between(self, to: Self, fraction_q32: u32) -> Self {
        Self {
            proportional: S::gain_between(self.proportional, to.proportional, fraction_q32),
            integral: S::gain_between(self.integral, to.integral, fraction_q32),
        }
    }
}

impl<S: Scalar> Segment<S> {
    /// The segment between two places, of which the second is greater.
    #[must_use]
    pub const fn new([start, end]: [i64; 2], [from, to]: [Gains<S>; 2]) -> Self {
        let length = end.wrapping_sub(start).unsigned_abs();
        let shift = length.leading_zeros() % 64;
        let upper = (length << shift) >> 32;
        let reciprocal = match (1_u64 << 63).checked_div(upper) {
            Some(reciprocal) => reciprocal,
            None => u64::MAX,
        };
        #[expect(clippy::cast_possible_truncation, reason = "limited before")]
        let reciprocal = if reciprocal > u32::MAX as u64 { u32::MAX } else { reciprocal as u32 };
        Self { start, end, shift, reciprocal, from, to }
    }

    /// The gains at a place within the segment.
    fn gains(&self, at: i64) -> Gains<S> {
        let way = (at.wrapping_sub(self.start).unsigned_abs() << (self.shift % 64)) >> 32;
        // Rounding may make it one step too large at the end.
        let fraction = ((way * u64::from(self.reciprocal)) >> 31).min(u64::from(u32::MAX));
        #[expect(clippy::cast_possible_truncation, reason = "limited before")]
        self.from.between(self.to, fraction as u32)
    }
}

impl<S: Scalar> Schedule<S> {
    /// The gains at a command (position units), or at a speed (see [`speed`]).
    #[must_use]
    pub fn gains(&self, at: i64) -> Gains<S> {
        let mut gains = self.first;
        for segment in self.segments.iter().map_while(Option::as_ref) {
            if at <= segment.start {
                break;
            }
            if at < segment.end {
                return segment.gains(at);
            }
            gains = segment.to;
        }
        gains
    }
}

/// Units of a speed in position units per position tick: an increment is read as an error, whose unit is 64 times greater.
pub const PER_SPEED_UNIT: f64 = 64.0;

/// The magnitude of a change of the command in a position tick, increment units, as the place in a schedule.
pub fn speed<S: Scalar>(increment: S) -> i64 {
    increment.distance().wrapping_abs()
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;
    use crate::config::settings::{GainSchedule, SchedulePoint};
    use crate::config::{AxisConfig, AxisSettings, Rates};
    use crate::scalar::Fixed;
    use crate::units::{INCREMENT_M, Position, VELOCITY_M_PER_S};

    const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

    fn schedule<S: Scalar>(over: ScheduledOver, points: &[[f64; 2]]) -> Schedule<S> {
        let points = GainSchedule::of(over, points.iter().map(|&[at, ratio]| SchedulePoint { at, ratio }));
        let settings = AxisSettings { gain_schedule: points, ..AxisSettings::default() };
        AxisConfig::schedule(&settings, RATES).unwrap().unwrap()
    }

    /// The interpolation of a person: straight between the points, constant beyond.
    fn ratio(points: &[[f64; 2]], x: f64) -> f64 {
        let last = points[points.len() - 1];
        let part = points.windows(2).find(|pair| x < pair[1][0]);
        part.map_or(last[1], |pair| {
            let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
            y0 + (y1 - y0) * ((x - x0) / (x1 - x0)).max(0.0)
        })
    }

    fn points(least: f64) -> impl Strategy<Value = Vec<[f64; 2]>> {
        let steps = prop::collection::vec((0.002..0.5, 0.25..4.0), 2..=SCHEDULE_POINTS);
        (least..0.5, steps).prop_map(|(mut at, steps)| {
            steps
                .into_iter()
                .map(|(step, ratio)| {
                    at += step;
                    [at, ratio]
                })
                .collect()
        })
    }

    /// A gain of 50,000 N·s/m has 3,300 steps of 2⁻²⁴ at the least ratio; a position 1e-15 m, a speed 16 nm a tick.
    fn is_near(found: f64, expected: f64, within: f64) -> Result<(), TestCaseError> {
        prop_assert!((found - expected).abs() <= within, "{found}, expected {expected} to {within}");
        Ok(())
    }

    proptest! {
        /// Kv and Kv/Ti at any place are those of the straight lines, in fixed point to a step and a half of the gain.
        #[test]
        fn the_gains_follow_the_points_over_position(points in points(-1.0), x in -1.5_f64..3.0) {
            let expected = ratio(&points, x);
            let at = Position::from_m(x).unwrap().0;
            let exact = schedule::<f64>(ScheduledOver::Position, &points).gains(at);
            let kv = 50_000.0 * VELOCITY_M_PER_S;
            is_near(exact.proportional / kv, expected, 1e-8)?;
            is_near(exact.integral / (kv * 50e-6 / 0.02), expected, 1e-8)?;
            let fixed = schedule::<Fixed>(ScheduledOver::Position, &points).gains(at);
            let step = 1.0 / f64::from(1 << 24);
            is_near(fixed.proportional.to_num::<f64>(), kv * expected, 1.6 * step)?;
            is_near(fixed.integral.to_num::<f64>(), kv * 50e-6 / 0.02 * expected, 1.6 * step)?;
        }

        /// Forwards and backwards alike: at 0.4 m/s a position tick has 100 µm, which an increment resolves to 1e-12 m.
        #[test]
        fn the_gains_follow_the_points_over_speed(points in points(0.0), x in 0.0_f64..3.0, backwards: bool) {
            let expected = ratio(&points, x);
            let schedule = schedule::<f64>(ScheduledOver::Speed, &points);
            let increment = x / 4000.0 / INCREMENT_M * if backwards { -1.0 } else { 1.0 };
            let gains = schedule.gains(speed(increment));
            is_near(gains.proportional / (50_000.0 * VELOCITY_M_PER_S), expected, 1e-6)?;
        }
    }

    /// The ends of a segment: the points themselves, and a position unit beside them.
    #[test]
    fn at_a_point_the_gain_is_that_of_the_point() {
        let schedule = schedule::<Fixed>(ScheduledOver::Position, &[[0.0, 1.0], [0.25, 2.0], [0.5, 0.5]]);
        let kv = |at: i64| schedule.gains(at).proportional.to_num::<f64>() / (50_000.0 * VELOCITY_M_PER_S);
        for (m, ratio) in [(-100.0, 1.0), (0.0, 1.0), (0.25, 2.0), (0.5, 0.5), (100.0, 0.5)] {
            let at = Position::from_m(m).unwrap().0;
            for at in [at - 1, at, at + 1] {
                assert!((kv(at) - ratio).abs() < 1e-4, "{m} m: {}", kv(at));
            }
        }
    }
}
