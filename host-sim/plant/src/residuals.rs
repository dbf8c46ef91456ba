//! The residuals of an axis that no effect describes, as tables and laws, which act on its logged channels.
//!
//! The residual of a channel is relative to the measured channel upstream of it: a displaced motor displaces table and tool, a
//! displaced table the tool. The loops do not react to a residual.

use model::residual_law::{Hysteresis, ResidualLaw, Variables};
use model::residual_table::{ResidualTable, TableChannel, TableVariable};

/// The residuals of an axis that no effect describes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residuals {
    /// Tables.
    pub tables: Vec<ResidualTable>,
    /// Laws.
    pub laws: Vec<ResidualLaw>,
}

/// The motion of an axis at a sample, by which its residuals are evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResidualInput {
    /// Position of the table, m.
    pub position_m: f64,
    /// Velocity of the table, m/s.
    pub velocity: f64,
    /// Acceleration of the table, m/s².
    pub acceleration: f64,
    /// Force of the drive, N.
    pub force_n: f64,
    /// Time of the session, s.
    pub time_s: f64,
    /// The table of the first other axis.
    pub other: OtherAxis,
}

/// The motion of the table of another axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OtherAxis {
    /// Position, m.
    pub position_m: f64,
    /// Velocity, m/s.
    pub velocity: f64,
    /// Acceleration, m/s².
    pub acceleration: f64,
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

impl Variables for ResidualInput {
    fn value(&self, variable: TableVariable) -> f64 {
        match variable {
            TableVariable::PositionMm => 1e3 * self.position_m,
            TableVariable::VelocityMPerS => self.velocity,
            TableVariable::AccelerationMPerS2 => self.acceleration,
            TableVariable::SpeedMPerS => self.velocity.abs(),
            TableVariable::Direction => TableVariable::direction(self.velocity),
            TableVariable::ForceN => self.force_n,
            TableVariable::TimeS => self.time_s,
            TableVariable::OtherPositionMm => 1e3 * self.other.position_m,
            TableVariable::OtherVelocityMPerS => self.other.velocity,
            TableVariable::OtherAccelerationMPerS2 => self.other.acceleration,
            TableVariable::OtherDirection => TableVariable::direction(self.other.velocity),
        }
    }
}

impl Residuals {
    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.tables.is_empty() && self.laws.is_empty()
    }

    /// The hystereses of all terms of all laws, before any motion.
    #[must_use]
    pub fn hystereses(&self) -> Vec<Vec<Hysteresis>> {
        self.laws.iter().map(|law| vec![Hysteresis::default(); law.term.len()]).collect()
    }

    /// The displacements of the logged channels.
    pub fn displacement(&self, input: &ResidualInput, hystereses: &mut [Vec<Hysteresis>]) -> Displacement {
        let of_tables =
            self.tables.iter().map(|table| (table.channel, table.value(input.value(table.variable))));
        let of_laws = (self.laws.iter().zip(hystereses))
            .map(|(law, hystereses)| (law.channel, law.value(input, hystereses)));
        let mut sum = Displacement::default();
        for (channel, error) in of_tables.chain(of_laws) {
            match channel {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::residual_law::Term;

    #[test]
    fn a_displaced_motor_displaces_table_and_tool() {
        let table = |channel, variable| ResidualTable::new(channel, variable, &[[0.0, 0.0], [10.0, 10.0]]);
        let tables = vec![
            table(TableChannel::Motor, TableVariable::PositionMm),
            table(TableChannel::Table, TableVariable::OtherPositionMm),
            table(TableChannel::Tool, TableVariable::AccelerationMPerS2),
            table(TableChannel::Force, TableVariable::ForceN),
        ];
        let product = Term::Product {
            of: vec![TableVariable::SpeedMPerS, TableVariable::OtherVelocityMPerS],
            coefficient: 10.0,
        };
        let laws = vec![ResidualLaw { channel: TableChannel::Table, constant: 0.5, term: vec![product] }];
        let input = ResidualInput {
            position_m: 1e-3,
            velocity: -0.5,
            acceleration: 4.0,
            force_n: 8.0,
            other: OtherAxis { position_m: 2e-3, velocity: 0.1, acceleration: 0.0 },
            ..ResidualInput::default()
        };
        let residuals = Residuals { tables, laws };
        let found = residuals.displacement(&input, &mut residuals.hystereses());
        let Displacement { motor_m, table_m, tool_m, force_n } = found;
        // 1 µm at 1 mm, 2 µm at 2 mm of the other axis and 10·0.5·0.1 + 0.5 µm of the law, 4 µm at 4 m/s², 8 N at 8 N.
        for (found, expected) in [(motor_m, 1e-6), (table_m, 4e-6), (tool_m, 8e-6), (force_n, 8.0)] {
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    }
}
