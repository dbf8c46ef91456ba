//! Physical variables that a residual may depend on.

use schemars::JsonSchema;
use serde::Serialize;

use crate::fit::fit_data::FitData;
use crate::prediction::table_variable;
use model::residual_table::TableVariable;

/// A physical variable that a residual may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
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

impl Variable {
    /// The variable of a table of residuals; `None` for a time, or for none.
    #[must_use]
    pub const fn of_table(self) -> Option<TableVariable> {
        Some(match self {
            Self::Position => TableVariable::PositionMm,
            Self::Velocity => TableVariable::VelocityMPerS,
            Self::Acceleration => TableVariable::AccelerationMPerS2,
            Self::Direction => TableVariable::Direction,
            Self::Force => TableVariable::ForceN,
            Self::OtherPosition => TableVariable::OtherPositionMm,
            Self::OtherAcceleration => TableVariable::OtherAccelerationMPerS2,
            Self::Time | Self::None => return None,
        })
    }
}

/// Values of a variable over one log, if it was measured: mm, m/s, m/s², N, or −1 to 1 for the direction.
#[must_use]
pub fn values(data: &FitData<'_>, log: usize, variable: Variable) -> Option<Vec<f64>> {
    table_variable::values(&data.logs[log], data.axis, variable.of_table()?)
}
