//! `lost-motion compare`.

use std::path::PathBuf;

use anyhow::Result;

use super::outputs::{check_json_and_page, print, write_json};
use super::progress::Progress;
use files::error::InputError;
use lockstep::emulator::{self, DEFAULT_TIMEOUT, Emulator};
use shared::scalar::Format;
use studies::compare::motion::Motion;
use studies::compare::page::nanometres;
use studies::compare::pipeline::Pipeline;
use studies::compare::{self, Comparison, Options, Row};

/// Maximum of `--hours`: a year.
const MAX_HOURS: f64 = 8760.0;

/// Arguments of `compare`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    /// Program of the emulated core, to count the instructions of a tick. Default: the one built by `cargo emulated`,
    /// if it exists.
    #[arg(long)]
    emulator: Option<PathBuf>,
    /// Length of the long run, in hours.
    #[arg(long, default_value_t = 24.0)]
    hours: f64,
}

/// Runs the command.
///
/// # Errors
/// Invalid arguments, a fault of the loop, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    if !(arguments.hours > 0.0 && arguments.hours <= MAX_HOURS) {
        let expected = format!("a number of hours above 0, at most {MAX_HOURS}");
        return Err(InputError::expected("--hours", expected, arguments.hours).into());
    }
    let page = pages::file_in(arguments.report.as_ref());
    check_json_and_page(&[], arguments.json.as_ref(), page.as_ref())?;
    let (emulator, not_counted) = emulator(arguments)?;
    let progress = Progress::start();
    let options = Options { hours: arguments.hours, emulator };
    let mut comparison = compare::run(&options, &|what| progress.show(what))?;
    drop(progress);
    comparison.not_counted = not_counted;
    write_json(arguments.json.as_ref(), &comparison)?;
    let mut output = summary(&comparison);
    if let Some(folder) = &arguments.report {
        let path = compare::page::write(folder, &comparison, &sentences(&comparison, NOT_STARTED))?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)
}

/// The program of the emulated core, or the reason why there is none. It is an error if a program that is given by
/// argument does not start.
fn emulator(arguments: &Arguments) -> Result<(Option<PathBuf>, Option<String>)> {
    let program = arguments.emulator.clone().unwrap_or_else(emulator::default_program);
    match (Emulator::start(&program, DEFAULT_TIMEOUT), &arguments.emulator) {
        (Ok(_), _) => Ok((Some(program), None)),
        (Err(problem), Some(_)) => Err(InputError::new("--emulator", problem).into()),
        (Err(problem), None) => Ok((None, Some(problem))),
    }
}

/// Why the instructions of a page were not counted: a page is passed on, and names no file of this computer.
const NOT_STARTED: &str = "the program of the emulated core could not be started";

/// The results in sentences; `not_counted` is the reason if no instructions were counted.
fn sentences(comparison: &Comparison, not_counted: &str) -> Vec<String> {
    let fixed = Pipeline::Of(Format::Fixed);
    let worst = |figure: fn(&Row) -> f64| numerics::max_abs(comparison.of(fixed).map(figure));
    let of = |pipeline, motion: Motion| comparison.of(pipeline).find(|row| row.motion == motion.name());
    let hours = comparison.hours;
    let mut lines = vec![format!(
        "Fixed point stays within {} nm of double precision ({} nm rms) on every motion with friction in the loop. \
         After {hours} h of circles, {} turns, its command ends {} nm from the programmed point; the correction at \
         the end of a block is at most {} nm.",
        nanometres(worst(|row| row.position_error_nm.max)),
        nanometres(worst(|row| row.position_error_nm.rms)),
        comparison.turns,
        nanometres(comparison.long_run.end_nm),
        nanometres(comparison.long_run.landing_nm),
    )];
    if let (Some(step), Some(day)) =
        (of(Pipeline::F32Position, Motion::Steps), of(Pipeline::F32Position, Motion::LongRun))
    {
        lines.push(format!(
            "With positions in f32 metres the command has an error of {} nm rms at 1 m; after {hours} h it is {} mm \
             from the programmed point.",
            nanometres(step.command_error_nm.rms),
            nanometres(1e-6 * day.drift_nm.unwrap_or(f64::NAN)),
        ));
    }
    lines.push(if comparison.not_counted.is_some() {
        format!("Instructions were not counted: {not_counted}.")
    } else {
        cost(comparison)
    });
    lines
}

/// Minimum and maximum of the medians over the motions, and the maximum of all ticks.
fn cost(comparison: &Comparison) -> String {
    let of = |format: Format, name: &str| {
        let medians = || comparison.of(Pipeline::Of(format)).filter_map(|row| row.instructions_per_tick);
        let most = comparison.of(Pipeline::Of(format)).filter_map(|row| row.max_instructions).max();
        format!(
            "{} to {} in {name} (at most {})",
            medians().min().unwrap_or(0),
            medians().max().unwrap_or(0),
            most.unwrap_or(0)
        )
    };
    format!(
        "Instructions of a tick with position loops, by motion: {}, {}, {}.",
        of(Format::Fixed, "fixed point"),
        of(Format::F32, "f32"),
        of(Format::F64, "f64")
    )
}

/// The sentences, then a table with a row per motion and number format.
fn summary(comparison: &Comparison) -> String {
    let problem = comparison.not_counted.as_deref().unwrap_or_default();
    let mut lines = sentences(comparison, problem);
    lines.push(String::new());
    lines.push(format!(
        "{:<10}{:<14}{:>26}{:>26}{:>13}{:>8}",
        "", "", "command error, nm", "position error, nm", "drift, nm", "instr."
    ));
    lines.push(format!(
        "{:<10}{:<14}{:>13}{:>13}{:>13}{:>13}",
        "motion", "scalar", "max", "rms", "max", "rms"
    ));
    for row in &comparison.rows {
        let Row { command_error_nm: command, position_error_nm: position, .. } = row;
        let [a, b, c, d] = [command.max, command.rms, position.max, position.rms].map(nanometres);
        let drift = row.drift_nm.map_or_else(|| "–".to_owned(), nanometres);
        let instructions =
            row.instructions_per_tick.map_or_else(|| "–".to_owned(), |count| count.to_string());
        lines.push(format!(
            "{:<10}{:<14}{a:>13}{b:>13}{c:>13}{d:>13}{drift:>13}{instructions:>8}",
            row.motion, row.scalar
        ));
    }
    lines.join("\n")
}
