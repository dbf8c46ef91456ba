//! Kp and Kf of a position loop that commands the velocity of a drive, from command and motor alone.
//!
//! A drive of the time constant τ moves with v + τ·a = Kp·e + Kf·command'.

use crate::regression::{Regression, Solution, inner};
use trace::input::signals::AxisSignals;

/// Settings of such a loop.
#[derive(Clone, Copy, Debug)]
pub struct VelocityLoop {
    /// Kp, 1/s.
    pub position_gain_per_s: f64,
    /// Kf, percent.
    pub feedforward_percent: f64,
}

/// The settings; `None` without logs of command and motor that show a following error.
#[must_use]
pub fn settings(logs: &[&AxisSignals], sample_s: f64) -> Option<VelocityLoop> {
    let mut regression = Regression::<3>::default();
    for log in logs {
        let (Some(command), Some(motor)) = (&log.command, &log.motor) else { continue };
        let last = command.len().saturating_sub(1);
        let command_velocity = |i: usize| (command[(i + 1).min(last)] - command[i - 1]) / (2.0 * sample_s);
        let rows = inner(command.len());
        regression.add_log(rows.map(|i| {
            let columns = [command[i] - motor.value[i], command_velocity(i), motor.acceleration[i]];
            (columns, motor.velocity[i])
        }));
    }
    let Solution { values: [position_gain_per_s, feed, _], .. } = regression.solve()?;
    (position_gain_per_s > 0.0).then_some(VelocityLoop {
        position_gain_per_s,
        feedforward_percent: (100.0 * feed).clamp(0.0, 200.0),
    })
}
