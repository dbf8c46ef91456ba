//! The motor stage of a stepper motor: its encoder, predicted from the command.

use model::effects::Backlash;
use numerics::resample::delayed_cubic;
use plant::parameters::AxisParameters;

/// The motor of a stepper, m, that is commanded (m) at the samples.
///
/// The field between command and rotor is a spring: under friction the rotor stays behind, and after a reversal until the field has
/// turned to the other side, as behind a gap. Under acceleration it lags by inertia over stiffness. The microsteps have a periodic
/// error over the command. Command and reading are some time apart.
#[must_use]
pub fn motor(parameters: &AxisParameters, command: &[f64], sample_s: f64) -> Vec<f64> {
    let angle = &parameters.stepper.load_angle;
    let half_m = Backlash { width_um: 2.0 * angle.friction_um }.half_m();
    let per_acceleration = 1e-6 * angle.um_s2_per_m / (sample_s * sample_s);
    let at = |i: usize| command[i.min(command.len() - 1)];
    let mut rotor_m = command.first().copied().unwrap_or(0.0);
    let position_m = |i: usize| {
        rotor_m = rotor_m.clamp(at(i) - half_m, at(i) + half_m);
        let acceleration_m = at(i + 1) - 2.0 * at(i) + at(i.saturating_sub(1));
        let microsteps: f64 = parameters.stepper.microsteps.iter().map(|error| error.error_m(at(i))).sum();
        rotor_m - per_acceleration * acceleration_m + microsteps
    };
    let motor_m = (0..command.len()).map(position_m).collect();
    delayed_cubic(motor_m, parameters.servo.velocity_drive.dead_time_s, sample_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::LoadAngle;

    /// Forth and back at 10 mm/s with a friction angle of 3 µm: the rotor lags by it in either direction; while it turns over, 6 µm of the
    /// command, it stands.
    #[test]
    fn friction_is_a_lag_in_the_direction_of_motion() {
        let mut parameters = AxisParameters::default();
        parameters.stepper.load_angle = LoadAngle { friction_um: 3.0, um_s2_per_m: 0.0 };
        let command: Vec<f64> = (0..200u32).map(|i| 1e-5 * f64::from(i.min(200 - i))).collect();
        let motor = motor(&parameters, &command, 1e-3);
        let lag_um = |i: usize| 1e6 * (command[i] - motor[i]);
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
        let mut parameters = AxisParameters::default();
        parameters.stepper.load_angle = LoadAngle { friction_um: 0.0, um_s2_per_m: 1.5 };
        let command: Vec<f64> = (0..200u32).map(|i| 1e-6 * f64::from(i * i)).collect();
        let motor = motor(&parameters, &command, 1e-3);
        assert!((1e6 * (command[100] - motor[100]) - 3.0).abs() < 1e-6);
    }
}
