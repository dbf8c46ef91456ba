//! The declared machine.

use files::log::{Log, Unit};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::axis::Axis;
use super::instruments::InstrumentKeys;
use super::rotary;
use crate::axis::KeyNames;
use crate::bodies::Structure;

/// A declared machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Name of the machine, for reports.
    pub name: String,
    /// Rate of the position loop and of the log.
    pub sample_rate_hz: f64,
    /// Rate of the velocity loop, a whole multiple of the sample rate; absent: the same. See
    /// [`Machine::velocity_rate_hz`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_loop_rate_hz: Option<f64>,
    /// Sensors and drive; absent: typical values of a machine in good condition.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instruments: Option<InstrumentKeys>,
    /// The axes by name, in the order of the file.
    pub axis: IndexMap<String, Axis>,
    /// The machine as rigid bodies. The simulation then uses it instead of the masses and springs of the axes. The tracer
    /// uses the axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure: Option<Structure>,
}

impl Machine {
    /// The text of a machine file that is read as this machine.
    #[must_use]
    #[expect(clippy::missing_panics_doc, reason = "it cannot happen: see the message")]
    pub fn to_toml(&self) -> String {
        let text = toml::to_string(self).expect("texts, numbers and tables under text keys fit into TOML");
        let is_rotary = |(_, axis): &(&String, &Axis)| axis.settings.names == KeyNames::Rotary;
        let rotary: Vec<&String> = self.axis.iter().filter(is_rotary).map(|(name, _)| name).collect();
        rotary::to_rotary(text, &rotary)
    }

    /// This machine with the names of rotary axes on the axes that logs have in degrees, unless one of their keys is that of a linear axis.
    #[must_use]
    pub fn named_as_logs<'a>(mut self, logs: impl IntoIterator<Item = &'a Log>) -> Self {
        let of_logs = logs.into_iter().flat_map(|log| &log.axes);
        for in_degrees in of_logs.filter(|axis| axis.unit == Unit::Degree) {
            if let Some(axis) = self.axis.get_mut(&in_degrees.name)
                && rotary::is_neutral(&axis.settings)
            {
                axis.settings.names = KeyNames::Rotary;
            }
        }
        self
    }

    /// Rate of the velocity loop.
    #[must_use]
    pub fn velocity_rate_hz(&self) -> f64 {
        self.velocity_loop_rate_hz.unwrap_or(self.sample_rate_hz)
    }

    /// Rates of both loops.
    #[must_use]
    pub fn rates(&self) -> Rates {
        let velocity_loop_hz = self.velocity_rate_hz();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a validated whole multiple"
        )]
        let position_loop_divider = (velocity_loop_hz / self.sample_rate_hz).round() as u32;
        Rates { velocity_loop_hz, position_loop_divider }
    }

    /// Names of all axes except one.
    #[must_use]
    pub fn others(&self, name: &str) -> Vec<String> {
        self.axis.keys().filter(|other| *other != name).cloned().collect()
    }
}
