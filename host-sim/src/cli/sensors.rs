//! `lost-motion sensors`: one machine with its position loop closed by the motor, the table and both.

use std::path::PathBuf;

use anyhow::Result;

use super::outputs::{check_json_and_page, print, write_json};
use super::progress::Progress;
use studies::sensors;

/// Arguments of `sensors`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html, with the picture, into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// A motion that cannot be simulated, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let page = pages::file_in(arguments.report.as_ref());
    check_json_and_page(&[], arguments.json.as_ref(), page.as_ref())?;
    let progress = Progress::start();
    let study = sensors::run(&|what| progress.show(what))?;
    drop(progress);
    write_json(arguments.json.as_ref(), &study)?;
    let mut output = sensors::text::of(&study);
    if let Some(folder) = &arguments.report {
        let path = sensors::page::write(folder, &study)?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)
}
