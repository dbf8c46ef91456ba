//! A stepper motor: its rotor beside the command.

use model::effects::{LoadAngle, PeriodicError};

/// How a stepper motor deviates from its command.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stepper {
    /// Periodic errors of the microsteps.
    pub microsteps: Vec<PeriodicError>,
    /// Lag under friction and acceleration.
    pub load_angle: LoadAngle,
}

impl Stepper {
    /// The rotor, m, at the samples of a command (m).
    ///
    /// The field between command and rotor is a spring: under friction the rotor stays behind, and after a reversal until the field has
    /// turned to the other side, as behind a gap. Under acceleration it lags by inertia over stiffness. The microsteps have a periodic
    /// error over the command.
    #[must_use]
    pub fn rotor_m(&self, command: &[f64], sample_s: f64) -> Vec<f64> {
        let half_m = 1e-6 * self.load_angle.friction_um;
        let per_second_difference = 1e-6 * self.load_angle.um_s2_per_m / (sample_s * sample_s);
        let at = |i: usize| command[i.min(command.len() - 1)];
        let mut behind_m = command.first().copied().unwrap_or(0.0);
        let position_m = |i: usize| {
            behind_m = behind_m.clamp(at(i) - half_m, at(i) + half_m);
            let second_difference_m = at(i + 1) - 2.0 * at(i) + at(i.saturating_sub(1));
            let microsteps: f64 = self.microsteps.iter().map(|error| error.error_m(at(i))).sum();
            behind_m - per_second_difference * second_difference_m + microsteps
        };
        (0..command.len()).map(position_m).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lagging(friction_um: f64, um_s2_per_m: f64) -> Stepper {
        Stepper { load_angle: LoadAngle { friction_um, um_s2_per_m }, ..Stepper::default() }
    }

    /// Back and forth at 10 mm/s with a friction angle of 3 µm: the rotor lags by it in either direction; while it turns over, 6 µm of the
    /// command, it stands.
    #[test]
    fn friction_is_a_lag_in_the_direction_of_motion() {
        let command: Vec<f64> = (0..200u32).map(|i| 1e-5 * f64::from(i.min(200 - i))).collect();
        let rotor = lagging(3.0, 0.0).rotor_m(&command, 1e-3);
        let lag_um = |i: usize| 1e6 * (command[i] - rotor[i]);
        assert!(
            (lag_um(80) - 3.0).abs() < 1e-6 && (lag_um(180) + 3.0).abs() < 1e-6,
            "{} {}",
            lag_um(80),
            lag_um(180)
        );
    }

    /// Under 2 m/s² with 1.5 µm per m/s²: 3 µm.
    #[test]
    fn acceleration_is_a_lag_by_inertia_over_stiffness() {
        let command: Vec<f64> = (0..200u32).map(|i| 1e-6 * f64::from(i * i)).collect();
        let rotor = lagging(0.0, 1.5).rotor_m(&command, 1e-3);
        assert!((1e6 * (command[100] - rotor[100]) - 3.0).abs() < 1e-6);
    }
}
