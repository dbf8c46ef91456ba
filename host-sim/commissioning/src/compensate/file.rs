//! The compensation file.

#[cfg(test)]
mod tests;

use std::path::Path;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use shared::compensate::{AxisOf, CompensationSettings};
use shared::config::ConfigError;
use shared::machine::MachineError;
use shared::scalar::Fixed;

use crate::compensate::servo::ControllerChange;
use contour::verification::Prediction;
use files::document::{Document, read_text};
use files::error::InputError;
use model::machine::Machine;
use plant::controller::{Controller, ControllerError};

/// A compensation file: for each axis the settings of the controller's compensations, in SI, and changes of its gains.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CompensationFile {
    /// Name of the machine to which it belongs.
    pub machine: String,
    /// Where it comes from.
    #[serde(default)]
    pub provenance: Provenance,
    /// The axes.
    #[serde(default)]
    pub axis: IndexMap<String, AxisCompensation>,
    /// What the contour error of motions will be.
    #[serde(default)]
    pub predicted: Vec<Prediction>,
}

/// Where a compensation comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The model.
    pub model: String,
    /// The program and its version.
    pub program: String,
    /// The effects that are compensated, `axis: effect`.
    #[serde(default)]
    pub compensates: Vec<String>,
}

/// The compensation of one axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisCompensation {
    /// Least and greatest position, mm, between which the tables over the position are known; absent: there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mapped_mm: Option<[f64; 2]>,
    /// Settings of the drive.
    #[serde(default, skip_serializing_if = "ControllerChange::is_empty")]
    pub controller: ControllerChange,
    /// Settings of the compensations.
    #[serde(default)]
    pub compensation: CompensationSettings,
}

impl AxisCompensation {
    /// Checks the values of an axis of a machine.
    fn check(&self, document: &Document<'_>, name: &str, machine: &Machine) -> Result<(), InputError> {
        if let Some((key, expected)) = self.controller.refused(1.0 / machine.rates().position_loop_hz()) {
            return Err(document.refuse(&format!("axis.{name}.controller.{key}"), &expected));
        }
        let is_travel = |[from, to]: [f64; 2]| from.is_finite() && to.is_finite() && from < to;
        if self.mapped_mm.is_some_and(|mm| !is_travel(mm)) {
            let expected = "two positions, the second above the first";
            return Err(document.refuse(&format!("axis.{name}.mapped_mm"), expected));
        }
        match self.refused(name, machine) {
            Some(error) => {
                let key = format!("axis.{name}.compensation.{}", error.name());
                Err(document.refuse(&key, &error.expectation().to_string()))
            }
            None => Ok(()),
        }
    }

    /// The setting of a compensation that the controller of a machine refuses in fixed point.
    fn refused(&self, name: &str, machine: &Machine) -> Option<ConfigError> {
        let axis = machine.axis.get_index_of(name)?;
        let place = AxisOf { axis, axes: machine.axis.len() };
        shared::compensate::AxisCompensation::<Fixed>::new(&self.compensation, machine.rates(), place).err()
    }
}

impl CompensationFile {
    /// The file of a machine that compensates nothing.
    #[must_use]
    pub fn none(machine: &Machine) -> Self {
        Self { machine: machine.name.clone(), ..Self::default() }
    }

    /// Reads a compensation file for a machine.
    ///
    /// # Errors
    /// If it cannot be read, has an unknown key or a value that is not possible, or belongs to another machine. What the
    /// controller is set to has to be possible in fixed point.
    pub fn read(path: &Path, machine: &Machine) -> Result<Self, InputError> {
        Self::parse(&read_text(path)?, &path.display().to_string(), machine)
    }

    /// The text of a compensation file for a machine; `source` is its name.
    ///
    /// # Errors
    /// As [`CompensationFile::read`].
    pub fn parse(text: &str, source: &str, machine: &Machine) -> Result<Self, InputError> {
        let document = Document::parse(text, source)?;
        let file: Self = document.deserialize()?;
        file.check_place(&document, machine)?;
        for (name, axis) in &file.axis {
            axis.check(&document, name, machine)?;
        }
        for (index, prediction) in file.predicted.iter().enumerate() {
            if let Some((key, expected)) = prediction.refused() {
                return Err(document.refuse(&format!("predicted[{index}].{key}"), expected));
            }
        }
        Ok(file)
    }

    /// Checks that the file belongs to a machine.
    fn check_place(&self, document: &Document<'_>, machine: &Machine) -> Result<(), InputError> {
        if self.machine != machine.name {
            return Err(document.refuse("machine", &format!("a compensation of machine {}", machine.name)));
        }
        if let Some(name) = self.axis.keys().find(|name| !machine.axis.contains_key(*name)) {
            let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
            let problem = format!("unknown axis, expected an axis of the machine ({})", names.join(", "));
            return Err(document.error_at(&format!("axis.{name}"), &problem));
        }
        Ok(())
    }

    /// The file as text.
    ///
    /// # Errors
    /// Never for values that were parsed or planned.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }

    /// The machine with the changed gains of its drives.
    #[must_use]
    pub fn applied_to(&self, machine: &Machine) -> Machine {
        let mut machine = machine.clone();
        for (name, axis) in &self.axis {
            if let Some(declared) = machine.axis.get_mut(name) {
                axis.controller.apply(&mut declared.settings);
            }
        }
        machine
    }

    /// The first setting of a compensation that the controller of the machine refuses in fixed point.
    #[must_use]
    pub fn refused(&self, machine: &Machine) -> Option<Refused> {
        self.axis.iter().find_map(|(name, axis)| {
            let error = axis.refused(name, machine)?;
            let axis = machine.axis.get_index_of(name)?;
            let error = ControllerError::Refused(MachineError::Config { axis, error });
            Some(Refused { axis: name.clone(), error })
        })
    }

    /// Sets the compensations of a controller of the machine.
    ///
    /// # Errors
    /// The axis and the setting that the controller refuses.
    pub fn set(&self, machine: &Machine, controller: &mut dyn Controller) -> Result<(), Refused> {
        for (index, name) in machine.axis.keys().enumerate() {
            if let Some(axis) = self.axis.get(name) {
                controller
                    .compensate(index, &axis.compensation)
                    .map_err(|error| Refused { axis: name.clone(), error })?;
            }
        }
        Ok(())
    }
}

/// A compensation that the controller refuses.
#[derive(Debug, thiserror::Error)]
#[error("{}: {}", self.key(), self.problem())]
pub struct Refused {
    /// Name of the axis.
    pub axis: String,
    /// Why.
    pub error: ControllerError,
}

impl Refused {
    /// The setting in a compensation file.
    #[must_use]
    pub fn key(&self) -> String {
        format!("axis.{}.compensation{}", self.axis, if self.setting().is_empty() { "" } else { "." })
            + self.setting()
    }

    /// The setting within the compensation of the axis; empty if the controller does not name it.
    #[must_use]
    pub fn setting(&self) -> &'static str {
        self.config().map_or("", ConfigError::name)
    }

    /// What was expected.
    #[must_use]
    pub fn problem(&self) -> String {
        self.config()
            .map_or_else(|| self.error.to_string(), |error| format!("expected {}", error.expectation()))
    }

    const fn config(&self) -> Option<&ConfigError> {
        match &self.error {
            ControllerError::Refused(MachineError::Config { error, .. }) => Some(error),
            _ => None,
        }
    }
}
