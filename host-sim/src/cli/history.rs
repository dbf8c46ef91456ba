//! `lost-motion history`: what changed on a machine over months.

use std::path::PathBuf;

use anyhow::{Result, bail};

use super::outputs::{Output, check_outputs, print, write_json};
use ::history::forecast::{Limit, Reached, Side};
use ::history::{History, folder, json, page, table, text};
use files::output::write_whole;

/// Arguments of `history`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Folder with the traces of one machine: JSON files of `trace --json`, or machine files of `trace --model`, each with its date in the
    /// file, in its name or in that of its folder.
    folder: PathBuf,
    /// Largest value, as `x.backlash.width_um=8`: tells when it will be exceeded. May be given several times.
    #[arg(long = "limit", value_name = "NAME=VALUE")]
    at_most: Vec<Limit>,
    /// Smallest value, as `x.stiffness_n_per_um=90`. May be given several times.
    #[arg(long, value_name = "NAME=VALUE")]
    at_least: Vec<Limit>,
    /// Exit with 1 if the last trace announces a change, or if a limit is not known to be kept.
    #[arg(long)]
    check: bool,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    /// Write every figure of every trace as a table (Parquet).
    #[arg(long)]
    parquet: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// A folder that cannot be used, output that cannot be written; with `--check`, a change or a limit that is not kept.
pub fn run(arguments: &Arguments) -> Result<()> {
    let report = pages::file_in(arguments.report.as_ref());
    let outputs = [
        Output::File("--json", arguments.json.as_ref()),
        Output::File("--parquet", arguments.parquet.as_ref()),
        Output::InNewFolder("--report", report.as_ref()),
    ];
    let traces = folder::read(&arguments.folder)?;
    check_outputs(&traces.files.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &outputs)?;
    let at_least = arguments.at_least.iter().map(|limit| Limit { side: Side::AtLeast, ..limit.clone() });
    let limits = arguments.at_most.iter().cloned().chain(at_least).collect();
    let history = History::of(traces, limits)?;
    write_json(arguments.json.as_ref(), &json::of(&history))?;
    if let Some(path) = &arguments.parquet {
        let bytes = table::parquet(&history)?;
        write_whole(path, |out| out.write_all(&bytes))?;
    }
    let mut output = text::of(&history);
    if let Some(folder) = &arguments.report {
        output += &format!("\n\nReport: {}", page::write(folder, &history)?.display());
    }
    print(&output)?;
    if arguments.check { checked(&history) } else { Ok(()) }
}

/// Fails if the last trace announces a change, or if a limit is not known to be kept.
fn checked(history: &History) -> Result<()> {
    let changed = history.alarmed_last().map(|series| format!("{} changed", series.name));
    let is_kept = |reached: &Reached| matches!(reached, Reached::On { .. } | Reached::NotInSight { .. });
    let limits = history.limits.iter().filter(|(_, reached)| !is_kept(reached));
    let limits = limits.map(|(limit, reached)| format!("{} {reached}", limit.name));
    let problems: Vec<String> = changed.chain(limits).collect();
    if problems.is_empty() {
        return Ok(());
    }
    bail!("{}", problems.join("; "))
}
