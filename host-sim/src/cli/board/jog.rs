//! `lost-motion jog`: moves one axis.

use std::time::{Duration, Instant};

use anyhow::Result;

use super::{AxisArguments, simple};
use crate::cli::outputs::print;
use crate::cli::stop;
use ::board::motion::POLL;
use files::error::InputError;
use shared::link::Request;
use shared::link::message::Jog;

/// Longest jog at a speed, s.
const MAX_S: f64 = 3600.0;

/// Arguments of `jog`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    axis: AxisArguments,
    /// Signed distance.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, conflicts_with = "for_s")]
    by_mm: Option<f64>,
    /// Time for a jog at a speed. It ends by itself if this program ends.
    #[arg(long, value_name = "SECONDS", required_unless_present = "by_mm")]
    for_s: Option<f64>,
    /// Speed; signed for a jog at a speed.
    #[arg(long, value_name = "MM_PER_MIN", allow_negative_numbers = true, default_value_t = 300.0)]
    speed_mm_per_min: f64,
    /// Acceleration.
    #[arg(long, value_name = "M_PER_S2", default_value_t = 0.5)]
    acceleration_m_per_s2: f64,
    /// Do not wait for the end: the board holds the path when it does not hear of a host, and `resume` continues it.
    #[arg(long)]
    no_wait: bool,
}

/// Runs the command.
///
/// # Errors
/// Invalid arguments, a board that cannot be reached or refuses the jog, an interrupt.
pub fn run(arguments: &Arguments) -> Result<()> {
    let axis = arguments.axis.number()?;
    let duration = match arguments.for_s {
        Some(seconds) if seconds > 0.0 && seconds <= MAX_S => Some(Duration::from_secs_f64(seconds)),
        Some(seconds) => {
            let expected = format!("seconds above 0 and up to {MAX_S}");
            return Err(InputError::expected("--for-s", expected, seconds).into());
        }
        None => None,
    };
    let jog = Jog {
        axis,
        distance_m: arguments.by_mm.map(|mm| 1e-3 * mm),
        velocity_m_per_s: arguments.speed_mm_per_min / 60e3,
        acceleration_m_per_s2: arguments.acceleration_m_per_s2,
    };
    let mut client = arguments.axis.port.connect()?;
    client.enable()?;
    stop::write_partial_result();
    client.command(&Request::Jog(jog))?;
    if let Some(duration) = duration {
        let started = Instant::now();
        while started.elapsed() < duration && !stop::is_interrupted() && !client.status()?.at_rest {
            client.command(&Request::Jog(jog))?;
            client.listen(POLL)?;
        }
        client.command(&Request::Stop)?;
    }
    if arguments.no_wait {
        return print("The jog has started.");
    }
    simple::wait(&mut client)?;
    let status = client.status()?;
    let at = &status.axes[usize::from(axis)];
    print(&format!("{} is at {:.4} mm.", arguments.axis.axis, 1e3 * at.command.to_m()))
}
