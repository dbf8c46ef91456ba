//! An undeclared effect of a machine, and the names of all that are drawn.

use serde_json::{Map, Value, json};

use super::machine::AXES;

/// The effects that are drawn, with equal probability.
pub const NAMES: [&str; 17] = [
    "backlash",
    "pitch_progressive",
    "pitch_cyclic",
    "resolver_dividing",
    "windup",
    "stribeck",
    "friction_asymmetry",
    "torque_ripple",
    "constant_load",
    "servo_mismatch",
    "intalk",
    "crosstalk",
    "squareness",
    "straightness",
    "thermal_drift",
    "latency",
    "resonance",
];

/// Differences between the true and the declared controller, which the kind `controller` has.
pub const CONTROLLER: [&str; 4] =
    ["feedforward_mismatch", "velocity_gain_mismatch", "integral_time_mismatch", "drive_lag"];

/// Effects from outside the catalogue; the tracer should report them as unexplained.
pub const OUTSIDE: [&str; 2] = ["vibration", "local_defect"];

/// A true effect of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Name, as in the results of a trace.
    pub name: &'static str,
    /// Name of its axis.
    pub axis: &'static str,
    /// In the units of a machine file, without phases.
    pub parameters: Vec<(&'static str, f64)>,
    /// `source`, `channel` or `log`, where the effect has one.
    pub reference: Option<(&'static str, &'static str)>,
    /// Phase of a periodic effect; not part of the results.
    pub phase_rad: f64,
}

impl Truth {
    /// Whether it is from outside the catalogue.
    #[must_use]
    pub fn is_outside(&self) -> bool {
        OUTSIDE.contains(&self.name)
    }

    /// A parameter's value.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<f64> {
        self.parameters.iter().find(|(key, _)| *key == name).map(|&(_, value)| value)
    }

    /// Its entry in `truth.json`.
    #[must_use]
    pub fn json(&self) -> Value {
        let mut entry = Map::new();
        entry.insert("name".to_owned(), json!(self.name));
        entry.insert("axis".to_owned(), json!(self.axis));
        if let Some((key, reference)) = self.reference {
            entry.insert(key.to_owned(), json!(reference));
        }
        entry.extend(self.parameters.iter().map(|&(key, value)| (key.to_owned(), json!(value))));
        Value::Object(entry)
    }
}

/// Position of an axis in [`AXES`].
pub(super) fn axis_index(name: &str) -> usize {
    AXES.iter().position(|axis| *axis == name).unwrap_or(0)
}
