//! Changes of the settings of a drive.

use serde::{Deserialize, Serialize};

use model::axis::Settings;
use model::servo::ServoParameters;

/// Settings of a drive that replace those of the machine file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ControllerChange {
    /// Kp, 1/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_gain_per_s: Option<f64>,
    /// Kf, %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feedforward_percent: Option<f64>,
    /// Time by which the velocity feed-forward is ahead of the command, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feedforward_ahead_s: Option<f64>,
    /// Kv, N·s/m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_gain_n_s_per_m: Option<f64>,
    /// Ti, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_integral_time_s: Option<f64>,
}

impl ControllerChange {
    /// The settings at which a drive whose gains deviate from its settings has those that the machine file declares.
    ///
    /// A drive whose true Kp is `factor` times its setting is set to Kp/`factor`.
    #[must_use]
    pub fn to_declared(settings: &Settings, servo: &ServoParameters) -> Self {
        let controller = &settings.controller;
        let scaled = |declared: Option<f64>, factor: f64| {
            declared.filter(|_| (factor - 1.0).abs() > f64::EPSILON).map(|d| d / factor)
        };
        let feedforward = servo.feedforward.percent;
        Self {
            position_gain_per_s: scaled(controller.position_gain_per_s, servo.mismatch.factor()),
            feedforward_percent: (feedforward != 0.0)
                .then(|| (controller.feedforward_percent.unwrap_or(0.0) - feedforward).max(0.0)),
            feedforward_ahead_s: None,
            velocity_gain_n_s_per_m: scaled(controller.velocity_gain_n_s_per_m, servo.velocity_gain.factor()),
            velocity_integral_time_s: scaled(
                controller.velocity_integral_time_s,
                servo.integral_time.factor(),
            ),
        }
    }

    /// Whether nothing is changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Changes the settings.
    pub fn apply(&self, settings: &mut Settings) {
        let controller = &mut settings.controller;
        let pairs = [
            (&mut controller.position_gain_per_s, self.position_gain_per_s),
            (&mut controller.feedforward_percent, self.feedforward_percent),
            (&mut controller.feedforward_ahead_s, self.feedforward_ahead_s),
            (&mut controller.velocity_gain_n_s_per_m, self.velocity_gain_n_s_per_m),
            (&mut controller.velocity_integral_time_s, self.velocity_integral_time_s),
        ];
        for (setting, changed) in pairs {
            *setting = changed.or(*setting);
        }
    }
}
