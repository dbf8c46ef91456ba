//! `--compensation` of the commands that run a motion.

use std::path::Path;

use anyhow::Result;

use commissioning::compensate::{CompensationFile, mapped};
use commissioning::margins::MarginLimits;
use commissioning::margins::change;
use contour::NominalPath;
use files::error::InputError;
use model::machine::Machine;
use plant::controller::Controller;
use plant::machine_path::MachinePath;

/// A compensation file and the machine with the drive settings that it changes.
pub struct Compensated {
    /// The machine as the file changes it.
    pub machine: Machine,
    file: Option<(CompensationFile, String)>,
}

impl Compensated {
    /// Reads the file of `--compensation`, if one is given, for a machine.
    ///
    /// # Errors
    /// If the file cannot be used for this machine.
    pub fn read(path: Option<&Path>, machine: Machine) -> Result<Self, InputError> {
        let Some(path) = path else { return Ok(Self { machine, file: None }) };
        let file = CompensationFile::read(path, &machine)?;
        let source = path.display().to_string();
        check_margins(&file, &source, &machine, MarginLimits::default())?;
        Ok(Self { machine: file.applied_to(&machine), file: Some((file, source)) })
    }

    /// A sentence for each axis on which a motion leaves the travel that the compensation is made for, as a paragraph.
    pub fn remarks(&self, path: &MachinePath) -> String {
        let Some((file, _)) = &self.file else { return String::new() };
        let path = NominalPath::of_blocks(&path.start_m, &path.blocks);
        let beyond = mapped::beyond_on_path(file, &self.machine, &path);
        beyond.iter().map(|beyond| format!("\n\n{}", beyond.sentence())).collect()
    }

    /// Sets the compensations of a controller whose drives are off.
    ///
    /// # Errors
    /// The setting that the controller refuses.
    pub fn set(&self, controller: &mut dyn Controller) -> Result<(), InputError> {
        let Some((file, source)) = &self.file else { return Ok(()) };
        file.set(&self.machine, controller)
            .map_err(|refused| InputError::new(source, refused.problem()).at_key(&refused.key()))
    }
}

/// Checks that a compensation file leaves the loops of a machine these margins, as [`change::check`].
///
/// # Errors
/// The axis whose drive settings take a loop below the limits.
pub fn check_margins(
    file: &CompensationFile,
    source: &str,
    machine: &Machine,
    limits: MarginLimits,
) -> Result<(), InputError> {
    change::check(machine, &file.applied_to(machine), limits, source)
}
