//! The motions of the table behind a motor path that were computed last.
//!
//! Half of the simulations of a search differ only in what acts on the motor or on the channels: masses and friction of the motor,
//! ripple, latencies. The table then moves as before.

use std::sync::{Arc, Mutex, PoisonError};

use plant::parameters::AxisParameters;

/// Number of motions that are kept: those of the fits and candidates that are computed at the same time.
const CAPACITY: usize = 8;

/// What the motion of a motor does to the table, at each sample.
#[derive(Clone, Debug, Default)]
pub struct TableMotion {
    /// Linear scale without latency, m.
    pub table_m: Vec<f64>,
    /// Force of the screw on the table without the part of the motor's acceleration, N.
    pub transmitted_n: Vec<f64>,
    /// True position of the motor, m.
    pub motor_m: Vec<f64>,
    /// Acceleration of the motor that its reading does not show, m/s².
    pub dividing_acceleration: Vec<f64>,
}

impl TableMotion {
    /// No sample, with memory for this number.
    #[must_use]
    pub fn with_capacity(samples: usize) -> Self {
        let [table_m, transmitted_n, motor_m, dividing_acceleration] =
            std::array::from_fn(|_| Vec::with_capacity(samples));
        Self { table_m, transmitted_n, motor_m, dividing_acceleration }
    }
}

/// The motions that were computed last, with their parameters. A copy has none.
#[derive(Debug, Default)]
pub struct TableMotions(Mutex<Vec<(AxisParameters, Arc<TableMotion>)>>);

impl TableMotions {
    /// The motion for these parameters, computed unless it is known.
    pub fn get(
        &self,
        parameters: AxisParameters,
        compute: impl FnOnce(&AxisParameters) -> TableMotion,
    ) -> Arc<TableMotion> {
        if let Some(known) = self.known(&parameters) {
            return known;
        }
        let motion = Arc::new(compute(&parameters));
        let mut motions = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        motions.truncate(CAPACITY - 1);
        motions.insert(0, (parameters, motion.clone()));
        motion
    }

    /// A known motion, which becomes the last to be dropped.
    fn known(&self, parameters: &AxisParameters) -> Option<Arc<TableMotion>> {
        let mut motions = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let index = motions.iter().position(|(known, _)| known == parameters)?;
        motions[..=index].rotate_right(1);
        Some(motions[0].1.clone())
    }
}

impl Clone for TableMotions {
    fn clone(&self) -> Self {
        Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_mass(table_mass_kg: f64) -> AxisParameters {
        AxisParameters { table_mass_kg, ..AxisParameters::default() }
    }

    /// The masses in `order` are asked for one after the other; those that were computed.
    fn computed(order: &[f64]) -> Vec<f64> {
        let motions = TableMotions::default();
        let mut computed = Vec::new();
        for &mass_kg in order {
            let motion = motions.get(of_mass(mass_kg), |parameters| {
                computed.push(parameters.table_mass_kg);
                TableMotion { table_m: vec![parameters.table_mass_kg], ..TableMotion::default() }
            });
            assert_eq!(motion.table_m, [mass_kg]);
        }
        computed
    }

    #[test]
    fn a_known_motion_is_not_computed_again() {
        assert_eq!(computed(&[1.0, 2.0, 1.0, 2.0, 1.0]), [1.0, 2.0]);
    }

    #[test]
    fn the_motion_that_was_not_used_for_longest_is_dropped() {
        // Eight are kept. The ninth takes the place of 2, as 1 was used after it.
        let order = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 1.0, 9.0, 1.0, 2.0];
        assert_eq!(computed(&order), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 2.0]);
    }
}
