//! Changes of the settings of a drive.

use serde::{Deserialize, Serialize};

use model::axis::{Law, Settings};
use model::servo::ServoParameters;

/// Longest time of the feed-forward ahead of the command, position ticks: that of the controller.
pub(crate) const MOST_AHEAD_TICKS: f64 = 8.0;

/// Settings of a drive that replace those of the machine file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerChange {
    /// Control law of the position loop.
    #[serde(default, rename = "controller", skip_serializing_if = "Option::is_none")]
    pub law: Option<Law>,
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
            law: None,
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

    /// Adds a part of the velocity to the feed-forward, so that the axis leads by the time of that part over Kp.
    pub fn add_lead(&mut self, part: f64, settings: &Settings) {
        let percent = self.feedforward_percent.or(settings.controller.feedforward_percent).unwrap_or(0.0);
        self.feedforward_percent = Some((percent + 100.0 * part).clamp(0.0, 200.0));
    }

    /// The first key whose value no drive has, and what is expected of it; `position_tick_s` is the period of the position loop.
    #[must_use]
    pub fn refused(&self, position_tick_s: f64) -> Option<(&'static str, String)> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let within = |least: f64, greatest: f64| move |value: f64| (least..=greatest).contains(&value);
        let above_0 = || "a number above 0".to_owned();
        let longest_s = MOST_AHEAD_TICKS * position_tick_s;
        let refused =
            |value: Option<f64>, is_possible: &dyn Fn(f64) -> bool| value.is_some_and(|v| !is_possible(v));
        if refused(self.position_gain_per_s, &positive) {
            Some(("position_gain_per_s", above_0()))
        } else if refused(self.feedforward_percent, &within(0.0, 200.0)) {
            Some(("feedforward_percent", "a number from 0 to 200".to_owned()))
        } else if refused(self.feedforward_ahead_s, &within(0.0, longest_s)) {
            Some((
                "feedforward_ahead_s",
                format!("a time from 0 to {longest_s} s, 8 ticks of the position loop"),
            ))
        } else if refused(self.velocity_gain_n_s_per_m, &positive) {
            Some(("velocity_gain_n_s_per_m", above_0()))
        } else if refused(self.velocity_integral_time_s, &positive) {
            Some(("velocity_integral_time_s", above_0()))
        } else {
            None
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
        controller.law = self.law.or(controller.law);
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
