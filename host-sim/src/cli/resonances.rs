//! `lost-motion resonances`: resonances from accelerations at the tool.

use std::path::PathBuf;

use anyhow::Result;

use super::logs::tell;
use super::outputs::{Output, check_outputs, print, write_json};
use commissioning::resonances::{self, json, text};
use files::error::InputError;
use import::accelerations;

/// Arguments of `resonances`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Accelerations as Klipper records them (`TEST_RESONANCES` with `OUTPUT=raw_data`, or `ACCELEROMETER_MEASURE`): CSV, .csv.gz, or - for stdin.
    accelerations: PathBuf,
    /// Write spectra and peaks as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Invalid input, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    check_outputs(&[&arguments.accelerations], &[Output::File("--json", arguments.json.as_ref())])?;
    let read = accelerations::read(&arguments.accelerations)?;
    tell(&read.source, &read.notes);
    let too_short = || {
        let found = format!("{} at {:.0} Hz", read.axes[0].1.len(), read.rate_hz);
        InputError::expected(&read.source, "samples of 3 s or more, at 60 Hz or more", found)
    };
    let axes = read.axes.iter().map(|(axis, values)| resonances::of_axis(axis, values, read.rate_hz));
    let axes = axes.collect::<Option<Vec<_>>>().ok_or_else(too_short)?;
    write_json(arguments.json.as_ref(), &json::of(&read.source, read.rate_hz, &axes))?;
    print(&text::of(&axes, "resonance"))
}
