//! The tables of residuals of an axis, which act on its logged channels.
//!
//! The residual of a channel is relative to the measured channel upstream of it: a displaced motor displaces table and tool, a
//! displaced table the tool. The loops do not react to a table.

use model::residual_table::{ResidualTable, TableChannel, TableVariable};

/// The motion of an axis at a sample, by which its tables are evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TableInput {
    /// Position of the table, m.
    pub position_m: f64,
    /// Velocity of the table, m/s.
    pub velocity: f64,
    /// Acceleration of the table, m/s².
    pub acceleration: f64,
    /// Force of the drive, N.
    pub force_n: f64,
    /// Position (m) and acceleration (m/s²) of the table of the first other axis.
    pub other: [f64; 2],
}

/// Displacements of the logged channels of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    /// Of the motor, m.
    pub motor_m: f64,
    /// Of the scale, m.
    pub table_m: f64,
    /// Of the tool, m.
    pub tool_m: f64,
    /// Of the force, N.
    pub force_n: f64,
}

impl TableInput {
    fn value(&self, variable: TableVariable) -> f64 {
        match variable {
            TableVariable::PositionMm => 1e3 * self.position_m,
            TableVariable::VelocityMPerS => self.velocity,
            TableVariable::AccelerationMPerS2 => self.acceleration,
            TableVariable::Direction => TableVariable::direction(self.velocity),
            TableVariable::ForceN => self.force_n,
            TableVariable::OtherPositionMm => 1e3 * self.other[0],
            TableVariable::OtherAccelerationMPerS2 => self.other[1],
        }
    }
}

/// The displacements by some tables.
#[must_use]
pub fn displacement(tables: &[ResidualTable], input: &TableInput) -> Displacement {
    let mut sum = Displacement::default();
    for table in tables {
        let error = table.value(input.value(table.variable));
        match table.channel {
            TableChannel::Motor => sum.motor_m += 1e-6 * error,
            TableChannel::Table => sum.table_m += 1e-6 * error,
            TableChannel::Tool => sum.tool_m += 1e-6 * error,
            TableChannel::Force => sum.force_n += error,
        }
    }
    sum.table_m += sum.motor_m;
    sum.tool_m += sum.table_m;
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_displaced_motor_displaces_table_and_tool() {
        let table = |channel, variable| ResidualTable::new(channel, variable, &[[0.0, 0.0], [10.0, 10.0]]);
        let tables = [
            table(TableChannel::Motor, TableVariable::PositionMm),
            table(TableChannel::Table, TableVariable::OtherPositionMm),
            table(TableChannel::Tool, TableVariable::AccelerationMPerS2),
            table(TableChannel::Force, TableVariable::ForceN),
        ];
        let input = TableInput {
            position_m: 1e-3,
            acceleration: 4.0,
            force_n: 8.0,
            other: [2e-3, 0.0],
            ..TableInput::default()
        };
        let Displacement { motor_m, table_m, tool_m, force_n } = displacement(&tables, &input);
        // 1 µm at 1 mm, 2 µm at 2 mm of the other axis, 4 µm at 4 m/s², 8 N at 8 N.
        for (found, expected) in [(motor_m, 1e-6), (table_m, 3e-6), (tool_m, 7e-6), (force_n, 8.0)] {
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    }
}
