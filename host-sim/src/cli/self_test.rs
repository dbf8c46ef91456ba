//! `lost-motion self-test`.

use std::path::PathBuf;

use anyhow::Result;

use super::progress::Progress;
use super::say;
use crate::self_test::case::Case;

/// Arguments of `self-test`.
#[derive(clap::Args)]
pub struct Arguments {
    /// How many machines are drawn.
    #[arg(long, default_value_t = 20)]
    cases: u64,
    /// Draws all machines and all noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write each case as a folder of files into this one.
    #[arg(long)]
    keep: Option<PathBuf>,
    /// Only draw and keep.
    #[arg(long, requires = "keep")]
    no_trace: bool,
}

/// Runs the command.
///
/// # Errors
/// When an output cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let progress = Progress::start();
    for number in 1..=arguments.cases {
        progress.say(&format!("case {number} of {}", arguments.cases));
        let case = Case::draw(arguments.seed, number)?;
        if let Some(folder) = &arguments.keep {
            case.keep(folder)?;
        }
    }
    drop(progress);
    say("")
}
