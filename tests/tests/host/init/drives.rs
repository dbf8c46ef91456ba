//! Drives without a force: the logs are those of simulators that share no code with the plant.

use super::initial;
use crate::drives::{logs_of_a_stepper, logs_of_a_velocity_drive};
use model::axis::Drive;
use model::effects::Stage;
use trace::trace;

/// Kp 45 1/s, Kf 80 %: in steady motion the axis lags by v·(1 − Kf)/Kp. The lag is determined; the gains are rivals beside the unknown
/// bandwidth of the drive.
#[test]
fn the_gains_of_a_velocity_drive() {
    let logs = logs_of_a_velocity_drive();
    let initial = initial(&init::unknown("mill", &logs[..2]).unwrap(), &logs[..2]);
    let controller = &initial.machine.axis["x"].settings.controller;
    assert_eq!(controller.drive, Drive::Velocity);
    let (gain, feed) = (controller.position_gain_per_s.unwrap(), controller.feedforward_percent.unwrap());
    let lag_s = (1.0 - 0.01 * feed) / gain;
    assert!((lag_s / (0.2 / 45.0) - 1.0).abs() < 0.02, "{gain} {feed}");
    let tolerances = initial.machine.axis["x"].settings.mechanics.tolerance_percent.as_ref().unwrap();
    let tolerance = 0.01 * tolerances.position_gain_per_s.unwrap();
    assert!((45.0 / gain - 1.0).abs() < tolerance, "{gain} ± {tolerance}");
    let trace = trace(&initial.machine, &logs[..2], &logs[2..], &|_| {}).unwrap();
    assert!(trace.axes()[0].found.is_empty(), "{:?}", trace.found_names());
    let motor = trace.axes()[0].residual(Stage::Motor).unwrap();
    // With the true gains: the noise of the encoder, 50 nm, and what the steps of the model leave, see `drives::velocity`.
    assert!((0.03..0.3).contains(&motor.after.validate), "{} µm", motor.after.validate);
}

#[test]
fn a_log_without_a_motor_is_that_of_a_stepper() {
    let logs = logs_of_a_stepper();
    let initial = initial(&init::unknown("printer", &logs).unwrap(), &logs);
    let settings = &initial.machine.axis["x"].settings;
    assert_eq!(settings.controller.drive, Drive::Stepper);
    assert_eq!((settings.controller.position_gain_per_s, settings.mechanics.table_mass_kg), (None, None));
    assert!(initial.notes.iter().any(|note| note.contains("lead_mm is unknown")), "{:?}", initial.notes);
}
