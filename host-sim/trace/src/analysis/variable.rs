//! Physical variables that a residual may depend on.

use serde::Serialize;

use crate::fit::fit_data::FitData;
use crate::input::smoothing::Smooth;

/// A physical variable that a residual may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Variable {
    /// Time: a vibration at a constant frequency.
    Time,
    /// Position of the axis.
    Position,
    /// Velocity of the axis.
    Velocity,
    /// Acceleration of the axis.
    Acceleration,
    /// Sign of the velocity.
    Direction,
    /// Drive force.
    Force,
    /// Position of the other axis.
    OtherPosition,
    /// Acceleration of the other axis.
    OtherAcceleration,
    /// None of these.
    None,
}

/// Values of a variable over one log, if it was measured: mm, m/s, m/s², N, or −1 to 1 for the direction.
#[must_use]
pub fn values(data: &FitData<'_>, log: usize, variable: Variable) -> Option<Vec<f64>> {
    let axes = &data.logs[log].axes;
    let own = &axes[data.axis];
    let other = axes.iter().enumerate().find(|(i, _)| *i != data.axis).map(|(_, axis)| axis);
    let millimetres = |smooth: &Smooth| smooth.position.iter().map(|m| 1e3 * m).collect();
    let min_m_per_s = data.options.analysis.min_direction_m_per_s;
    let sign = |v: &f64| if v.abs() < min_m_per_s { 0.0 } else { v.signum() };
    match variable {
        Variable::Position => own.table_or_motor().map(millimetres),
        Variable::Velocity => own.table_or_motor().map(|smooth| smooth.velocity.clone()),
        Variable::Acceleration => own.table_or_motor().map(|smooth| smooth.acceleration.clone()),
        Variable::Direction => own.table_or_motor().map(|smooth| smooth.velocity.iter().map(sign).collect()),
        Variable::Force => own.force.as_ref().map(|force| force.position.clone()),
        Variable::OtherPosition => other?.table_or_motor().map(millimetres),
        Variable::OtherAcceleration => other?.table_or_motor().map(|smooth| smooth.acceleration.clone()),
        Variable::Time | Variable::None => None,
    }
}
