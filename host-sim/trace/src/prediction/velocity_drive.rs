//! The motor stage of an axis whose position loop commands the velocity of a drive.
//!
//! The masses and gains of the drive are not known. Its velocity loop with a proportional and an integral part on one mass has two
//! unknowns, the time constant τ = m/Kv and the integral rate 1/Ti: dv/dt = (e + ∫e·dt/Ti)/τ − f·h with e = velocity command − v. The Coulomb
//! friction over the mass f is the third, a dead time the fourth. They are fitted as part of the declared model. The friction reverses
//! over micrometres: dh/dt = v/s·(1 − h·sign v) (Dahl, 1968).

use super::position_loop::PositionLoop;
use model::axis::Settings;
use model::servo::ServoParameters;
use plant::friction_direction::{self, DRIVE_SLIP_M};

/// Number of steps of a sample.
const STEPS: usize = 4;

/// The motor, m, of a closed position loop with this command (m); `None` without a position gain.
///
/// The velocity command is that of a [`PositionLoop`].
#[must_use]
pub fn motor(
    settings: &Settings,
    servo: &ServoParameters,
    command: &[f64],
    sample_s: f64,
) -> Option<Vec<f64>> {
    let first_m = *command.first()?;
    let velocity = command.get(1).map_or(0.0, |second| (second - first_m) / sample_s);
    let mut position_loop = PositionLoop::following(settings, servo, [first_m, velocity], sample_s)?;
    let mut axis = Axis::following(servo, [first_m - position_loop.lag_m(), velocity], sample_s);
    let mut motor_m = Vec::with_capacity(command.len());
    for &now_m in command {
        motor_m.push(axis.position_m);
        let wanted = position_loop.sample(now_m, axis.position_m);
        axis.sample(wanted, sample_s);
    }
    Some(motor_m)
}

/// State of the drive and its mass.
struct Axis {
    position_m: f64,
    velocity: f64,
    /// ∫e·dt/Ti, m/s.
    integral: f64,
    /// Velocity commands that have not yet reached the drive, the oldest first, m/s.
    waiting: Vec<f64>,
    time_constant_s: f64,
    integral_per_s: f64,
    friction_m_per_s2: f64,
    /// Direction of the friction, −1 to 1.
    direction: f64,
    /// Fraction of a sample by which the drive follows after the last whole sample of its dead time.
    late: f64,
}

impl Axis {
    /// In steady motion at a position (m) with a velocity (m/s): the drive is settled.
    fn following(servo: &ServoParameters, [position_m, velocity]: [f64; 2], sample_s: f64) -> Self {
        let dead = (servo.velocity_drive.dead_time_s / sample_s).max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let whole = dead.floor() as usize;
        Self {
            position_m,
            velocity,
            integral: 0.0,
            waiting: vec![velocity; whole + 1],
            // A shorter one is none: the steps would not resolve it.
            time_constant_s: servo.velocity_drive.time_constant_s.max(0.25 * sample_s / STEPS as f64),
            integral_per_s: servo.velocity_drive.integral_per_s.max(0.0),
            friction_m_per_s2: servo.velocity_drive.friction_m_per_s2.max(0.0),
            direction: 0.0,
            late: dead - dead.floor(),
        }
    }

    /// One sample with a new velocity command, m/s.
    fn sample(&mut self, wanted: f64, sample_s: f64) {
        let before = self.waiting.remove(0);
        self.waiting.push(wanted);
        let after = self.waiting[0];
        self.advance(before, self.late * sample_s);
        self.advance(after, (1.0 - self.late) * sample_s);
    }

