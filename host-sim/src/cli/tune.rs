//! `lost-motion tune`: settings of the loops from the identified plant.

use std::path::{Path, PathBuf};

use anyhow::{Error, Result};

use super::compensate::{input_or_failure, test_motions};
use super::margins::LimitArguments;
use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use commissioning::tuning::{Tuning, TuningError};
use files::error::InputError;
use files::output::write_whole;
use model::machine::Machine;
use plant::instruments::Instruments;

/// Arguments of `tune`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Machine file, with the effects found.
    #[arg(long)]
    machine: PathBuf,
    /// Motion whose contour error decides; may be given several times; default: a circle and corners.
    #[arg(long)]
    motion: Vec<PathBuf>,
    /// Write the machine file with the proposed settings.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Write the settings that were tried as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    #[command(flatten)]
    limits: LimitArguments,
}

/// Runs the command.
///
/// # Errors
/// Invalid input, a machine that cannot be simulated, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs: Vec<&Path> =
        [&arguments.machine].into_iter().chain(&arguments.motion).map(PathBuf::as_path).collect();
    check_outputs(
        &inputs,
        &[Output::File("--out", arguments.out.as_ref()), Output::File("--json", arguments.json.as_ref())],
    )?;
    let limits = arguments.limits.checked()?;
    let machine = Machine::read(&arguments.machine)?;
    let tests = test_motions(&arguments.motion, &machine, 0.0)?;
    let instruments = Instruments::of(&machine, 1);
    let progress = Progress::start();
    progress.show("simulating the motions with each position loop");
    let tuning = Tuning { machine: &machine, instruments, limits, tests: &tests };
    let file = arguments.machine.display().to_string();
    let proposal = tuning.propose().map_err(|error| match error {
        TuningError::Simulation(error) => input_or_failure(error, &machine, &file),
        error => Error::from(InputError::new(&file, error.to_string())),
    })?;
    drop(progress);
    if let (Some(path), Some(best)) = (&arguments.out, proposal.best()) {
        write_whole(path, |out| out.write_all(best.machine.to_toml().as_bytes()))?;
    }
    write_json(arguments.json.as_ref(), &proposal.json())?;
    print(&proposal.text())
}
