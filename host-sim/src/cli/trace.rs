//! `lost-motion trace`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use super::reading::ReadingArguments;
use super::{friction_map, logs, summary};
use budget::traced::Document;
use contour::log_error::LogError;
use files::output::write_whole;
use model::machine::Machine;
use report::trace_page::{self, Extra};
use trace::{AxisIdentification, Identification, Request, Task};

/// Arguments of `trace`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Machine file with the declared model.
    #[arg(long, required_unless_present = "friction_map")]
    machine: Option<PathBuf>,
    /// Log to fit (CSV, .csv.gz, - for stdin, or of another program, see below); may be given several times.
    #[arg(long, required_unless_present = "friction_map")]
    fit: Vec<PathBuf>,
    /// Log that is not used in any fit; an effect that increases its residual is refuted. May be given several times.
    /// Default: the last quarter of each fit log.
    #[arg(long)]
    validate: Vec<PathBuf>,
    /// Steady-state friction map, instead of machine and logs (CSV, one row per run at constant speed).
    #[arg(long, conflicts_with_all = ["machine", "fit", "validate", "model", "propose", "empirical"])]
    friction_map: Option<PathBuf>,
    /// Evaluate the machine file on the logs without searching for effects: "before" has the values of the file, "after"
    /// has its declared values fitted.
    #[arg(long, conflicts_with_all = ["propose", "friction_map"])]
    evaluate: bool,
    /// Add the unexplained residuals as tables over the variables on which they depend, if held-out data support them; they
    /// become part of the model.
    #[arg(long)]
    empirical: bool,
    /// Write the motion file that distinguishes two effects best, if the logs do not distinguish them.
    #[arg(long, value_name = "MOTION.toml")]
    propose: Option<PathBuf>,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write the better machine file.
    #[arg(long)]
    model: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArguments,
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let (json, folder) = (arguments.json.as_ref(), arguments.report.as_ref());
    match (&arguments.friction_map, &arguments.machine) {
        (Some(map), _) => friction_map::run(map, json, folder),
        (None, Some(machine)) => trace_logs(arguments, machine),
        // clap requires one of them.
        (None, None) => Ok(()),
    }
}

fn trace_logs(arguments: &Arguments, machine: &Path) -> Result<()> {
    let logs = arguments.fit.iter().chain(&arguments.validate);
    let inputs: Vec<&Path> = logs.map(PathBuf::as_path).chain([machine]).collect();
    let page = pages::file_in(arguments.report.as_ref());
    let outputs = [
        Output::File("--json", arguments.json.as_ref()),
        Output::File("--model", arguments.model.as_ref()),
        Output::File("--propose", arguments.propose.as_ref()),
        Output::InNewFolder("--report", page.as_ref()),
    ];
    check_outputs(&inputs, &outputs)?;
    let reading = arguments.reading.request()?;
    let machine = Machine::read(machine)?;
    let progress = Progress::start();
    progress.show("reading the logs");
    let (fit, validate) = (logs::read(&arguments.fit, &reading)?, logs::read(&arguments.validate, &reading)?);
    let (machine, of_gains) = ::init::gains::of_unknown(&machine, &fit);
    // Before the trace, which leaves memory in pieces that a path cannot use.
    let contour_errors = LogError::all(fit.iter().chain(&validate));
    let show = |what: &str| progress.show(what);
    let task = if arguments.evaluate { Task::Evaluate } else { Task::Search };
    let request = Request { task, tables: arguments.empirical };
    let trace = trace::requested(&machine, [&fit, &validate], request, &show)?;
    drop(progress);
    let mut output = summary::of_trace(&trace);
    for note in of_gains {
        output += &format!("\n\n{note}");
    }
    if !contour_errors.is_empty() {
        output += &format!("\n\n{}", contour::text::of_logs(&contour_errors));
    }
    if arguments.empirical {
        output += &summary::of_tables(&trace);
    }
    output += &write(arguments, &trace, contour_errors)?;
    print(&output)
}

/// Writes the outputs that are asked for; gives what the summary says of them.
fn write(arguments: &Arguments, trace: &Identification, contour_errors: Vec<LogError>) -> Result<String> {
    let mut said = String::new();
    if let Some(path) = &arguments.propose {
        said += propose(trace, path)?;
    }
    let budget = match (&arguments.json, &arguments.report) {
        (None, None) => None,
        _ => match budget::traced::budget(trace) {
            Ok(budget) => budget,
            Err(error) => {
                said += &format!("\n\nNo error budget: {error}.");
                None
            }
        },
    };
    let document = trace::json::Document::of(trace, &contour_errors, arguments.empirical);
    write_json(arguments.json.as_ref(), &Document::of(document, budget.as_ref()))?;
    if let Some(path) = &arguments.model {
        write_whole(path, |out| out.write_all(trace.better_machine().to_toml().as_bytes()))?;
    }
    if let Some(folder) = &arguments.report {
        let title = format!("Lost motion of {}", trace.machine().name);
        let path =
            trace_page::write(folder, trace, &Extra { title, contour_errors, budget, ..Extra::default() })?;
        said += &format!("\n\nReport: {}", path.display());
    }
    Ok(said)
}

/// Writes the motion that distinguishes two ambiguous effects best; gives a sentence if there are none.
fn propose(trace: &Identification, path: &Path) -> Result<&'static str> {
    let alike = trace.axes().iter().flat_map(AxisIdentification::ambiguities_with_motions);
    let proposals = alike.filter_map(|(_, proposal)| proposal);
    match proposals.max_by(|a, b| a.difference.total_cmp(&b.difference)) {
        Some(proposal) => {
            write_whole(path, |out| out.write_all(proposal.to_toml().as_bytes()))?;
            Ok("")
        }
        None => Ok("\nNo motion is proposed: no effects are ambiguous in these logs."),
    }
}
