//! `lost-motion verify`: the same motions before and after a change.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use serde_json::json;

use super::limits::{self, ToolLimitArguments};
use super::logs;
use super::outputs::{check_json_and_page, print, write_json};
use super::progress::Progress;
use super::reading::ReadingArguments;
use super::sound_logs::SoundLogs;
use budget::limits::judged_by_logs;
use commissioning::compensate::alignment::aligned;
use commissioning::compensate::{CompensationFile, mapped};
use contour::comparison;
use contour::log_error::LogError;
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
    /// Log before the change (CSV, .csv.gz, - for stdin, or of another program, see below); may be given several times.
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
    #[command(flatten)]
    limits: ToolLimitArguments,
    #[command(flatten)]
    reading: ReadingArguments,
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, output that cannot be written; a motion that became worse or is not as predicted; with `--check`, a limit
/// that is not kept after the change or not known to be.
pub fn run(arguments: &Arguments) -> Result<()> {
    let logs = arguments.before.iter().chain(&arguments.after);
    let inputs: Vec<&Path> =
        logs.chain(&arguments.predicted).chain([&arguments.machine]).map(PathBuf::as_path).collect();
    let page = pages::file_in(arguments.report.as_ref());
    check_json_and_page(&inputs, arguments.json.as_ref(), page.as_ref())?;
    let machine = Machine::read(&arguments.machine)?;
    let compensation = arguments.predicted.as_deref().map(|file| CompensationFile::read(file, &machine));
    let compensation = compensation.transpose()?.unwrap_or_default();
    let predictions = Predictions(compensation.predicted.clone());
    let (motions, mut remarks) = verified(arguments, &machine, &predictions)?;
    remarks.extend(motions.iter().flat_map(|motion| beyond(motion, &compensation)));
    if let Some(file) = &arguments.predicted {
        check_predictions(file, &predictions, &motions)?;
    }
    let all: Vec<_> = motions.iter().map(VerifiedMotion::json).collect();
    let after: Vec<LogError> = motions.iter().map(VerifiedMotion::log_after).collect();
    let limits = judged_by_logs(arguments.limits.all(), &after);
    write_json(arguments.json.as_ref(), &json!({"motions": all, "limits": limits}))?;
    let mut output = text(&motions, arguments.predicted.is_some(), &remarks) + &limits::text(&limits);
    if let Some(folder) = &arguments.report {
        let path = verification_page::write(folder, &machine.name, &motions, &limits)?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)?;
    failure(&motions)?;
    arguments.limits.checked(&limits)
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
    let logged: Vec<String> =
        motions.iter().map(|motion| path(&motion.name, motion.command.length_mm)).collect();
    let others: Vec<&str> = motions.iter().filter_map(|motion| motion.not_comparable.as_deref()).collect();
    let entry = |entry: &Prediction| {
        entry.path_length_mm.map_or_else(|| entry.motion.clone(), |length_mm| path(&entry.motion, length_mm))
    };
    let predicted: Vec<String> = predictions.0.iter().map(entry).collect();
    let found = match (predicted.is_empty(), others.is_empty()) {
        (true, _) => "none".to_owned(),
        (false, true) => predicted.join(", "),
        (false, false) => format!("one that is not comparable: {}", others.join("; ")),
    };
    let expected = format!("a prediction of {}", logged.join(" or "));
    Err(InputError::expected(&file.display().to_string(), expected, found).at_key("predicted"))
}

/// A sentence for each axis on which a motion leaves the travel that the compensation is made for.
fn beyond(motion: &VerifiedMotion, file: &CompensationFile) -> Vec<String> {
    let reached_m = |name: &str| {
        let points_mm = motion.command.reached_mm.get(name)?;
        Some(points_mm.map(|mm| 1e-3 * mm))
    };
    mapped::beyond(file, reached_m)
        .iter()
        .map(|beyond| format!("{}: {}", motion.name, beyond.sentence()))
        .collect()
}

/// The motions of all pairs of logs, and a sentence for each fault of their data.
fn verified(
    arguments: &Arguments,
    machine: &Machine,
    predictions: &Predictions,
) -> Result<(Vec<VerifiedMotion>, Vec<String>), InputError> {
    let request = arguments.reading.request()?;
    let progress = Progress::start();
    progress.show("reading the logs");
    let (before, after) = (logs::read(&arguments.before, &request)?, logs::read(&arguments.after, &request)?);
    for log in before.iter().chain(&after) {
        check_axes(log, machine)?;
    }
    let pairs = pairs(&before, &after)?;
    let [before, after] = [SoundLogs::of(before, machine)?, SoundLogs::of(after, machine)?];
    let remarks = before.remarks.into_iter().chain(after.remarks).collect();
    let [before, after] = [before.logs, after.logs]
        .map(|logs| -> Vec<Log> { logs.iter().map(|log| aligned(log, machine)).collect() });
    let motions = before.iter().zip(pairs);
    let motions = motions.map(|(log, index)| VerifiedMotion::new(log, &after[index], predictions));
    Ok((motions.collect::<Result<_, _>>()?, remarks))
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
fn text(motions: &[VerifiedMotion], has_predictions: bool, more: &[String]) -> String {
    let mut lines = vec![
        summary(motions),
        String::new(),
        comparison::text(&motions.iter().map(VerifiedMotion::comparison).collect::<Vec<_>>()),
    ];
    let mut remarks = remarks(motions);
    if has_predictions {
        let is_missing =
            |motion: &&VerifiedMotion| motion.predicted.is_none() && motion.not_comparable.is_none();
        let missing = motions.iter().filter(is_missing);
        remarks.extend(
            missing.map(|motion| format!("{}: the compensation file has no prediction.", motion.name)),
        );
    }
    remarks.extend(more.iter().cloned());
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
