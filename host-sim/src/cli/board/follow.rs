//! `lost-motion board follow`: an axis follows an external counter.

use std::ops::RangeInclusive;
use std::time::{Duration, Instant};

use anyhow::Result;

use super::port::{AxisArguments, axis_number, check_axis, check_value};
use crate::cli::outputs::print;
use crate::cli::stop;
use files::error::InputError;
use shared::interpolate::following::FollowSettings;
use shared::link::Request;

/// Distances for the counts, mm.
const DISTANCES_MM: RangeInclusive<f64> = 1e-9..=1e5;

/// Numbers of counts.
const COUNTS: RangeInclusive<f64> = 1.0..=2_147_483_647.0;

/// Speeds, mm/min. The board refuses those that are too fast for the axis.
const SPEEDS_MM_PER_MIN: RangeInclusive<f64> = 0.1..=60e3;

/// Accelerations, m/s².
const ACCELERATIONS_M_PER_S2: RangeInclusive<f64> = 1e-3..=1e3;

/// Lags, mm.
const LAGS_MM: RangeInclusive<f64> = 1e-3..=100.0;

/// Times, s.
const TIMES_S: RangeInclusive<f64> = 1e-3..=1e6;

/// Arguments of `board follow`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    axis: AxisArguments,
    /// Input of the counter: that of the scale of this axis, which has no scale. Without it that of the axis itself.
    #[arg(long, value_name = "AXIS")]
    counter: Option<String>,
    /// Distance of the axis for the counts; negative: against the direction of the counter.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    distance_mm: f64,
    /// Counts for the distance: four a line of an encoder.
    #[arg(long, value_name = "COUNTS", allow_negative_numbers = true)]
    counts: f64,
    /// Greatest speed of the axis.
    #[arg(long, value_name = "MM_PER_MIN", allow_negative_numbers = true)]
    speed_mm_per_min: f64,
    /// Greatest acceleration of the axis.
    #[arg(long, value_name = "M_PER_S2", allow_negative_numbers = true, default_value_t = 0.5)]
    acceleration_m_per_s2: f64,
    /// Distance behind the counter beyond which the axis stops.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 2.0)]
    lag_mm: f64,
    /// Stop after this time; without it, only another command or an interrupt stops the axis.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    time_s: Option<f64>,
}

/// The settings. Their numbers are checked here: the drives are switched on before the board gets them.
fn settings(arguments: &Arguments, axis: u8) -> Result<FollowSettings, InputError> {
    let Arguments { distance_mm, counts, speed_mm_per_min, acceleration_m_per_s2, lag_mm, time_s, .. } =
        *arguments;
    let (from, to) = (DISTANCES_MM.start(), DISTANCES_MM.end());
    let expected = format!("a distance from {from} to {to} mm, positive or negative");
    check_value("--distance-mm", &expected, DISTANCES_MM.contains(&distance_mm.abs()), distance_mm)?;
    let whole = COUNTS.contains(&counts) && counts.fract() == 0.0;
    check_value("--counts", "a whole number from 1 to 2147483647", whole, counts)?;
    for (option, value, range) in [
        ("--speed-mm-per-min", speed_mm_per_min, SPEEDS_MM_PER_MIN),
        ("--acceleration-m-per-s2", acceleration_m_per_s2, ACCELERATIONS_M_PER_S2),
        ("--lag-mm", lag_mm, LAGS_MM),
        ("--time-s", time_s.unwrap_or(*TIMES_S.end()), TIMES_S),
    ] {
        let expected = format!("a number from {} to {}", range.start(), range.end());
        check_value(option, &expected, range.contains(&value), value)?;
    }
    let input = arguments.counter.as_ref().map_or(Ok(axis), |name| axis_number("--counter", name))?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a whole number in its range"
    )]
    Ok(FollowSettings {
        input,
        distance_m: 1e-3 * distance_mm,
        counts: counts as u32,
        speed_m_per_s: 1e-3 / 60.0 * speed_mm_per_min,
        acceleration_m_per_s2,
        lag_m: 1e-3 * lag_mm,
    })
}

/// Enables the drives if they are off, and lets an axis follow a counter until the time is over, an interrupt, or another command.
///
/// # Errors
/// Invalid arguments, a board that cannot be reached or refuses it, a stop by a fault or by another program, an interrupt.
pub fn run(arguments: &Arguments) -> Result<()> {
    let axis = arguments.axis.number()?;
    let settings = settings(arguments, axis)?;
    let mut client = arguments.axis.connect()?;
    if let Some(counter) = &arguments.counter {
        check_axis(&client, "--counter", counter)?;
    }
    stop::write_partial_result();
    client.enable()?;
    stop::check_before_motion()?;
    client.command(&Request::Follow { axis, settings })?;
    let ends_at = arguments.time_s.map(|time_s| Instant::now() + Duration::from_secs_f64(time_s));
    let (mut interrupted, mut stops) = (false, false);
    let status = client.wait(|client, _| {
        let is_over = ends_at.is_some_and(|at| Instant::now() >= at);
        interrupted |= stop::is_interrupted();
        if (is_over || interrupted) && !stops {
            stops = true;
            client.command(&Request::Stop)?;
        }
        Ok(true)
    })?;
    if interrupted {
        return Err(stop::MOTION_STOPPED.into());
    }
    let at_mm = 1e3 * status.axes[usize::from(axis)].command.to_m();
    print(&format!("{} is at {at_mm:.4} mm, and follows no longer.", arguments.axis.axis))
}
