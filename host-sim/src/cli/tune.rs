//! `lost-motion tune`: settings of the loops from the identified plant.

use std::path::{Path, PathBuf};

use anyhow::{Error, Result};

use super::compensate::{input_or_failure, test_motions};
use super::margins::LimitArguments;
use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use commissioning::response::ResponseFile;
use commissioning::tuning::measured::MeasuredAxis;
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
    /// Frequency response of an axis that `board response` wrote, with the settings of the machine file: the proposed loops have the margins as
    /// measured, too. May be given once for each axis.
    #[arg(long, value_name = "RESPONSE")]
    measured: Vec<PathBuf>,
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
    let inputs: Vec<&Path> = [&arguments.machine]
        .into_iter()
        .chain(&arguments.motion)
        .chain(&arguments.measured)
        .map(PathBuf::as_path)
        .collect();
    check_outputs(
        &inputs,
        &[Output::File("--out", arguments.out.as_ref()), Output::File("--json", arguments.json.as_ref())],
    )?;
    let limits = arguments.limits.checked()?;
    let machine = Machine::read(&arguments.machine)?;
    let tests = test_motions(&arguments.motion, &machine, 0.0)?;
    let instruments = Instruments::of(&machine, 1);
    let measured = measured_axes(&arguments.measured, &machine, &instruments)?;
    let progress = Progress::start();
    progress.show("simulating the motions with each position loop");
    let tuning = Tuning { machine: &machine, instruments, limits, tests: &tests, measured: &measured };
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

/// The measured axes of the machine, each once.
fn measured_axes(
    paths: &[PathBuf],
    machine: &Machine,
    instruments: &Instruments,
) -> Result<Vec<MeasuredAxis>> {
    let mut axes: Vec<MeasuredAxis> = Vec::new();
    for path in paths {
        let source = path.display().to_string();
        let axis = MeasuredAxis::of(&ResponseFile::read(path)?, machine, instruments)
            .map_err(|error| InputError::new(&source, error.to_string()))?;
        if axes.iter().any(|other| other.index == axis.index) {
            let found = format!("a second one of {}", axis.axis);
            return Err(InputError::expected(&source, "one response of each axis", found).into());
        }
        axes.push(axis);
    }
    Ok(axes)
}
