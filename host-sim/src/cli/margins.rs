//! `lost-motion margins`: gain and phase margins of the loops of a machine file.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::outputs::{Output, check_outputs, print, write_json};
use commissioning::compensate::CompensationFile;
use commissioning::margins::{MarginLimits, axis_margins, json, text};
use files::error::InputError;
use model::machine::Machine;
use plant::instruments::Instruments;

/// Arguments of `margins`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Machine file, with the effects found.
    #[arg(long)]
    machine: PathBuf,
    /// Compensation file, whose drive settings replace those of the machine.
    #[arg(long)]
    compensation: Option<PathBuf>,
    /// Write the margins as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    #[command(flatten)]
    limits: LimitArguments,
}

/// The margins that are asked for.
#[derive(clap::Args)]
pub struct LimitArguments {
    /// Smallest gain margin of a loop, dB.
    #[arg(long, value_name = "DB", default_value_t = MarginLimits::default().gain_db)]
    min_gain_margin_db: f64,
    /// Smallest phase margin of a loop, degrees.
    #[arg(long, value_name = "DEG", default_value_t = MarginLimits::default().phase_deg)]
    min_phase_margin_deg: f64,
}

impl LimitArguments {
    /// The limits.
    ///
    /// # Errors
    /// A number that is not a margin.
    pub fn checked(&self) -> Result<MarginLimits, InputError> {
        let ranged = |flag, value: f64, highest: f64, unit| {
            let is_valid = (0.0..=highest).contains(&value);
            is_valid.then_some(value).ok_or_else(|| {
                InputError::expected(flag, format!("a margin of 0 to {highest} {unit}"), value)
            })
        };
        Ok(MarginLimits {
            gain_db: ranged("--min-gain-margin-db", self.min_gain_margin_db, 60.0, "dB")?,
            phase_deg: ranged("--min-phase-margin-deg", self.min_phase_margin_deg, 90.0, "degrees")?,
        })
    }
}

/// Runs the command.
///
/// # Errors
/// Invalid input, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs: Vec<&Path> =
        [&arguments.machine].into_iter().chain(&arguments.compensation).map(PathBuf::as_path).collect();
    check_outputs(&inputs, &[Output::File("--json", arguments.json.as_ref())])?;
    let limits = arguments.limits.checked()?;
    let mut machine = Machine::read(&arguments.machine)?;
    if let Some(path) = &arguments.compensation {
        machine = CompensationFile::read(path, &machine)?.applied_to(&machine);
    }
    let axes = axis_margins::of_machine(&machine, &Instruments::of(&machine, 0), limits)
        .map_err(|error| InputError::new(&arguments.machine.display().to_string(), error.to_string()))?;
    write_json(arguments.json.as_ref(), &json::of(&axes, limits))?;
    print(&text::of(&axes, limits))
}
