//! The machine file: what is declared of a machine, effects found included.

mod check;
pub mod instruments;
pub mod nominal;

use std::path::Path;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::bodies::Structure;
use crate::effects::Effect;
use crate::friction_curve::Curve;
use files::document::{Document, read_text};
use files::error::InputError;
use instruments::InstrumentKeys;
use nominal::{LogOffsets, Nominal};

/// A machine as declared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// For people.
    pub name: String,
    /// Rate of the position loop and of the log.
    pub sample_rate_hz: f64,
    /// A whole multiple of the sample rate; absent: the same. See [`Machine::velocity_rate_hz`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_loop_rate_hz: Option<f64>,
    /// What reads the machine; absent: as on a well-kept one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instruments: Option<InstrumentKeys>,
    /// The axes by name, in the order of the file.
    pub axis: IndexMap<String, Axis>,
    /// The machine as rigid bodies, for a simulation instead of masses, springs and friction of its axes; the tracer
    /// goes by the axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure: Option<Structure>,
}

/// Law of the position controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Controller {
    /// Proportional.
    P,
    /// High-precision contour: a second-order filter before the gain.
    Hpc,
}

/// Which position the controller is fed back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Feedback {
    /// Motor reading.
    #[default]
    Motor,
    /// Table scale.
    Table,
    /// Motor reading + low-pass(table − motor).
    Dual,
}

/// One axis as declared. What is absent is not known, or not there.
///
/// Without the controller's keys the motor stage is not modelled, without masses the force stage
/// is not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Law of the position controller.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub controller: Option<Controller>,
    /// Kp.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_gain_per_s: Option<f64>,
    /// Kf; absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feedforward_percent: Option<f64>,
    /// Kv.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_gain_n_s_per_m: Option<f64>,
    /// Ti; absent: no integral part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_integral_time_s: Option<f64>,
    /// Largest force of the drive; absent: not limited.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_limit_n: Option<f64>,
    /// Window of the mean behind the path; absent: the command is the path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing_s: Option<f64>,
    /// Second, shorter window: it makes an S-curve of the ramp.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing_jerk_s: Option<f64>,
    /// Of an exponential lag behind the path, instead of the two before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing_time_constant_s: Option<f64>,
    /// Middle of a notch on the force; absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub notch_frequency_hz: Option<f64>,
    /// From −3 dB to −3 dB of a full notch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub notch_width_hz: Option<f64>,
    /// Share that the notch takes out of its middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub notch_depth: Option<f64>,
    /// Of a second-order low-pass on the force; absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low_pass_frequency_hz: Option<f64>,
    /// ζ of that low-pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low_pass_damping_ratio: Option<f64>,
    /// Least and greatest command: beyond them the path stops; absent: not watched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub travel_mm: Option<[f64; 2]>,
    /// Between command and reading before the drives go off; absent: 130 mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub following_error_limit_mm: Option<f64>,
    /// Of a stop along the path; absent: 2 m/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_deceleration_m_per_s2: Option<f64>,
    /// How long the force may stand at its limit before the path stops; absent: 1 s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saturation_time_s: Option<f64>,
    /// Between motor and table before the drives go off; absent: not watched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale_disagreement_limit_mm: Option<f64>,
    /// Fastest that the motor can be: a reading that has moved further puts the drives off; absent: not watched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fastest_mm_per_s: Option<f64>,
    /// How far the command may move while the motor reading stands before the drives go off; absent: not watched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frozen_encoder_limit_mm: Option<f64>,
    /// Motor and screw, reflected to the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motor_mass_kg: Option<f64>,
    /// Table and what stands on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table_mass_kg: Option<f64>,
    /// Between motor and table; absent: rigid, one mass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness_n_per_um: Option<f64>,
    /// Between motor and table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_n_s_per_m: Option<f64>,
    /// Coulomb friction on the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coulomb_n: Option<f64>,
    /// Viscous friction on the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscous_n_s_per_m: Option<f64>,
    /// Friction on the motor, times tanh(v / 0.2 mm/s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motor_coulomb_n: Option<f64>,
    /// σ0 of the table's friction; absent: no displacement before sliding.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub presliding_stiffness_n_per_um: Option<f64>,
    /// σ1 of the table's friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub presliding_damping_n_s_per_m: Option<f64>,
    /// Friction on the table as a published curve instead of `coulomb_n`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_curve: Option<Curve>,
    /// How far the true mechanical values may lie from the declared ones; absent: not at all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plant_tolerance_percent: Option<f64>,
    /// Travel in one turn of the screw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lead_mm: Option<f64>,
    /// Electrical periods in one turn of the resolver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resolver_pole_pairs: Option<u32>,
    /// Which position the controller is fed back.
    #[serde(default)]
    pub feedback: Feedback,
    /// Time constant of the low-pass of dual feedback.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dual_feedback_time_constant_s: Option<f64>,
    /// Values and effects as they were before a trace fitted them; absent: as they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nominal: Option<Nominal>,
    /// Zeros and instants of the logs that a trace fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log_offsets: Option<LogOffsets>,
    /// Effects found, in the order in which they were added.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effect: Vec<Effect>,
}

impl Axis {
    /// Whether the position and velocity loops are declared.
    #[must_use]
    pub fn has_controller(&self) -> bool {
        self.controller.is_some()
            && self.position_gain_per_s.is_some()
            && self.velocity_gain_n_s_per_m.is_some()
    }

    /// Whether there is a mass for a force to move.
    #[must_use]
    pub fn has_mass(&self) -> bool {
        self.motor_mass_kg.unwrap_or(0.0) + self.table_mass_kg.unwrap_or(0.0) > 0.0
    }

    /// Whether motor and table are one mass.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        self.stiffness_n_per_um.is_none()
    }
}

impl Machine {
    /// Reads a machine file.
    ///
    /// # Errors
    /// If it cannot be read, or does not describe a machine that can exist.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::parse(&read_text(path)?, &path.display().to_string())
    }

    /// Reads the text of a machine file; `source` is for messages.
    ///
    /// # Errors
    /// If the text does not describe a machine that can exist.
    pub fn parse(text: &str, source: &str) -> Result<Self, InputError> {
        let document = Document::parse(text, source)?;
        check::effects(&document)?;
        let mut machine: Self = document.deserialize()?;
        let order = document.children("axis");
        let place = |name: &String| order.iter().position(|key| key[5..] == name[..]);
        machine.axis.sort_by_cached_key(|name, _| place(name));
        check::machine(&machine, &document)?;
        Ok(machine)
    }

    /// The text of a machine file that reads as this machine.
    #[must_use]
    #[expect(clippy::missing_panics_doc, reason = "it cannot happen: see the message")]
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("texts, numbers and tables under text keys fit into TOML")
    }

    /// Rate of the velocity loop.
    #[must_use]
    pub fn velocity_rate_hz(&self) -> f64 {
        self.velocity_loop_rate_hz.unwrap_or(self.sample_rate_hz)
    }

    /// Names of all axes but one.
    #[must_use]
    pub fn others(&self, name: &str) -> Vec<String> {
        self.axis.keys().filter(|other| *other != name).cloned().collect()
    }
}

#[cfg(test)]
mod tests;
