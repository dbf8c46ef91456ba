//! The compensation file.

use std::path::Path;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use shared::compensate::CompensationSettings;
use shared::compensate::settings::{CYCLES, POINTS};
use shared::config::ConfigError;
use shared::machine::MachineError;

use crate::servo::ControllerChange;
use contour::verification::Prediction;
use files::document::read_text;
use files::error::InputError;
use link::controller::{Controller, ControllerError};
use model::machine::Machine;

/// A compensation file: for each axis the settings of the controller's compensations, in SI, and changes of its gains.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
pub struct AxisCompensation {
    /// Settings of the drive.
    #[serde(default, skip_serializing_if = "ControllerChange::is_empty")]
    pub controller: ControllerChange,
    /// Settings of the compensations.
    #[serde(default)]
    pub compensation: CompensationSettings,
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
    /// If it cannot be read, has an unknown key or a value that is not possible, or belongs to another machine.
    pub fn read(path: &Path, machine: &Machine) -> Result<Self, InputError> {
        Self::parse(&read_text(path)?, &path.display().to_string(), machine)
    }

    /// The text of a compensation file for a machine; `source` is its name.
    ///
    /// # Errors
    /// As [`CompensationFile::read`].
    pub fn parse(text: &str, source: &str, machine: &Machine) -> Result<Self, InputError> {
        let at = |error: &toml::de::Error| {
            let line = error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
            let problem = match error.message() {
                message if message.starts_with("invalid length") => {
                    format!(
                        "expected tables of at most {POINTS} values and at most {CYCLES} periods: {message}"
                    )
                }
                message => message.to_owned(),
            };
            InputError::new(source, problem).at_line(line)
        };
        let deserializer = toml::Deserializer::parse(text).map_err(|error| at(&error))?;
        let mut unknown = None;
        let file: Self = serde_ignored::deserialize(deserializer, |path| {
            // A value that may be absent is a level of its own, "?".
            unknown.get_or_insert(path.to_string().replace(".?", ""));
        })
        .map_err(|error| at(&error))?;
        if let Some(key) = unknown {
            let problem =
                "expected a key of a compensation file (docs/compensation.md), found an unknown one";
            return Err(InputError::new(source, problem).at_key(&key));
        }
        if file.machine != machine.name {
            let expected = format!("a compensation of machine {}", machine.name);
            return Err(InputError::expected(source, expected, &file.machine).at_key("machine"));
        }
        if let Some(name) = file.axis.keys().find(|name| !machine.axis.contains_key(*name)) {
            let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
            let expected = format!("an axis of the machine ({})", names.join(", "));
            return Err(InputError::expected(source, expected, name).at_key(&format!("axis.{name}")));
        }
        let tick_s = 1.0 / machine.rates().position_loop_hz();
        for (name, axis) in &file.axis {
            if let Some((key, expected)) = axis.controller.refused(tick_s) {
                let key = format!("axis.{name}.controller.{key}");
                return Err(InputError::new(source, format!("expected {expected}")).at_key(&key));
            }
        }
        Ok(file)
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
        let table = format!("axis.{}.compensation", self.axis);
        match self.config().map(ToString::to_string) {
            Some(text) => text.split_once(": ").map_or(table.clone(), |(name, _)| format!("{table}.{name}")),
            None => table,
        }
    }

    /// What was expected.
    #[must_use]
    pub fn problem(&self) -> String {
        let text = self.config().map_or_else(|| self.error.to_string(), ConfigError::to_string);
        text.split_once(": ").map_or(text.clone(), |(_, problem)| problem.to_owned())
    }

    const fn config(&self) -> Option<&ConfigError> {
        match &self.error {
            ControllerError::Refused(MachineError::Config { error, .. }) => Some(error),
            _ => None,
        }
    }
}
