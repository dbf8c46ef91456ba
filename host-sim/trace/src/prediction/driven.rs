//! The table and force stages: linear scale and drive force, predicted from the measured motor.

use super::force_sampling::ForceSampling;
use super::table_motion::{self, MeasuredMotor};
use crate::input::table_motions::TableMotion;
use model::effects::Channel;
use numerics::resample::{delayed_cubic, delayed_linear};
use plant::parameters::AxisParameters;

/// Table and force stage of one log.
#[derive(Clone, Debug, Default)]
pub struct Driven {
    /// Linear scale, m.
    pub table_m: Vec<f64>,
    /// Force of the velocity tick that ends at the sample, N.
    pub force_n: Vec<f64>,
}

/// The measured inputs of the driven mechanics.
#[derive(Clone, Copy, Debug)]
pub struct DrivenInput<'a> {
    /// Motor.
    pub measured: MeasuredMotor<'a>,
    /// Sample time, s.
    pub sample_s: f64,
    /// Difference between the logged force and the mean force of a sample.
    pub sampling: ForceSampling,
    /// Force that was added to the controller's force, filtered, N.
    pub added_n: Option<&'a [f64]>,
}

/// Drives the mechanics with the measured motor.
///
/// The linear part is computed from the filtered motor: for the table, the position of the motor and the stretch of the
/// spring by acceleration; for the force, mass times acceleration. The nonlinear part (friction, backlash, periodic errors)
/// is computed from the path between the samples and then passes the same filter.
#[must_use]
pub fn driven(parameters: &AxisParameters, input: &DrivenInput<'_>) -> Driven {
    let DrivenInput { measured, sample_s, sampling, added_n } = *input;
    let MeasuredMotor { motor, path, .. } = measured;
    if path.points.is_empty() {
        return Driven::default();
    }
    let motion = table_motion::of(parameters, measured);
    let mass = parameters.motor_mass_kg + parameters.table_mass_kg;
    // The force is the mean over the tick that ends at the sample, half a sample before it, and is logged late.
    // The commanded force is ahead of the acting one by the dead time of the drive.
    let late = (parameters.latency_s(Channel::Force) - parameters.servo.dead_time.seconds()) / sample_s;
    let age = 0.5 + late;
    let nonlinear_n = nonlinear_force_n(parameters, measured, &motion);
    let (force_n, acceleration) =
        (delayed_linear(&nonlinear_n, age), delayed_linear(&motor.acceleration, age));
    let mut force_n = sum(&motor.filtered(&force_n), |i| mass * acceleration[i]);
    for force_n in &mut force_n {
        *force_n = parameters.drive_asymmetry.commanded_n(*force_n);
    }
    add_lead(&mut force_n, parameters.servo.drive_time_constant_s(0.0) / sample_s);
    let acceleration_before = |samples: f64| delayed_linear(&motor.acceleration, samples + late);
    // The correction for sampling applies only to the force of the controller.
    add(&mut force_n, added_n, -1.0);
    sampling.last_ticks_from_means(&mut force_n, acceleration_before, sample_s);
    add(&mut force_n, added_n, 1.0);
    Driven {
        table_m: delayed_cubic(motion.table_m.clone(), parameters.latency_s(Channel::Table), sample_s),
        force_n,
    }
}

/// The force at the samples without its linear part, (motor mass + table mass)·acceleration.
fn nonlinear_force_n(
    parameters: &AxisParameters,
    measured: MeasuredMotor<'_>,
    motion: &TableMotion,
) -> Vec<f64> {
    let MeasuredMotor { motor, path, .. } = measured;
    let force_n = |(i, transmitted_n): (usize, &f64)| {
        parameters.motor_level_n(motor.velocity[i]) * path.sign[i]
            - parameters.torque_ripple_n(motion.motor_m[i])
            + transmitted_n
            + parameters.motor_mass_kg * motion.dividing_acceleration[i]
    };
    motion.transmitted_n.iter().enumerate().map(force_n).collect()
}

/// Replaces the acting force by the commanded one, which the drive follows with a lag of this time constant (samples):
/// F + τ·F', with central differences.
fn add_lead(force_n: &mut [f64], lag: f64) {
    if lag == 0.0 || force_n.len() < 3 {
        return;
    }
    let mut before_n = force_n[0];
    for i in 1..force_n.len() - 1 {
        let acting_n = force_n[i];
        force_n[i] += 0.5 * lag * (force_n[i + 1] - before_n);
        before_n = acting_n;
    }
}

