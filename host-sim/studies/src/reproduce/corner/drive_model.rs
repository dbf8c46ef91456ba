//! The model of the paper's section 2: command → feed-forward → position law → velocity loop → motor → table.
//!
//! Feed-forward is equation (2), `1 + (Kf/Kp)·s`; the position law is P or equation (1) with its lost Kp put back
//! (see `shared::control::hpc`); the table follows the motor as equation (3),
//! ω²/(s² + 2ζωs + ω²). Figure 2 is not in the scan: the velocity loop is taken as the controller's own PI on
//! one rigid mass, v′ = ωv·(e + ∫e dt/Ti) with ωv = Kv/mass. No friction, no elasticity, no error of any
//! part: what is left between this and the plant is the plant's own.
//!
//! Everything is linear and its input stands still, or runs straight, from sample to sample: the matrix
//! exponential makes every step exact.

use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector4};

use model::machine::{Axis, Controller};

/// Share of the position gain that the filter of equation (1) takes, k1·k2 and k2.
const HPC: [f64; 2] = [16.0, 6.0];

/// Velocity loop on a rigid mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityLoop {
    /// ωv = Kv/mass, 1/s.
    pub bandwidth_per_s: f64,
    /// Ti.
    pub integral_time_s: f64,
}

impl VelocityLoop {
    /// What the declared keys of an axis make of it.
    #[must_use]
    pub fn of(axis: &Axis) -> Self {
        let mass_kg = axis.motor_mass_kg.unwrap_or(0.0) + axis.table_mass_kg.unwrap_or(0.0);
        Self {
            bandwidth_per_s: axis.velocity_gain_n_s_per_m.unwrap_or(0.0) / mass_kg,
            integral_time_s: axis.velocity_integral_time_s.unwrap_or(f64::INFINITY),
        }
    }
}

/// From command to motor, one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// P or HPC.
    pub law: Controller,
    /// Kp.
    pub gain_per_s: f64,
    /// Kf.
    pub feedforward_percent: f64,
    /// Behind the position law.
    pub velocity: VelocityLoop,
}

/// Filtered error and its rate over Kp, motor position and velocity, velocity error integrated over Ti, and the
/// input that stands still.
type Loop = SMatrix<f64, 6, 6>;

impl Servo {
    /// The loop as x′ = A·x.
    #[must_use]
    pub fn system(&self) -> Loop {
        let (kp, VelocityLoop { bandwidth_per_s, integral_time_s }) = (self.gain_per_s, self.velocity);
        let mut a = Loop::zeros();
        // Velocity asked for, as a row over the states.
        let mut asked = [0.0; 6];
        match self.law {
            Controller::P => (asked[2], asked[5]) = (-kp, kp),
            Controller::Hpc => {
                asked[0] = kp;
                a[(0, 1)] = kp;
                (a[(1, 0)], a[(1, 1)]) = (-HPC[0] * kp, -HPC[1] * kp);
                (a[(1, 2)], a[(1, 5)]) = (-HPC[0] * kp, HPC[0] * kp);
            }
        }
        a[(2, 3)] = 1.0;
        for (column, asked) in asked.into_iter().enumerate() {
            a[(3, column)] = bandwidth_per_s * asked;
            a[(4, column)] = asked / integral_time_s;
        }
        a[(3, 3)] -= bandwidth_per_s;
        a[(3, 4)] += bandwidth_per_s;
        a[(4, 3)] -= 1.0 / integral_time_s;
        a
    }

    /// Motor positions for commands (both m), a sample apart, from rest.
    #[must_use]
    pub fn motor_m(&self, command_m: &[f64], sample_s: f64) -> Vec<f64> {
        let step = (self.system() * sample_s).exp();
        let lead_s = 1e-2 * self.feedforward_percent / self.gain_per_s;
        let origin = command_m.first().copied().unwrap_or(0.0);
        let mut state = SVector::<f64, 6>::zeros();
        let mut last = origin;
        command_m
            .iter()
            .map(|&command| {
                let motor = origin + state[2];
                state[5] = command - origin + lead_s * (command - last) / sample_s;
                last = command;
                state = step * state;
                motor
            })
            .collect()
    }
}

/// From motor to table, one axis: equation (3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mechanics {
    /// ωi, rad/s.
    pub omega_per_s: f64,
    /// ζi.
    pub damping_ratio: f64,
}

impl Mechanics {
    /// Table positions for motor positions (both m), a sample apart, from rest.
    #[must_use]
    pub fn table_m(&self, motor_m: &[f64], sample_s: f64) -> Vec<f64> {
        let (spring, drag) = (self.omega_per_s.powi(2), 2.0 * self.damping_ratio * self.omega_per_s);
        // Table, its velocity, motor, its velocity.
        #[rustfmt::skip]
        let system = Matrix4::new(
            0.0, 1.0, 0.0, 0.0,
            -spring, -drag, spring, 0.0,
            0.0, 0.0, 0.0, 1.0,
            0.0, 0.0, 0.0, 0.0,
        );
        let step = (system * sample_s).exp();
        let origin = motor_m.first().copied().unwrap_or(0.0);
        let mut state = Vector4::<f64>::zeros();
        let next = motor_m.iter().skip(1).chain(motor_m.last());
        motor_m
            .iter()
            .zip(next)
            .map(|(&motor, &next)| {
                let table = origin + state[0];
                state[2] = motor - origin;
                state[3] = (next - motor) / sample_s;
                state = step * state;
                table
            })
            .collect()
    }
}

