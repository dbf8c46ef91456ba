//! A residual that no effect describes, as a table over a variable on which it depends.
//!
//! A table is not a physical model: it holds for motions like those in which it was measured.

use serde::{Deserialize, Serialize};

use crate::effects::Stage;

/// The channel whose residual a table describes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TableChannel {
    /// The whole axis is displaced relative to the motion that its controller knows.
    Motor,
    /// The table is displaced relative to the motor.
    #[default]
    Table,
    /// The tool is displaced relative to the table.
    Tool,
    /// The drive exerts more force than the motion of the motor requires.
    Force,
}

/// The variable of a table, with the unit of its values. For rotary axes, degrees replace mm, a metre corresponds to 1000°, and
/// N·m replaces N.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TableVariable {
    /// Position of the table, or of the motor without a scale.
    #[default]
    PositionMm,
    /// Its velocity.
    VelocityMPerS,
    /// Its acceleration.
    AccelerationMPerS2,
    /// Absolute value of its velocity.
    SpeedMPerS,
    /// Sign of its velocity, −1 to 1.
    Direction,
    /// Drive force.
    ForceN,
    /// Time of the session.
    TimeS,
    /// Position of the first other axis of the machine.
    OtherPositionMm,
    /// Velocity of the first other axis of the machine.
    OtherVelocityMPerS,
    /// Acceleration of the first other axis of the machine.
    OtherAccelerationMPerS2,
    /// Sign of the velocity of the first other axis of the machine, −1 to 1.
    OtherDirection,
}

impl TableChannel {
    /// The stage whose residual is that of the channel.
    #[must_use]
    pub const fn stage(self) -> Stage {
        match self {
            Self::Motor => Stage::Motor,
            Self::Table => Stage::Table,
            Self::Tool => Stage::Tool,
            Self::Force => Stage::Force,
        }
    }

    /// The channel of a stage.
    #[must_use]
    pub const fn of(stage: Stage) -> Self {
        match stage {
            Stage::Motor => Self::Motor,
            Stage::Table => Self::Table,
            Stage::Tool => Self::Tool,
            Stage::Force => Self::Force,
        }
    }
}

/// Number of the first other axis of the machine, for an axis by its number.
#[must_use]
pub const fn first_other(axis: usize) -> usize {
    if axis == 0 { 1 } else { 0 }
}

impl TableVariable {
    /// Speed below which the direction of motion is zero, m/s.
    pub const MIN_DIRECTION_M_PER_S: f64 = 1e-4;

    /// Whether it is a variable of another axis.
    #[must_use]
    pub const fn is_of_other_axis(self) -> bool {
        matches!(
            self,
            Self::OtherPositionMm
                | Self::OtherVelocityMPerS
                | Self::OtherAccelerationMPerS2
                | Self::OtherDirection
        )
    }

    /// The direction of a velocity, m/s: −1, 0 or 1.
    #[must_use]
    pub fn direction(velocity_m_per_s: f64) -> f64 {
        if velocity_m_per_s.abs() < Self::MIN_DIRECTION_M_PER_S { 0.0 } else { velocity_m_per_s.signum() }
    }
}

/// `[[axis.NAME.empirical]]`: a residual as a function of a variable, linear between the points and constant beyond them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResidualTable {
    /// The channel whose residual it describes.
    pub channel: TableChannel,
    /// The variable.
    pub variable: TableVariable,
    /// Points of the variable, which increase.
    pub at: Vec<f64>,
    /// Measured − modelled position at each point, µm; of a table of positions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub error_um: Vec<f64>,
    /// Measured − modelled force at each point, N; of a table of the force.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub error_n: Vec<f64>,
}

impl ResidualTable {
    /// A table of points and residuals (µm or N), which are sorted by the points.
    #[must_use]
    pub fn new(channel: TableChannel, variable: TableVariable, points: &[[f64; 2]]) -> Self {
        let (at, error): (Vec<f64>, Vec<f64>) = points.iter().map(|[at, error]| (*at, *error)).unzip();
        let (error_um, error_n) =
            if channel == TableChannel::Force { (Vec::new(), error) } else { (error, Vec::new()) };
        Self { channel, variable, at, error_um, error_n }
    }

    /// The stage whose residual it describes.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        self.channel.stage()
    }

    /// The values at the points, µm or N.
    #[must_use]
    pub fn error(&self) -> &[f64] {
        if self.channel == TableChannel::Force { &self.error_n } else { &self.error_um }
    }

    /// Measured − modelled value at a value of the variable, µm or N.
    #[must_use]
    pub fn value(&self, variable: f64) -> f64 {
        let error = self.error();
        let above = self.at.partition_point(|x| *x < variable);
        let point = |i: usize| Some([*self.at.get(i)?, *error.get(i)?]);
        between(above.checked_sub(1).and_then(point), point(above), variable)
    }
}

/// The value between the neighbouring points (variable, value) of a table, on a straight line; beyond the last or the first point
/// its value, and 0 without any.
#[must_use]
pub fn between(below: Option<[f64; 2]>, above: Option<[f64; 2]>, variable: f64) -> f64 {
    match (below, above) {
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (variable - x0) / (x1 - x0),
        (Some([_, y]), None) | (None, Some([_, y])) => y,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_linear_between_its_points_and_constant_beyond() {
        let points = [[0.0, 1.0], [10.0, 3.0], [30.0, -1.0]];
        let table = ResidualTable::new(TableChannel::Force, TableVariable::ForceN, &points);
        for (at, value) in [(-5.0, 1.0), (0.0, 1.0), (5.0, 2.0), (20.0, 1.0), (99.0, -1.0)] {
            assert!((table.value(at) - value).abs() < 1e-12, "{at}");
        }
        assert_eq!((table.stage(), table.error_um.len(), table.error_n.len()), (Stage::Force, 0, 3));
        assert!(ResidualTable::default().value(1.0).abs() < 1e-12);
    }

    #[test]
    fn the_direction_is_zero_at_rest() {
        for (velocity, direction) in [(-1.0, -1.0), (-9e-5, 0.0), (2e-4, 1.0)] {
            assert!((TableVariable::direction(velocity) - direction).abs() < 1e-12);
        }
    }
}
