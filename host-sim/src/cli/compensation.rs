//! `--compensation` of the commands that run a motion.

use std::path::Path;

use anyhow::Result;

use compensate::CompensationFile;
use files::error::InputError;
use link::controller::Controller;
use model::machine::Machine;

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
        Ok(Self { machine: file.applied_to(&machine), file: Some((file, path.display().to_string())) })
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
