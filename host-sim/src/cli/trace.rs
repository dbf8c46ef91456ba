//! `lost-motion trace`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::progress::Progress;
use super::{keeps, say, summary};
use crate::log::Log;
use crate::machine::Machine;
use crate::output::write_whole;
use crate::report::{self, Extra};
use crate::trace;

/// Arguments of `trace`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Machine file: what is declared.
    #[arg(long)]
    machine: PathBuf,
    /// A log to explain (CSV, .csv.gz, or - for stdin); may be given several times.
    #[arg(long, required = true)]
    fit: Vec<PathBuf>,
    /// A log that takes part in no fit and no choice; without one the last quarter of each fit log.
    #[arg(long)]
    validate: Vec<PathBuf>,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write the better machine file.
    #[arg(long)]
    model: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let logs = arguments.fit.iter().chain(&arguments.validate);
    let inputs: Vec<&Path> = logs.chain([&arguments.machine]).map(PathBuf::as_path).collect();
    keeps(&inputs, &[("--json", arguments.json.as_ref()), ("--model", arguments.model.as_ref())])?;
    let machine = Machine::read(&arguments.machine)?;
    let read = |paths: &[PathBuf]| paths.iter().map(|path| Log::read(path)).collect::<Result<Vec<_>, _>>();
    let progress = Progress::start();
    progress.say("reading the logs");
    let (fit, validate) = (read(&arguments.fit)?, read(&arguments.validate)?);
    let trace = trace::trace(&machine, &fit, &validate, &|what| progress.say(what))?;
    drop(progress);
    let mut said = summary::of_trace(&trace);
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&trace::report::json(&trace))?;
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
    }
    if let Some(path) = &arguments.model {
        write_whole(path, |out| out.write_all(trace.better_machine().to_toml().as_bytes()))?;
    }
    if let Some(folder) = &arguments.report {
        let title = format!("Lost motion of {}", machine.name);
        let path = report::write(folder, &trace, &Extra { title, ..Extra::default() })?;
        said += &format!("\n\nReport: {}", path.display());
    }
    say(&said)
}
