//! `lost-motion reproduce`.

use std::path::PathBuf;

use anyhow::Result;

use super::outputs::{check_json_and_page, print, write_json};
use super::progress::Progress;
use files::format::significant;
use studies::reproduce::{self, Reproduction};

/// Arguments of `reproduce`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html, with the pictures, into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// An experiment that cannot be run, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let page = pages::file_in(arguments.report.as_ref());
    check_json_and_page(&[], arguments.json.as_ref(), page.as_ref())?;
    let progress = Progress::start();
    let reproduction = reproduce::run(&|what| progress.show(what))?;
    drop(progress);
    write_json(arguments.json.as_ref(), &reproduction)?;
    let mut output = summary(&reproduction);
    if let Some(folder) = &arguments.report {
        let path = reproduce::page::write(folder, &reproduction, &sentence(&reproduction))?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)
}

/// The number of published values that agree.
fn sentence(reproduction: &Reproduction) -> String {
    let outcomes = || reproduction.studies.iter().flat_map(|study| &study.outcomes);
    let agree = outcomes().filter(|outcome| outcome.agrees()).count();
    format!(
        "{agree} of {} figures of {} papers agree with ours.",
        outcomes().count(),
        reproduction.studies.len()
    )
}

/// The sentence, then a table per paper.
fn summary(reproduction: &Reproduction) -> String {
    let mut lines = vec![sentence(reproduction)];
    for study in &reproduction.studies {
        lines.push(format!("\n{}: {}", study.paper, study.title));
        lines.extend(study.findings.iter().map(|sentence| format!("  {sentence}")));
        lines.push(format!("  {:<68}{:>18}{:>12}  {:<12}verdict", "quantity", "printed", "ours", "unit"));
        for outcome in &study.outcomes {
            lines.push(format!(
                "  {:<68}{:>18}{:>12}  {:<12}{}",
                outcome.quantity,
                outcome.printed.label(),
                significant(outcome.ours, 4),
                outcome.unit,
                if outcome.agrees() { "agrees" } else { "DIFFERS" }
            ));
        }
    }
    lines.join("\n")
}
