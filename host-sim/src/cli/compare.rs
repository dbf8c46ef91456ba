//! `lost-motion compare`.

use std::path::PathBuf;

use anyhow::Result;

use super::progress::Progress;
use super::say;
use crate::compare::motion::Motion;
use crate::compare::pipeline::Pipeline;
use crate::compare::{self, Comparison, Options, Row};
use crate::controller::Format;
use crate::error::InputError;
use crate::link::emulator::{self, Emulator};
use crate::output::write_whole;
use crate::report;

/// Longest long run, h: a year.
const MOST_HOURS: f64 = 8760.0;

/// Arguments of `compare`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    /// Program of the emulated core, for the instructions of a tick; without it the one that `cargo emulated`
    /// has built, where there is one.
    #[arg(long)]
    emulator: Option<PathBuf>,
    /// Length of the long run, in hours.
    #[arg(long, default_value_t = 24.0)]
    hours: f64,
}

/// Runs the command.
///
/// # Errors
/// Arguments that cannot be used, a loop that does not hold, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    if !(arguments.hours > 0.0 && arguments.hours <= MOST_HOURS) {
        let expected = format!("a number of hours above 0, at most {MOST_HOURS}");
        return Err(InputError::expected("--hours", expected, arguments.hours).into());
    }
    let (emulator, not_counted) = emulator(arguments)?;
    let progress = Progress::start();
    let options = Options { hours: arguments.hours, emulator };
    let mut comparison = compare::run(&options, &|what| progress.say(what))?;
    drop(progress);
    comparison.not_counted = not_counted;
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&comparison)?;
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
    }
    let mut said = summary(&comparison);
    if let Some(folder) = &arguments.report {
        let path = report::compare::write(folder, &comparison, &sentences(&comparison))?;
        said += &format!("\n\nReport: {}", path.display());
    }
    say(&said)
}

/// The program of the emulated core, or why there is none. One that was asked for has to work.
fn emulator(arguments: &Arguments) -> Result<(Option<PathBuf>, Option<String>)> {
    let program = arguments.emulator.clone().unwrap_or_else(emulator::default_program);
    match (Emulator::start(&program), &arguments.emulator) {
        (Ok(_), _) => Ok((Some(program), None)),
        (Err(problem), Some(_)) => Err(InputError::saying("--emulator", problem).into()),
        (Err(problem), None) => Ok((None, Some(problem))),
    }
}

/// What came out, in sentences.
fn sentences(comparison: &Comparison) -> Vec<String> {
    vec![String::new()]
}

fn summary(comparison: &Comparison) -> String {
    let mut lines = sentences(comparison);
    for row in &comparison.rows {
        lines.push(format!("{row:?}").chars().take(400).collect());
    }
    lines.join("\n")
}
