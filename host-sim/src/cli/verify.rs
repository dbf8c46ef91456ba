//! `lost-motion verify`: the same motions before and after a change.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use serde_json::json;

use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use compensate::CompensationFile;
use compensate::alignment::aligned;
use contour::comparison;
use contour::verification::{Change, Prediction, Predictions, VerifiedMotion, pairs};
use files::error::InputError;
use files::log::{Log, Unit};
use model::machine::Machine;
use report::verification_page::{self, remarks, summary};

/// Arguments of `verify`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Machine file.
    #[arg(long)]
    machine: PathBuf,
    /// Log before the change (CSV, .csv.gz, or - for stdin); may be given several times.
    #[arg(long, required = true)]
    before: Vec<PathBuf>,
    /// Log of the same motion after the change; may be given several times, in any order.
    #[arg(long, required = true)]
    after: Vec<PathBuf>,
    /// Compensation file with the predictions.
    #[arg(long)]
    predicted: Option<PathBuf>,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, output that cannot be written; a motion that became worse or is not as predicted.
pub fn run(arguments: &Arguments) -> Result<()> {
    let logs = arguments.before.iter().chain(&arguments.after);
    let inputs: Vec<&Path> =
        logs.chain(&arguments.predicted).chain([&arguments.machine]).map(PathBuf::as_path).collect();
    let page = pages::file_in(arguments.report.as_ref());
    check_outputs(
        &inputs,
        &[Output::File("--json", arguments.json.as_ref()), Output::InNewFolder("--report", page.as_ref())],
    )?;
    let machine = Machine::read(&arguments.machine)?;
    let predictions = match &arguments.predicted {
        Some(file) => Predictions(CompensationFile::read(file, &machine)?.predicted),
        None => Predictions::default(),
    };
    let motions = verified(arguments, &machine, &predictions)?;
    if let Some(file) = &arguments.predicted {
        check_predictions(file, &predictions, &motions)?;
    }
    let all: Vec<_> = motions.iter().map(VerifiedMotion::json).collect();
    write_json(arguments.json.as_ref(), &json!({"motions": all}))?;
    let mut output = text(&motions, arguments.predicted.is_some());
    if let Some(folder) = &arguments.report {
        let path = verification_page::write(folder, &machine.name, &motions)?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)?;
    failure(&motions)
}

/// Checks that at least one motion has a prediction: without one, nothing would be compared.
fn check_predictions(
    file: &Path,
    predictions: &Predictions,
    motions: &[VerifiedMotion],
) -> Result<(), InputError> {
    if motions.iter().any(|motion| motion.predicted.is_some()) {
        return Ok(());
    }
    let path = |name: &str, length_mm: f64| format!("{name} (a path of {length_mm:.3} mm)");
    let logged: Vec<String> = motions.iter().map(|motion| path(&motion.name, motion.length_mm)).collect();
    let entry = |entry: &Prediction| {
        entry.path_length_mm.map_or_else(|| entry.motion.clone(), |length_mm| path(&entry.motion, length_mm))
    };
    let predicted: Vec<String> = predictions.0.iter().map(entry).collect();
    let found = if predicted.is_empty() { "none".to_owned() } else { predicted.join(", ") };
    let expected = format!("a prediction of {}", logged.join(" or "));
    Err(InputError::expected(&file.display().to_string(), expected, found).at_key("predicted"))
}

/// The motions of all pairs of logs.
fn verified(
    arguments: &Arguments,
    machine: &Machine,
    predictions: &Predictions,
) -> Result<Vec<VerifiedMotion>, InputError> {
    let progress = Progress::start();
    progress.show("reading the logs");
    let read = |paths: &[PathBuf]| paths.iter().map(|path| Log::read(path)).collect::<Result<Vec<_>, _>>();
    let (before, after) = (read(&arguments.before)?, read(&arguments.after)?);
    for log in before.iter().chain(&after) {
        check_axes(log, machine)?;
    }
    let [before, after] =
        [before, after].map(|logs| -> Vec<Log> { logs.iter().map(|log| aligned(log, machine)).collect() });
    let pairs = pairs(&before, &after)?;
    let motions = before.iter().zip(pairs);
    motions.map(|(log, index)| VerifiedMotion::new(log, &after[index], predictions)).collect()
}

/// Checks that the machine has the linear axes of a log.
fn check_axes(log: &Log, machine: &Machine) -> Result<(), InputError> {
    let linear = || log.axes.iter().filter(|axis| axis.unit == Unit::Millimetre);
    match linear().find(|axis| !machine.axis.contains_key(&axis.name)) {
        Some(axis) => {
            let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
            let expected = format!("axes of the machine file ({})", names.join(", "));
            Err(InputError::expected(&log.source, expected, format!("axis {}", axis.name)))
        }
        None => Ok(()),
    }
}

/// A sentence, a table, and remarks.
fn text(motions: &[VerifiedMotion], has_predictions: bool) -> String {
    let mut lines = vec![
        summary(motions),
        String::new(),
        comparison::text(&motions.iter().map(VerifiedMotion::comparison).collect::<Vec<_>>()),
    ];
    let mut remarks = remarks(motions);
    if has_predictions {
        let missing = motions.iter().filter(|motion| motion.predicted.is_none());
        remarks.extend(
            missing.map(|motion| format!("{}: the compensation file has no prediction.", motion.name)),
        );
    }
    if !remarks.is_empty() {
        lines.push(String::new());
        lines.extend(remarks);
    }
    lines.join("\n")
}

/// Fails if a motion became worse or is not as predicted.
fn failure(motions: &[VerifiedMotion]) -> Result<()> {
    let names = |is: &dyn Fn(&VerifiedMotion) -> bool| {
        let names: Vec<&str> =
            motions.iter().filter(|motion| is(motion)).map(|motion| motion.name.as_str()).collect();
        names.join(", ")
    };
    let worse = names(&|motion| motion.change() == Change::Worse);
    let unpredicted = names(&|motion| motion.is_as_predicted() == Some(false));
    match (worse.is_empty(), unpredicted.is_empty()) {
        (true, true) => Ok(()),
        (false, true) => bail!("the contour error became larger: {worse}"),
        (true, false) => bail!("the contour error is not as predicted: {unpredicted}"),
        (false, false) => {
            bail!("the contour error became larger: {worse}; it is not as predicted: {unpredicted}")
        }
    }
}
