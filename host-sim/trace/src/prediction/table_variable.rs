//! The measured variables of the tables and laws of residuals.

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
    let velocity = |axis: &AxisSignals, of: fn(f64) -> f64| {
        axis.table_or_motor().map(|smooth| smooth.velocity.iter().map(|&v| of(v)).collect())
    };
    let acceleration =
        |axis: &AxisSignals| axis.table_or_motor().map(|smooth| smooth.rate_of_velocity(signals.sample_s));
    let same = |value: f64| value;
    match variable {
        TableVariable::PositionMm => millimetres(own),
        TableVariable::VelocityMPerS => velocity(own, same),
        TableVariable::SpeedMPerS => velocity(own, f64::abs),
        TableVariable::Direction => velocity(own, TableVariable::direction),
        TableVariable::AccelerationMPerS2 => acceleration(own),
        TableVariable::ForceN => own.force.as_ref().map(|force| force.value.clone()),
        TableVariable::TimeS => {
            let time_s = |sample: usize| signals.start_s + sample as f64 * signals.sample_s;
            Some((0..signals.len()).map(time_s).collect())
        }
        TableVariable::OtherPositionMm => millimetres(other()?),
        TableVariable::OtherVelocityMPerS => velocity(other()?, same),
        TableVariable::OtherDirection => velocity(other()?, TableVariable::direction),
        TableVariable::OtherAccelerationMPerS2 => acceleration(other()?),
    }
}
