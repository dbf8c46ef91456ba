//! Tables and laws of residuals in the model of an axis.

use super::axis_model::AxisModel;
use model::residual_law::ResidualLaw;
use model::residual_table::ResidualTable;

impl AxisModel {
    /// This model with these tables of residuals instead of its own.
    #[must_use]
    pub fn with_tables(&self, empirical: Vec<ResidualTable>) -> Self {
        let mut model = self.clone();
        model.axis.empirical = empirical;
        model
    }

    /// This model with further tables. Of the same channel and variable, the sum takes the place of both, at the points of
    /// the new one.
    #[must_use]
    pub fn with_further_tables(&self, new: &[ResidualTable]) -> Self {
        let mut all = self.axis.empirical.clone();
        for table in new {
            let is_same =
                |other: &ResidualTable| (other.channel, other.variable) == (table.channel, table.variable);
            let known = all.iter().position(is_same).map(|index| all.remove(index));
            let value = |at: f64| known.as_ref().map_or(0.0, |known| known.value(at));
            let points: Vec<[f64; 2]> =
                table.at.iter().zip(table.error()).map(|(&at, error)| [at, error + value(at)]).collect();
            all.push(ResidualTable::new(table.channel, table.variable, &points));
        }
        self.with_tables(all)
    }

    /// This model with further laws.
    #[must_use]
    pub fn with_further_laws(&self, new: impl Iterator<Item = ResidualLaw>) -> Self {
        let mut model = self.clone();
        model.axis.residual_law.extend(new);
        model
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::ModelOptions;
    use model::machine::Axis;
    use model::residual_table::{TableChannel, TableVariable};
    use shared::config::Rates;

    #[test]
    fn a_further_table_is_added_to_that_of_the_same_channel_and_variable() {
        let table = |variable, points: &[[f64; 2]]| ResidualTable::new(TableChannel::Tool, variable, points);
        let known = [
            table(TableVariable::PositionMm, &[[0.0, 1.0], [10.0, 3.0]]),
            table(TableVariable::VelocityMPerS, &[[0.0, 5.0], [1.0, 5.0]]),
        ];
        let axis = Axis { empirical: known.to_vec(), ..Axis::default() };
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let model = AxisModel::new(&axis, rates, ModelOptions::default());
        let new = table(TableVariable::PositionMm, &[[5.0, 0.5], [20.0, -1.0]]);
        let tables = model.with_further_tables(&[new]).axis.empirical;
        // 2 + 0.5 at 5 mm; beyond its last point the known one is 3.
        assert_eq!(tables[0], known[1]);
        assert_eq!((&tables[1].at, &tables[1].error_um), (&vec![5.0, 20.0], &vec![2.5, 2.0]));
    }
}
