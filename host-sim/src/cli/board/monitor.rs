//! `lost-motion board monitor`: a line about the board at intervals.

use std::thread;
use std::time::{Duration, Instant};

use anyhow::Result;

use super::port::PortArguments;
use super::status::{path, power};
use crate::cli::outputs::print_to_reader;
use crate::cli::stop;
use ::board::refusal::AXIS_NAMES;
use files::error::InputError;
use shared::link::Status;

/// Longest interval, s: a host that is silent for longer stops the drives.
const MAX_INTERVAL_S: f64 = 60.0;

/// Arguments of `board monitor`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    port: PortArguments,
    /// Time between two lines.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = 0.5)]
    interval_s: f64,
    /// Number of lines; without it until an interrupt.
    #[arg(long)]
    lines: Option<u32>,
}

/// Runs the command.
///
/// # Errors
/// Invalid arguments, a board that cannot be reached.
pub fn run(arguments: &Arguments) -> Result<()> {
    if !(0.0..=MAX_INTERVAL_S).contains(&arguments.interval_s) {
        let expected = format!("seconds from 0 to {MAX_INTERVAL_S}");
        return Err(InputError::expected("--interval-s", expected, arguments.interval_s).into());
    }
    let interval = Duration::from_secs_f64(arguments.interval_s);
    let mut client = arguments.port.connect()?;
    let tick_hz = client.welcome().rates.velocity_loop_hz;
    stop::write_partial_result();
    let mut left = arguments.lines;
    while left != Some(0) && !stop::is_interrupted() {
        let started = Instant::now();
        let status = client.status()?;
        if !print_to_reader(&line(&status, tick_hz))? {
            // Further requests would keep the drives on.
            break;
        }
        left = left.map(|lines| lines - 1);
        if left != Some(0) {
            thread::sleep(interval.saturating_sub(started.elapsed()));
        }
    }
    Ok(())
}

fn line(status: &Status, tick_hz: f64) -> String {
    let axes = AXIS_NAMES.iter().zip(&status.axes).map(|(name, axis)| {
        let [command, motor] = [axis.command, axis.motor].map(|position| 1e3 * position.to_m());
        let error_um = 1e3 * (command - motor);
        format!("{name} {motor:.4} mm, error {error_um:.2} µm, {:.1} N", axis.force_n)
    });
    let axes: Vec<String> = axes.collect();
    format!(
        "{:.3} s: drives {}; {}; {}",
        status.tick as f64 / tick_hz,
        power(status),
        path(status),
        axes.join("; ")
    )
}
