//! The initial state of a simulation.

use crate::input::signals::AxisSignals;
use crate::options::SampleOptions;
use plant::axis_motion::AxisMotion;
use plant::driven::{DrivenTable, ScrewMotion};
use plant::parameters::AxisParameters;

/// The initial state of a closed loop.
#[derive(Clone, Copy, Debug)]
pub struct InitialState {
    /// Reading of the motor encoder, m.
    pub motor_m: f64,
    /// Velocity of the motor, m/s.
    pub velocity: f64,
    /// Position of the table, m; `None`: in equilibrium with the motor.
    pub table_m: Option<f64>,
    /// Whether the loop was closed before, so that the low-pass of dual feedback contains the difference between table and
    /// motor.
    pub is_settled: bool,
    /// Reading of the linear scale − position of the table, m. The controller receives the reading.
    pub table_zero_m: f64,
    /// Time on the session clock, s.
    pub time_s: f64,
}

impl InitialState {
    /// The state at the start of a log; `zero_m` is the zero of the linear scale.
    ///
    /// If the motor moves while its command is constant, the drive was just switched on. The spring may then be strained, and
    /// the initial position of the table is the reading of its scale.
    #[must_use]
    pub fn of(command: &[f64], signals: &AxisSignals, zero_m: f64, options: &SampleOptions) -> Option<Self> {
        let (count, time_s) = (options.constant_command, signals.start_s);
        let motor = signals.motor.as_ref()?;
        let first = motor.raw[0];
        let is_constant = command.len() > count
            && command[..count].windows(2).all(|two| two[0].to_bits() == two[1].to_bits());
        let moves = |later: &[f64]| {
            let motion = numerics::mean(later.iter().copied()) - first;
            motion.abs() > options.min_motion_noise * motor.noise
        };
        if is_constant && motor.raw[1..count].chunks(5).any(moves) {
            let table_m = signals.table.as_ref().map(|table| table.raw[0] - zero_m);
            let (velocity, is_settled) = (0.0, false);
            return Some(Self {
                motor_m: first,
                velocity,
                table_m,
                is_settled,
                table_zero_m: zero_m,
                time_s,
            });
        }
        let velocity = if is_constant { 0.0 } else { motor.velocity[0] };
        let (motor_m, table_zero_m) = (motor.value[0], zero_m);
        Some(Self { motor_m, velocity, table_m: None, is_settled: true, table_zero_m, time_s })
    }
}

/// An axis in steady motion, with its motor at a position (m) and a velocity (m/s), at a time on the session clock (s).
#[must_use]
pub fn steady_motion(parameters: &AxisParameters, motor_m: f64, velocity: f64, time_s: f64) -> AxisMotion {
    let screw = ScrewMotion { velocity, time_s, ..ScrewMotion::at(&parameters.screw, motor_m) };
    let table = DrivenTable::settled(parameters, screw);
    let (hysteresis, stretch_m) = table.hysteresis();
    AxisMotion {
        hysteresis,
        stretch_m,
        motor_m,
        motor_m_per_s: velocity,
        table_m: table.position_m(parameters, screw),
        table_m_per_s: velocity,
        bristle_m: table.bristle_m(),
        filtered_speed_m_per_s: table.filtered_speed_m_per_s(),
        time_s,
        drive_n: table.transmitted_n + parameters.motor_friction_n(velocity)
            - parameters.torque_ripple_n(motor_m),
        friction_n: parameters.friction.bristle_stiffness_n_per_m * table.bristle_m(),
        ..AxisMotion::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::signals::Signals;
    use files::log::{AxisLog, Log, Unit};

    /// The state at the start of a log whose motor moves by `motion_mm` within the first 10 ms of a constant command.
    fn start(motion_mm: f64) -> InitialState {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        let position = |i: u32| 5.0 + motion_mm * (f64::from(i) / 10.0).min(1.0);
        // ±10 nm of noise, alternating.
        let noise = |i: u32| if i.is_multiple_of(2) { 1e-5 } else { -1e-5 };
        axis.command = Some(vec![5.0; 1000]);
        axis.motor = Some((0..1000).map(|i| position(i) + noise(i)).collect());
        axis.table = Some((0..1000).map(|i| position(i) + 2e-3 + noise(i)).collect());
        let log = Log::new("", 0.0, 1e-3, [axis]);
        let options = SampleOptions::default();
        let signals = &Signals::new(&log, &["x".to_owned()], &options).axes[0];
        InitialState::of(signals.command.as_ref().unwrap(), signals, 0.5e-6, &options).unwrap()
    }

    #[test]
    fn a_motor_that_moves_at_a_constant_command_was_just_switched_on() {
        let resting = start(0.0);
        assert!(resting.is_settled && resting.table_m.is_none(), "{resting:?}");
        let switched_on = start(1e-3);
        assert!(!switched_on.is_settled, "{switched_on:?}");
        // The table is 2 µm from the motor, of which 0.5 µm are the zero of the scale; the noise is ±10 nm.
        let strain_m = switched_on.table_m.unwrap() - switched_on.motor_m;
        assert!((strain_m - 1.5e-6).abs() < 1e-9, "{strain_m:e}");
        assert!((switched_on.motor_m - 5e-3 - 1e-8).abs() < 1e-12);
    }
}
