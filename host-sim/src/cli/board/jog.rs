//! `lost-motion board jog`: moves one axis, with the drives switched on if they are off.

use std::ops::RangeInclusive;
use std::time::{Duration, Instant};

use anyhow::Result;
use clap::ArgGroup;

use super::port::{AxisArguments, check_value};
use super::simple;
use crate::cli::outputs::print;
use crate::cli::stop;
use ::board::motion::POLL;
use files::error::InputError;
use shared::link::Request;
use shared::link::message::Jog;

/// Longest jog at a speed, s.
const MAX_S: f64 = 3600.0;

/// Distances, mm: those of a line in a motion file.
const DISTANCES_MM: RangeInclusive<f64> = 1e-6..=1e5;

/// Speeds, mm/min. The board refuses those that are too fast for the axis.
const SPEEDS_MM_PER_MIN: RangeInclusive<f64> = 1e-3..=1e6;

/// Accelerations, m/s².
const ACCELERATIONS_M_PER_S2: RangeInclusive<f64> = 1e-6..=1e3;

/// Arguments of `board jog`.
#[derive(clap::Args)]
#[command(group = ArgGroup::new("extent").required(true))]
pub struct Arguments {
    #[command(flatten)]
    axis: AxisArguments,
    /// Signed distance.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, group = "extent")]
    by_mm: Option<f64>,
    /// Time for a jog at a speed. It ends by itself if this program ends.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, group = "extent")]
    for_s: Option<f64>,
    /// Speed; signed for a jog at a speed, positive for one by a distance.
    #[arg(long, value_name = "MM_PER_MIN", allow_negative_numbers = true, default_value_t = 300.0)]
    speed_mm_per_min: f64,
    /// Acceleration.
    #[arg(long, value_name = "M_PER_S2", allow_negative_numbers = true, default_value_t = 0.5)]
    acceleration_m_per_s2: f64,
    /// Do not wait for the end: the board holds the path when it does not hear of a host, and `board resume` continues it.
    #[arg(long)]
    no_wait: bool,
}

/// The request. Its numbers are checked here: the drives are switched on before the board gets it.
fn request(arguments: &Arguments) -> Result<Jog, InputError> {
    let axis = arguments.axis.number()?;
    let speed = arguments.speed_mm_per_min;
    let (least, greatest) = (SPEEDS_MM_PER_MIN.start(), SPEEDS_MM_PER_MIN.end());
    if let Some(distance) = arguments.by_mm {
        let (from, to) = (DISTANCES_MM.start(), DISTANCES_MM.end());
        let expected = format!("a distance from {from} to {to} mm, positive or negative");
        check_value("--by-mm", &expected, DISTANCES_MM.contains(&distance.abs()), distance)?;
        let expected = format!("a number from {least} to {greatest} (the direction is the sign of --by-mm)");
        check_value("--speed-mm-per-min", &expected, SPEEDS_MM_PER_MIN.contains(&speed), speed)?;
    } else {
        let expected = format!("a number from {least} to {greatest}, positive or negative");
        check_value("--speed-mm-per-min", &expected, SPEEDS_MM_PER_MIN.contains(&speed.abs()), speed)?;
    }
    let acceleration = arguments.acceleration_m_per_s2;
    let (least, greatest) = (ACCELERATIONS_M_PER_S2.start(), ACCELERATIONS_M_PER_S2.end());
    let expected = format!("a number from {least} to {greatest}");
    let is_valid = ACCELERATIONS_M_PER_S2.contains(&acceleration);
    check_value("--acceleration-m-per-s2", &expected, is_valid, acceleration)?;
    Ok(Jog {
        axis,
        distance_m: arguments.by_mm.map(|mm| 1e-3 * mm),
        velocity_m_per_s: speed / 60e3,
        acceleration_m_per_s2: acceleration,
    })
}

/// Runs the command.
///
/// # Errors
/// Invalid arguments, a board that cannot be reached or refuses the jog, an interrupt.
pub fn run(arguments: &Arguments) -> Result<()> {
    let jog = request(arguments)?;
    if let Some(seconds) = arguments.for_s {
        let expected = format!("seconds above 0 and up to {MAX_S}");
        check_value("--for-s", &expected, seconds > 0.0 && seconds <= MAX_S, seconds)?;
    }
    let duration = arguments.for_s.map(Duration::from_secs_f64);
    let mut client = arguments.axis.connect()?;
    stop::write_partial_result();
    client.enable()?;
    stop::check_before_motion()?;
    client.command(&Request::Jog(jog))?;
    if let Some(duration) = duration {
        let started = Instant::now();
        while started.elapsed() < duration && !stop::is_interrupted() && !client.status()?.at_rest {
            client.command(&Request::Jog(jog))?;
            client.listen(POLL)?;
        }
        client.command(&Request::Stop)?;
    }
    if arguments.no_wait && !stop::is_interrupted() {
        return print("The jog has started.");
    }
    simple::wait(&mut client)?;
    let status = client.status()?;
    let at = &status.axes[usize::from(jog.axis)];
    print(&format!("{} is at {:.4} mm.", arguments.axis.axis, 1e3 * at.command.to_m()))
}
