//! `lost-motion board probe`: moves an axis until the probe is touched.

use std::ops::RangeInclusive;

use anyhow::{Result, bail};

use super::port::{AxisArguments, check_value};
use super::simple::wait;
use crate::cli::outputs::print;
use crate::cli::stop;
use ::board::{BoardError, refusal};
use files::error::InputError;
use shared::config::Rates;
use shared::link::Request;
use shared::probing::{ProbeSettings, ProbeStatus, Touch};
use shared::units::Position;

/// Distances, mm.
const DISTANCES_MM: RangeInclusive<f64> = 1e-3..=1e4;

/// Speeds, mm/min. The board refuses those that are too fast for the axis.
const SPEEDS_MM_PER_MIN: RangeInclusive<f64> = 0.1..=60e3;

/// Accelerations, m/s².
const ACCELERATIONS_M_PER_S2: RangeInclusive<f64> = 1e-3..=1e3;

/// Arguments of `board probe`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    axis: AxisArguments,
    /// Greatest distance to the touch; its sign is the direction.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    distance_mm: f64,
    /// Speed. The positions are known to within the way in a tick.
    #[arg(long, value_name = "MM_PER_MIN", allow_negative_numbers = true)]
    speed_mm_per_min: f64,
    /// Acceleration of the approach.
    #[arg(long, value_name = "M_PER_S2", allow_negative_numbers = true, default_value_t = 0.5)]
    acceleration_m_per_s2: f64,
    /// Move back to the command of the touch.
    #[arg(long)]
    retract: bool,
}

/// The settings. Their numbers are checked here: the drives are switched on before the board gets them.
fn settings(arguments: &Arguments) -> Result<ProbeSettings, InputError> {
    let Arguments { distance_mm, speed_mm_per_min, acceleration_m_per_s2, retract: retracts, .. } =
        *arguments;
    let (from, to) = (DISTANCES_MM.start(), DISTANCES_MM.end());
    let expected = format!("a distance from {from} to {to} mm, positive or negative");
    check_value("--distance-mm", &expected, DISTANCES_MM.contains(&distance_mm.abs()), distance_mm)?;
    for (option, value, range) in [
        ("--speed-mm-per-min", speed_mm_per_min, SPEEDS_MM_PER_MIN),
        ("--acceleration-m-per-s2", acceleration_m_per_s2, ACCELERATIONS_M_PER_S2),
    ] {
        let expected = format!("a number from {} to {}", range.start(), range.end());
        check_value(option, &expected, range.contains(&value), value)?;
    }
    Ok(ProbeSettings {
        distance_m: 1e-3 * distance_mm,
        speed_m_per_s: 1e-3 / 60.0 * speed_mm_per_min,
        acceleration_m_per_s2,
        retracts,
    })
}

/// The touch in words. The edge of the probe is between the tick of the touch and the one before.
fn describe(touch: &Touch, speed_m_per_s: f64, rates: &Rates) -> String {
    let mm = |position: Position| format!("{:.4}", 1e3 * position.to_m());
    let scale = touch.table.map_or_else(|| "no signal".to_owned(), mm);
    let tick_um = 1e6 * speed_m_per_s / rates.velocity_loop_hz;
    let command_um = tick_um * f64::from(rates.position_loop_divider);
    format!(
        "{:<10}{:>14}{:>14}{:>14}\n{:<10}{:>14}{:>14}{scale:>14}\n\
         {:<10}{command_um:>14.3}{tick_um:>14.3}{tick_um:>14.3}",
        "",
        "command mm",
        "motor mm",
        "scale mm",
        "touched",
        mm(touch.command),
        mm(touch.motor),
        "within µm",
    )
}

/// Enables the drives if they are off, moves an axis until the probe is touched and waits for the end.
///
/// # Errors
/// Invalid arguments, a board that cannot be reached or refuses it, a probe that is touched before or not at all, an interrupt.
pub fn run(arguments: &Arguments) -> Result<()> {
    let axis = arguments.axis.number()?;
    let settings = settings(arguments)?;
    let mut client = arguments.axis.connect()?;
    stop::write_partial_result();
    client.enable()?;
    stop::check_before_motion()?;
    client.command(&Request::Probe { axis, settings })?;
    wait(&mut client)?;
    let status = client.status()?;
    let name = &arguments.axis.axis;
    match status.probe {
        Some(ProbeStatus::Touched(touch)) => {
            let at_mm = 1e3 * status.axes[usize::from(axis)].command.to_m();
            let touch = describe(&touch, settings.speed_m_per_s, &client.welcome().rates);
            print(&format!("{touch}\n{name} is at {at_mm:.4} mm."))
        }
        Some(ProbeStatus::Failed(error)) => bail!("{name}: not probed: {}", refusal::probe(error)),
        Some(ProbeStatus::Running) | None => Err(BoardError::Unexpected.into()),
    }
}
