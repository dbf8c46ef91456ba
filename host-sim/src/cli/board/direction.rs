//! `lost-motion check-direction`: whether a small force moves an axis in the positive direction.

use std::thread::sleep;
use std::time::Duration;

use anyhow::{Result, bail};

use super::AxisArguments;
use crate::cli::outputs::print;
use crate::cli::progress::Progress;
use crate::cli::stop;
use ::board::{Client, refusal};
use shared::drive::direction_check::{DirectionCheckSettings, DirectionResult};
use shared::link::Request;
use shared::link::report::DirectionReport;

/// Time between two looks at the board.
const POLL: Duration = Duration::from_millis(50);

/// Arguments of `check-direction`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    axis: AxisArguments,
    /// Force, N: slightly more than the friction of the axis.
    #[arg(long)]
    force_n: f64,
    /// Longest time of the force, s; up to 1.
    #[arg(long, default_value_t = 0.2, value_name = "SECONDS")]
    time_s: f64,
    /// Distance that counts as motion and ends the force, mm; up to 5. More than the backlash.
    #[arg(long, default_value_t = 0.1, value_name = "MM")]
    distance_mm: f64,
    /// Do not wait for the enable switch: `status` shows the result.
    #[arg(long)]
    no_wait: bool,
}

/// Runs the command.
///
/// # Errors
/// A board that cannot be reached or refuses it, a result other than ok.
pub fn run(arguments: &Arguments) -> Result<()> {
    let axis = arguments.axis.number()?;
    let mut client = arguments.axis.port.connect()?;
    let settings = DirectionCheckSettings {
        force_n: arguments.force_n,
        time_s: arguments.time_s,
        detect_m: 1e-3 * arguments.distance_mm,
    };
    client.command(&Request::CheckDirection { axis, settings })?;
    if arguments.no_wait {
        return print("The check starts when the enable switch is closed, after it was open.");
    }
    let result = wait(&mut client)?;
    let sentence = refusal::direction(axis, result);
    if result == DirectionResult::Ok { print(&format!("{sentence}.")) } else { bail!(sentence) }
}

/// Waits for the result. An interrupt ends the check.
fn wait(client: &mut Client) -> Result<DirectionResult> {
    stop::write_partial_result();
    let progress = Progress::start();
    progress.show("waiting for the enable switch to be opened and closed");
    loop {
        if let DirectionReport::Ended { result, .. } = client.status()?.direction {
            return Ok(result);
        }
        if stop::is_interrupted() {
            client.command(&Request::Stop)?;
            return Err(stop::Stopped { done: 0, asked: 1, what: "checks" }.into());
        }
        sleep(POLL);
    }
}
