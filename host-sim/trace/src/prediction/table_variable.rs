//! The measured variables of the tables of residuals.

use crate::input::signals::{AxisSignals, Signals};
use crate::input::smoothing::Smooth;
use model::residual_table::TableVariable;

/// Values of a variable of an axis over one log, in the unit of its tables, if it was measured.
#[must_use]
pub fn values(signals: &Signals, axis: usize, variable: TableVariable) -> Option<Vec<f64>> {
    let own = &signals.axes[axis];
    let other = || signals.axes.iter().enumerate().find(|(i, _)| *i != axis).map(|(_, axis)| axis);
    let millimetres = |axis: &AxisSignals| {
        axis.table_or_motor().map(|smooth: &Smooth| smooth.value.iter().map(|m| 1e3 * m).collect())
    };
    let direction = |smooth: &Smooth| smooth.velocity.iter().map(|&v| TableVariable::direction(v)).collect();
    match variable {
        TableVariable::PositionMm => millimetres(own),
        TableVariable::VelocityMPerS => own.table_or_motor().map(|smooth| smooth.velocity.clone()),
        TableVariable::AccelerationMPerS2 => own.table_or_motor().map(|smooth| smooth.acceleration.clone()),
        TableVariable::Direction => own.table_or_motor().map(direction),
        TableVariable::ForceN => own.force.as_ref().map(|force| force.value.clone()),
        TableVariable::OtherPositionMm => millimetres(other()?),
        TableVariable::OtherAccelerationMPerS2 => {
            other()?.table_or_motor().map(|smooth| smooth.acceleration.clone())
        }
    }
}
