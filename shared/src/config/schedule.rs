//! The gain schedule of an axis in machine units.

use super::check::{ranged, resolved_gain};
use super::error::ConfigError;
use super::settings::{AxisSettings, GainSchedule, Rates, SCHEDULE_POINTS, ScheduledOver};
use crate::control::gain_schedule::{Gains, PER_SPEED_UNIT, Schedule, Segment};
use crate::control::velocity::VelocityControl;
use crate::scalar::Scalar;
use crate::units::{PER_M, TRAVEL_LIMIT_M, VELOCITY_M_PER_S};

/// Greatest speed of a point, m/s.
const FASTEST_M_PER_S: f64 = 100.0;

/// The schedule that is declared, for a velocity loop and rates that have been checked.
pub(super) fn schedule<S: Scalar>(
    settings: &AxisSettings,
    velocity: &VelocityControl<S>,
    rates: Rates,
) -> Result<Option<Schedule<S>>, ConfigError> {
    let Some(declared) = &settings.gain_schedule else { return Ok(None) };
    let base = Gains { proportional: velocity.proportional, integral: velocity.integral };
    let mut schedule =
        Schedule { over: declared.over, base, first: base, segments: [None; SCHEDULE_POINTS - 1] };
    let mut last: Option<(f64, i64, Gains<S>)> = None;
    let mut segments = schedule.segments.iter_mut();
    for point in declared.iter() {
        let at = place(declared.over, point.at, rates, last.map(|(at, ..)| at))?;
        let gains = gains_of(settings, point.ratio, rates)?;
        match last {
            None => schedule.first = gains,
            Some((_, start, from)) => {
                if let Some(segment) = segments.next() {
                    *segment = Some(Segment::new([start, at], [from, gains]));
                }
            }
        }
        last = Some((point.at, at, gains));
    }
    if schedule.segments[0].is_none() {
        return Err(ConfigError::OutOfRange {
            name: "gain_schedule_points",
            min: 2.0,
            max: SCHEDULE_POINTS as f64,
        });
    }
    Ok(Some(schedule))
}

/// A point behind the last one, in the units of the schedule.
fn place(over: ScheduledOver, at: f64, rates: Rates, last: Option<f64>) -> Result<i64, ConfigError> {
    let (name, least, greatest, units) = match over {
        ScheduledOver::Position => ("gain_schedule_position", -TRAVEL_LIMIT_M, TRAVEL_LIMIT_M, PER_M),
        ScheduledOver::Speed => {
            ("gain_schedule_speed", 0.0, FASTEST_M_PER_S, PER_M * PER_SPEED_UNIT / rates.position_loop_hz())
        }
    };
    // A thousandth less, so that the rounding of a difference of decimal fractions does not matter.
    let least = last.map_or(least, |last| last + 0.999 * GainSchedule::LEAST_SPACING);
    #[expect(clippy::cast_possible_truncation, reason = "saturates")]
    Ok((ranged(name, at, least, greatest)? * units) as i64)
}

/// The gains at a ratio.
fn gains_of<S: Scalar>(settings: &AxisSettings, ratio: f64, rates: Rates) -> Result<Gains<S>, ConfigError> {
    let name = "gain_schedule_ratio";
    let [least, greatest] = GainSchedule::RATIOS;
    let ratio = ranged(name, ratio, least, greatest)?;
    let kv = settings.velocity_gain_n_s_per_m * VELOCITY_M_PER_S;
    let integral = match settings.velocity_integral_time_s {
        Some(time_s) => resolved_gain::<S>(name, ratio, kv / (rates.velocity_loop_hz * time_s))?,
        None => S::gain(0.0),
    };
    Ok(Gains { proportional: resolved_gain::<S>(name, ratio, kv)?, integral })
}