    /// The drive with a constant command (m/s) for a time (s): its integral by steps, its lag exactly within each.
    fn advance(&mut self, command: f64, time_s: f64) {
        let step_s = time_s / STEPS as f64;
        let left = libm::exp(-step_s / self.time_constant_s);
        for _ in 0..STEPS {
            self.direction = friction_direction::after(self.direction, self.velocity * step_s, DRIVE_SLIP_M);
            // The velocity that the drive approaches.
            let end =
                command + self.integral - self.time_constant_s * self.friction_m_per_s2 * self.direction;
            let excess = self.velocity - end;
            self.position_m += end * step_s + excess * self.time_constant_s * (1.0 - left);
            let middle = end + excess * left.sqrt();
            self.velocity = end + excess * left;
            self.integral += self.integral_per_s * (command - middle) * step_s;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::machine::Machine;

    const SAMPLE_S: f64 = 1e-3;

    /// A loop with Kp = 50 1/s and feed-forward (percent), with a changed drive.
    fn run(percent: f64, change: impl FnOnce(&mut ServoParameters), command: &[f64]) -> Vec<f64> {
        let text = format!(
            "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ndrive = \"velocity\"\nposition_gain_per_s = 50.0\n\
             feedforward_percent = {percent}\n"
        );
        let machine = Machine::parse(&text, "m.toml").unwrap();
        let mut servo = ServoParameters::default();
        change(&mut servo);
        motor(&machine.axis["x"].settings, &servo, command, SAMPLE_S).unwrap()
    }

    fn ramp() -> Vec<f64> {
        (0..2000u32).map(|i| 1e-4 * f64::from(i)).collect()
    }

    /// In steady motion the lag is v·(1 − Kf)/Kp: 0.1 m/s · 0.4 / 50 1/s = 0.8 mm, with any drive but its dead time and lag, which the loop
    /// does not see once the velocity is steady.
    #[test]
    fn steady_motion_lags_by_the_loop_alone() {
        for time_constant_s in [0.0, 0.005] {
            let motor = run(60.0, |servo| servo.velocity_drive.time_constant_s = time_constant_s, &ramp());
            let lag_mm = 1e3 * (ramp()[1999] - motor[1999]);
            assert!((lag_mm - 0.8).abs() < 1e-6, "{lag_mm}");
        }
    }

    /// A step of the command of 1 mm with a drive of 4 ms: the poles of s² + s/τ + Kp/τ, s = −125 ± √(125² − 12500) = −69.1 and −180.9 1/s,
    /// give x(t) = 1 − (180.9·e^(−69.1 t) − 69.1·e^(−180.9 t))/111.8. The command is held for a sample: half of one later, 2 % at 20 ms.
    #[test]
    fn a_step_is_that_of_a_second_order_loop() {
        let command: Vec<f64> = (0..200).map(|i| if i < 10 { 0.0 } else { 1e-3 }).collect();
        let motor = run(0.0, |servo| servo.velocity_drive.time_constant_s = 4e-3, &command);
        for t_ms in [10.0, 20.0, 40.0_f64] {
            let t = 1e-3 * t_ms;
            let exact = 1.0 - (180.9 * (-69.1 * t).exp() - 69.1 * (-180.9 * t).exp()) / 111.8;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a sample")]
            let found = 1e3 * motor[10 + t_ms as usize];
            assert!((found - exact).abs() < 0.02, "{t_ms} {found} {exact}");
        }
    }

    /// With an integral part the velocity follows a constant acceleration without a lag of its own: the axis lags as with an ideal drive,
    /// a/(Kp·Kp), plus v/Kp; without it the velocity is low by a·τ, and the axis lags by a·τ/Kp more, 1 m/s² · 4 ms / 50 1/s = 80 µm.
    #[test]
    fn the_integral_part_removes_the_lag_of_the_drive_under_acceleration() {
        let command: Vec<f64> = (0..1000u32).map(|i| 0.5e-6 * f64::from(i * i)).collect();
        let last = |change: fn(&mut ServoParameters)| run(0.0, change, &command)[999];
        let ideal = last(|_| {});
        let lag = last(|servo| servo.velocity_drive.time_constant_s = 4e-3);
        let integral = last(|servo| {
            servo.velocity_drive.time_constant_s = 4e-3;
            servo.velocity_drive.integral_per_s = 50.0;
        });
        let um = |m: f64| 1e6 * (ideal - m);
        // The ideal drive of the test has a time constant of a sixteenth of a sample: 1 µm.
        assert!((um(lag) - 80.0).abs() < 3.0, "{}", um(lag));
        assert!(um(integral).abs() < 3.0, "{}", um(integral));
    }

    /// A dead time of 2.5 ms delays a step by 2.5 samples.
    #[test]
    fn a_dead_time_delays() {
        let command: Vec<f64> = (0..100).map(|i| if i < 10 { 0.0 } else { 1e-3 }).collect();
        let motor = run(0.0, |servo| servo.velocity_drive.dead_time_s = 2.5e-3, &command);
        assert!(motor[12] == 0.0 && motor[13] > 0.0, "{:?}", &motor[10..15]);
        let direct = run(0.0, |_| {}, &command);
        let half = 0.5 * (direct[11] + direct[10]);
        assert!((motor[13] - half).abs() < 2e-6, "{} {half}", motor[13]);
    }
}
