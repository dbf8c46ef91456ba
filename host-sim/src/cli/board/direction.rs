//! `lost-motion board check-direction`: whether a small force moves an axis in the positive direction.

use std::thread::sleep;
use std::time::Duration;

use anyhow::{Result, bail};

use super::port::{AxisArguments, check_value};
use crate::cli::outputs::print;
use crate::cli::progress::Progress;
use crate::cli::stop;
use ::board::{BoardError, Client, refusal};
use files::error::InputError;
use shared::drive::direction_check::{
    DirectionCheck, DirectionCheckError, DirectionCheckSettings, DirectionResult,
};
use shared::link::refusal::DirectionProblem;
use shared::link::report::DirectionReport;
use shared::link::{Refusal, Request};

/// Time between two looks at the board.
const POLL: Duration = Duration::from_millis(50);

/// Forces of a check.
const FORCES: &str = "newtons above 0 and up to the force limit of the axis";

/// Arguments of `board check-direction`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    axis: AxisArguments,
    /// Force, N: slightly more than the friction of the axis.
    #[arg(long, allow_negative_numbers = true)]
    force_n: f64,
    /// Longest time of the force, s; up to 1.
    #[arg(long, allow_negative_numbers = true, default_value_t = 0.2, value_name = "SECONDS")]
    time_s: f64,
    /// Distance that counts as motion and ends the force, mm; up to 5. More than twice the backlash.
    #[arg(long, allow_negative_numbers = true, default_value_t = 0.1, value_name = "MM")]
    distance_mm: f64,
    /// Do not wait for the enable switch: `board status` shows the result.
    #[arg(long)]
    no_wait: bool,
}

/// Runs the command.
///
/// # Errors
/// A board that cannot be reached or refuses it, a result other than ok.
pub fn run(arguments: &Arguments) -> Result<()> {
    let axis = arguments.axis.number()?;
    let settings = settings(arguments)?;
    let mut client = arguments.axis.connect()?;
    stop::write_partial_result();
    client.command(&Request::CheckDirection { axis, settings }).map_err(|error| refused(error, arguments))?;
    if arguments.no_wait {
        let off_s = f64::from(client.welcome().times.off_ms) / 1e3;
        return print(&format!(
            "The check starts when the enable switch is closed, after it was open, within {off_s} s and before another command \
             opens a session."
        ));
    }
    let result = wait(&mut client)?;
    let sentence = refusal::direction(axis, result);
    match result {
        DirectionResult::Ok | DirectionResult::OkWithoutScale => print(&format!("{sentence}.")),
        _ => bail!(sentence),
    }
}

/// The settings, whose numbers are checked before the board gets them.
fn settings(arguments: &Arguments) -> Result<DirectionCheckSettings, InputError> {
    let Arguments { force_n, time_s, distance_mm, .. } = *arguments;
    check_value("--force-n", FORCES, force_n > 0.0 && force_n.is_finite(), force_n)?;
    let settings = DirectionCheckSettings { force_n, time_s, detect_m: 1e-3 * distance_mm };
    // The check of the board itself: neither axis nor tick rate matters to it.
    let problem = match DirectionCheck::<1>::new(0, &settings, 1.0) {
        Err(DirectionCheckError::Setting(name)) => Some(name),
        _ => None,
    };
    check_value("--time-s", "seconds above 0 and up to 1", problem != Some("time_s"), time_s)?;
    check_value("--distance-mm", "a distance from 1e-12 to 5 mm", problem != Some("detect_m"), distance_mm)?;
    Ok(settings)
}

/// Only the board knows the force limit of the axis, and whether it has a brake.
fn refused(error: BoardError, Arguments { axis, force_n, .. }: &Arguments) -> anyhow::Error {
    match error {
        BoardError::Refused(Refusal::Direction(DirectionProblem::Brake)) => {
            let expected = "an axis without a brake (with open loops it would fall)";
            InputError::expected("--axis", expected, &axis.axis).into()
        }
        BoardError::Refused(Refusal::Direction(DirectionProblem::Force)) => {
            InputError::expected("--force-n", FORCES, format!("{force_n:?}")).into()
        }
        error => error.into(),
    }
}

/// Waits for the result. An interrupt ends the check.
fn wait(client: &mut Client) -> Result<DirectionResult> {
    let progress = Progress::start();
    progress.show("waiting for the enable switch to be opened and closed");
    loop {
        if let DirectionReport::Ended { result, .. } = client.status()?.direction {
            return Ok(result);
        }
        if stop::is_interrupted() {
            client.command(&Request::Stop)?;
            return Err(stop::Stopped { done: 0, asked: 1, what: "checks; the force is off" }.into());
        }
        sleep(POLL);
    }
}
