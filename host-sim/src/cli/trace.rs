//! `lost-motion trace`.

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::ArgGroup;

use super::certificate::{self, CertificateArguments};
use super::limits::{self, ToolLimitArguments};
use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use super::reading::ReadingArguments;
use super::{friction_map, logs, summary};
use budget::traced::Document;
use contour::log_error::LogError;
use files::output::write_whole;
use model::machine::Machine;
use report::trace_page::{self, Extra};
use trace::result::distinguishing_motion::Proposal;
use trace::result::refuting_motion::Refutation;
use trace::{AxisIdentification, Identification, Request, Task};

/// Arguments that a friction map does not take.
const NOT_OF_A_MAP: [&str; 11] = [
    "machine",
    "fit",
    "validate",
    "model",
    "propose",
    "empirical",
    "limits",
    "serial",
    "operator",
    "date",
    "temperature_c",
];

/// Arguments of `trace`.
#[derive(clap::Args)]
#[command(group(ArgGroup::new(certificate::OUTPUTS).args(["json", "report"]).multiple(true)))]
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
    #[arg(long, conflicts_with_all = NOT_OF_A_MAP)]
    friction_map: Option<PathBuf>,
    /// Evaluate the machine file on the logs without searching for effects: "before" has the values of the file, "after"
    /// has its declared values fitted.
    #[arg(long, conflicts_with_all = ["propose", "friction_map"])]
    evaluate: bool,
    /// Add the unexplained residuals as laws, or as tables over the variables on which they depend, if held-out data support them;
    /// they become part of the model.
    #[arg(long)]
    empirical: bool,
    /// Also print the residual of each stage before and after, of fitted and held-out motions.
    #[arg(long, conflicts_with = "friction_map")]
    details: bool,
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
    certificate: CertificateArguments,
    #[command(flatten)]
    limits: ToolLimitArguments,
    #[command(flatten)]
    reading: ReadingArguments,
}

impl Arguments {
    /// All files and folders of the command line.
    fn paths(&self) -> Vec<&Path> {
        let outputs = [&self.json, &self.model, &self.propose, &self.report].into_iter().flatten();
        let inputs = self.machine.iter().chain(&self.fit).chain(&self.validate);
        inputs.chain(outputs).map(PathBuf::as_path).collect()
    }
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, output that cannot be written; with `--check`, a limit that is not kept or not known to be.
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
    // Before the trace, which leaves memory in pieces that a path cannot use.
    let contour_errors = LogError::all(fit.iter().chain(&validate));
    let show = |what: &str| progress.show(what);
    let (machine, estimated) = ::init::estimate::unknown_values(&machine, &fit, &show);
    let task = if arguments.evaluate { Task::Evaluate } else { Task::Search };
    let request = Request { task, tables: arguments.empirical };
    let trace = trace::requested(&machine, [&fit, &validate], request, &show)?;
    progress.show("simulating what each cause costs");
    let mut extra = Extra { contour_errors, ..Extra::default() };
    let judged = judge(arguments, &trace, &mut extra);
    drop(progress);
    let mut output = summary::of_trace(&trace, extra.budget.as_ref(), arguments.details);
    for note in estimated {
        output += &format!("\n\n{note}");
    }
    if !extra.contour_errors.is_empty() {
        output += &format!("\n\n{}", contour::text::of_logs(&extra.contour_errors));
    }
    if arguments.empirical {
        output += &summary::of_tables(&trace);
    }
    output += &judged;
    output += &write(arguments, &trace, &mut extra)?;
    print(&output)?;
    arguments.limits.checked(&extra.limits)
}

/// The error budget and the limits; gives what the summary says of them.
fn judge(arguments: &Arguments, trace: &Identification, extra: &mut Extra) -> String {
    let limits = arguments.limits.all();
    let said = match budget::traced::budget(trace) {
        Ok(budget) => {
            extra.budget = budget;
            let first = extra.budget.as_ref().and_then(|budget| budget.motions.first());
            first.map_or_else(String::new, |motion| format!("\n\n{}", budget::text::of_motion(motion)))
        }
        Err(error) => format!("\n\nNo error budget: {error}."),
    };
    extra.limits = budget::traced::limits(trace, &extra.contour_errors, extra.budget.as_ref(), limits);
    said + &limits::text(&extra.limits)
}

/// Writes the outputs that are asked for; gives what the summary says of them.
fn write(arguments: &Arguments, trace: &Identification, extra: &mut Extra) -> Result<String> {
    let mut said = String::new();
    if let Some(path) = &arguments.propose {
        said += propose(trace, path)?;
    }
    let document = trace::json::Document::of(trace, &extra.contour_errors, arguments.empirical);
    let document = Document::of(document, extra.budget.as_ref(), &extra.limits);
    write_json(arguments.json.as_ref(), &document.under(arguments.certificate.traced()))?;
    if let Some(path) = &arguments.model {
        write_whole(path, |out| out.write_all(trace.better_machine().to_toml().as_bytes()))?;
    }
    if let Some(folder) = &arguments.report {
        extra.title = format!("Lost motion of {}", trace.machine().name);
        extra.circumstances = arguments.certificate.circumstances(&arguments.paths());
        said += &format!("\n\nReport: {}", trace_page::write(folder, trace, extra)?.display());
    }
    Ok(said)
}

/// Writes the motion that distinguishes two ambiguous effects best, or without these the one that would refute a law; gives a sentence if there are none.
fn propose(trace: &Identification, path: &Path) -> Result<&'static str> {
    let alike = trace.axes().iter().flat_map(AxisIdentification::ambiguities_with_motions);
    let proposals = alike.filter_map(|(_, proposal)| proposal);
    let proposal = proposals.max_by(|a, b| a.difference.total_cmp(&b.difference)).map(Proposal::to_toml);
    let laws = trace.axes().iter().flat_map(AxisIdentification::laws_with_motions);
    let of_laws = laws.filter_map(|(_, refutation)| refutation);
    let of_law = || of_laws.max_by(|a, b| a.clarity().total_cmp(&b.clarity())).map(Refutation::to_toml);
    match proposal.or_else(of_law) {
        Some(motion) => {
            write_whole(path, |out| out.write_all(motion.as_bytes()))?;
            Ok("")
        }
        None => Ok("\nNo motion is proposed: no effects are ambiguous in these logs."),
    }
}