/// The slowest pole (1/s) of a loop with equation (1) as it is printed, k1k2Kp²/(s² + k2·s + k1k2Kp²), and an
/// integrator: the real part nearest to zero. `leading` is the power of Kp put back before it, 0 or 1.
#[must_use]
pub fn printed_hpc_pole_per_s(gain_per_s: f64, leading: i32) -> f64 {
    let c = HPC[0] * gain_per_s.powi(2);
    let closed = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -c * gain_per_s.powi(leading), -c, -HPC[1]);
    numerics::max(closed.complex_eigenvalues().iter().map(|pole| pole.re))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLE_S: f64 = 2.5e-4;

    fn servo(law: Controller, feedforward_percent: f64) -> Servo {
        // So fast that the velocity loop lags by 1 µs.
        let velocity = VelocityLoop { bandwidth_per_s: 1e6, integral_time_s: 1e6 };
        Servo { law, gain_per_s: 50.0, feedforward_percent, velocity }
    }

    /// A step command of 1 m, one sample after rest, and the samples since.
    fn step(servo: &Servo) -> impl Iterator<Item = (f64, f64)> {
        let command: Vec<f64> = std::iter::once(0.0).chain(std::iter::repeat_n(1.0, 800)).collect();
        let motor = servo.motor_m(&command, SAMPLE_S);
        motor.into_iter().skip(1).enumerate().map(|(k, y)| (k as f64 * SAMPLE_S, y))
    }

    /// P behind an ideal velocity loop is a lag of 1/Kp: 1 − e^(−Kp·t). The loop's own 1 µs is 50 ppm of it.
    #[test]
    fn p_is_a_first_order_lag() {
        for (t, y) in step(&servo(Controller::P, 0.0)) {
            assert!((y - (1.0 - (-50.0 * t).exp())).abs() < 1e-4, "{t}: {y}");
        }
    }

    /// HPC closes to 16/((x + 2)(x² + 4x + 8)), x = s/Kp. By partial fractions its step is
    /// 1 − 2·e^(−2τ) + e^(−2τ)·(cos 2τ − sin 2τ), τ = Kp·t.
    #[test]
    fn hpc_has_the_step_of_its_three_poles() {
        for (t, y) in step(&servo(Controller::Hpc, 0.0)) {
            let tau = 50.0 * t;
            let exact = 1.0 + (-2.0 * tau).exp() * ((2.0 * tau).cos() - (2.0 * tau).sin() - 2.0);
            assert!((y - exact).abs() < 3e-4, "{t}: {y} {exact}");
        }
    }

    /// Equation (3) runs behind a ramp by 2ζ/ω, and swings over a step by e^(−πζ/√(1 − ζ²)).
    #[test]
    fn the_table_lags_and_swings_as_a_second_order_does() {
        let mechanics = Mechanics { omega_per_s: 400.0, damping_ratio: 0.2 };
        let ramp: Vec<f64> = (0..2000).map(|k| 0.05 * f64::from(k) * SAMPLE_S).collect();
        let lag = ramp[1999] - mechanics.table_m(&ramp, SAMPLE_S)[1999];
        assert!((lag / (0.05 * 2.0 * 0.2 / 400.0) - 1.0).abs() < 1e-6, "{lag}");

        let mut edge = vec![1.0; 400];
        edge[0] = 0.0;
        let most = numerics::max(mechanics.table_m(&edge, SAMPLE_S));
        let exact = 1.0 + (-std::f64::consts::PI * 0.2 / (1.0 - 0.04_f64).sqrt()).exp();
        // A top between two samples is missed by (ω·sample/2)²/2 of its height at the most.
        assert!(most > exact - 1e-3 && most < exact + 1e-3, "{most} {exact}");
    }

    /// With half of itself as feed-forward the zero takes the pole at −2 away: 8/(x² + 4x + 8) is left, whose ζ is
    /// 1/√2 and whose step overshoots by e^(−π).
    #[test]
    fn hpc_with_half_feedforward_is_a_butterworth_of_second_order() {
        let most = numerics::max(step(&servo(Controller::Hpc, 50.0)).map(|(_, y)| y));
        // The lead's impulse stands for a sample and is half of one late: ½·(x/2)·y″ less, x = Kp·sample and
        // y″ = −16·e^(−π) at the top, from the step without feed-forward above.
        let late = 0.25 * 50.0 * SAMPLE_S * 16.0;
        let exact = 1.0 + (1.0 + late) * (-std::f64::consts::PI).exp();
        assert!((most - exact).abs() < 2e-4, "{most} {exact}");
    }

    /// As printed, s³ + 6s² + c·s + c with c = 16·Kp²: a pole at −1/(1 − 5/c + …). With only the leading Kp put back
    /// Routh asks for 6·c > c·Kp, which no printed gain keeps.
    #[test]
    fn the_printed_hpc_creeps_or_is_unstable() {
        for kp in [33.0_f64, 51.0, 75.0] {
            let slowest = printed_hpc_pole_per_s(kp, 0);
            assert!((-1.001..-0.999).contains(&slowest), "{slowest}");
            assert!(printed_hpc_pole_per_s(kp, 1) > 0.0);
        }
        assert!(printed_hpc_pole_per_s(5.9, 1) < 0.0 && printed_hpc_pole_per_s(6.1, 1) > 0.0);
    }
}
