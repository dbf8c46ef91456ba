//! `lost-motion simulate`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::compensation::Compensated;
use super::input_error::Inputs;
use super::logged_run;
use super::outputs::{Output, check_outputs, print};
use model::machine::Machine;
use motion::Motion;
use plant::equivalent;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{self, Run};
use shared::scalar::Format;

/// The number format of a controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum FormatArgument {
    /// Fixed point, as on the chip.
    #[default]
    Fixed,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

impl From<FormatArgument> for Format {
    fn from(argument: FormatArgument) -> Self {
        match argument {
            FormatArgument::Fixed => Self::Fixed,
            FormatArgument::F32 => Self::F32,
            FormatArgument::F64 => Self::F64,
        }
    }
}

/// Arguments of `simulate`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Machine file with the effects.
    #[arg(long)]
    machine: PathBuf,
    /// Motion file.
    #[arg(long)]
    motion: PathBuf,
    /// Log to write (CSV, or .csv.gz).
    #[arg(long)]
    out: PathBuf,
    /// Compensation file, as `compensate` writes it.
    #[arg(long)]
    compensation: Option<PathBuf>,
    /// Number format of the controller.
    #[arg(long, value_enum, default_value_t)]
    scalar: FormatArgument,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs the command.
///
/// # Errors
/// Invalid input, a fault of the loop, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let files = [&arguments.machine, &arguments.motion].into_iter().chain(&arguments.compensation);
    let files: Vec<&Path> = files.map(PathBuf::as_path).collect();
    check_outputs(&files, &[Output::File("--out", Some(&arguments.out))])?;
    let machine = Machine::read(&arguments.machine)?;
    let compensated = Compensated::read(arguments.compensation.as_deref(), machine)?;
    let (machine, assumed) = equivalent::of(&compensated.machine);
    let machine = machine.as_ref();
    let motion = Motion::read(&arguments.motion)?;
    let machine_file = &arguments.machine.display().to_string();
    let motion_file = &arguments.motion.display().to_string();
    let inputs = Inputs { machine, machine_file, motion_file };
    let path = MachinePath::new(&motion, machine, motion_file)?;
    let controller = simulate::controller(machine, arguments.scalar.into(), &path.start_m);
    let mut controller = controller.map_err(|error| inputs.error(error))?;
    compensated.set(controller.as_mut())?;
    let run = Run {
        machine,
        instruments: Instruments::of(machine, arguments.seed),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s: 0.0,
    };
    let statistics = logged_run::run(&run, controller.as_mut(), &arguments.out, &inputs, |_| {})?;
    let assumed: String = assumed.iter().map(|assumed| format!("\n\n{}", assumed.sentence())).collect();
    print(&format!(
        "{} ran {}: {} samples in {}.\n\n{}{}{assumed}",
        machine.name,
        motion.name,
        statistics.samples,
        arguments.out.display(),
        statistics.summary(),
        compensated.remarks(&path)
    ))
}