/// Adds a force times a sign, if the force is given.
fn add(force_n: &mut [f64], added_n: Option<&[f64]>, sign: f64) {
    for (force_n, added_n) in force_n.iter_mut().zip(added_n.unwrap_or_default()) {
        *force_n += sign * added_n;
    }
}

/// Each value plus `other` at the same index.
fn sum(values: &[f64], other: impl Fn(usize) -> f64) -> Vec<f64> {
    values.iter().enumerate().map(|(i, value)| value + other(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::motor_path::MotorPath;
    use crate::input::smoothing::Smooth;
    use crate::options::SampleOptions;
    use crate::prediction::closed_loop::{Controlled, closed_loop};
    use crate::prediction::initial_state::InitialState;
    use model::effects::{Effect, PitchCyclic, ResolverDividing};
    use model::machine::Machine;
    use model::servo;

    /// A closed loop is simulated with the plant's integrator of free motion. Its motor then drives the table through the
    /// implicit integrator. Table and force must agree.
    #[test]
    fn the_driven_table_moves_like_the_free_plant() {
        assert_driven_is_free(None);
    }

    /// Errors of screw and sensor cause accelerations. At 63 mm/s, an error of 5 µm over 10 mm accelerates the table's 150 kg
    /// with 8 mm/s² and loads a damper of 1.5e4 N·s/m with 3 N: stretches of 6 and 15 nm.
    #[test]
    fn errors_of_screw_and_sensor_are_driven_like_the_free_plant() {
        assert_driven_is_free(Some(Effect::PitchCyclic(PitchCyclic {
            amplitude_um: 5.0,
            period_mm: 10.0,
            phase_rad: 0.3,
            fitted_period_mm: None,
        })));
        assert_driven_is_free(Some(Effect::ResolverDividing(ResolverDividing {
            amplitude_um: 3.0,
            period_mm: 5.0,
            phase_rad: 0.3,
            fitted_period_mm: None,
        })));
    }

    fn assert_driven_is_free(effect: Option<Effect>) {
        let machine = Machine::parse(model::examples::DEMO_MACHINE, "demo.toml").unwrap();
        let axis = &mut machine.axis["x"].clone();
        axis.effect.extend(effect);
        let parameters = AxisParameters::of(axis);
        let settings = servo::settings(&axis.settings, &parameters.servo).unwrap();
        let rates = machine.rates();
        // ±20 mm at 0.5 Hz: 63 mm/s, 0.2 m/s², three reversals.
        let command: Vec<f64> =
            (0..4000).map(|i| 0.02 * (1.0 - (std::f64::consts::PI * 1e-3 * f64::from(i)).cos())).collect();
        let start = InitialState {
            motor_m: command[0],
            velocity: 0.0,
            table_m: None,
            is_settled: true,
            table_zero_m: 0.0,
            time_s: 0.0,
        };
        let simulated =
            closed_loop(&parameters, Controlled { settings: &settings, rates }, &command, &[], start)
                .unwrap();
        let motor = Smooth::new(simulated.motor_m.clone(), 1e-3, 5);
        let path = &MotorPath::new(&motor, SampleOptions::default().play_noise, 1e-3);
        let input = DrivenInput {
            measured: MeasuredMotor { motor: &motor, path, start_s: 0.0 },
            sample_s: 1e-3,
            sampling: ForceSampling::new(&axis.settings.controller, &parameters.servo, rates),
            added_n: None,
        };
        let driven = driven(&parameters, &input);
        let table = Smooth::new(simulated.table_m.clone(), 1e-3, 5);
        let error_nm: Vec<f64> =
            table.value.iter().zip(&driven.table_m).skip(300).map(|(a, b)| 1e9 * (a - b)).collect();
        let rms = numerics::rms(error_nm.iter().copied());
        // 1 % of the stretch of 1 µm under 200 N, and half of the scale's noise.
        assert!(rms < 10.0, "{rms} nm");
        let max_nm = numerics::max_abs(error_nm);
        assert!(max_nm < 150.0, "{max_nm} nm");
        // At the highest speed: friction of 180 + 30 N, 1000 N·s/m · 62.8 mm/s, no acceleration.
        let fastest = 2500;
        let velocity = motor.velocity[fastest];
        let expected = 210.0f64.copysign(velocity) + 1000.0 * velocity;
        assert!((driven.force_n[fastest] - expected).abs() < 3.0, "{} {expected}", driven.force_n[fastest]);
    }
}
