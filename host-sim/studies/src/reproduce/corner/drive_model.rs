//! The model of the paper's section 2: command → feed-forward → position law → velocity loop → motor → table.
//!
//! - Feed-forward: equation (2), 1 + (Kf/Kp)·s.
//! - Position law: P, or equation (1) with its missing Kp restored (see `shared::control::hpc`).
//! - Velocity loop: PI on one rigid mass as in the controller, v′ = ωv·(e + ∫e dt/Ti) with ωv = Kv/mass. The paper's
//!   figure 2 is missing from the scan.
//! - Table: equation (3), ω²/(s² + 2ζωs + ω²).
//!
//! The model has no friction, backlash or pitch errors; these make the difference to the plant.
//!
//! The equations are linear, and the input is constant or a ramp between two samples: the matrix exponential gives
//! exact steps.

use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector4};

use model::axis::{Law, Settings};

/// Printed coefficients k1·k2 and k2 of equation (1), with k1 = 8/3.
const HPC: [f64; 2] = [16.0, 6.0];

/// PI velocity loop on a rigid mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityLoop {
    /// ωv = Kv/mass, 1/s.
    pub bandwidth_per_s: f64,
    /// Integral time Ti.
    pub integral_time_s: f64,
}

impl VelocityLoop {
    /// From the declared values of an axis.
    #[must_use]
    pub fn from_axis(axis: &Settings) -> Self {
        let mass_kg =
            axis.mechanics.motor_mass_kg.unwrap_or(0.0) + axis.mechanics.table_mass_kg.unwrap_or(0.0);
        Self {
            bandwidth_per_s: axis.controller.velocity_gain_n_s_per_m.unwrap_or(0.0) / mass_kg,
            integral_time_s: axis.controller.velocity_integral_time_s.unwrap_or(f64::INFINITY),
        }
    }
}

/// From command to motor, one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// Position law: P or HPC.
    pub law: Law,
    /// Position gain Kp.
    pub gain_per_s: f64,
    /// Feed-forward Kf.
    pub feedforward_percent: f64,
    /// The inner loop.
    pub velocity: VelocityLoop,
}

/// System matrix. States: filtered error, its rate divided by Kp, motor position, motor velocity, integral of the velocity
/// error divided by Ti, and the input, which is constant.
type Loop = SMatrix<f64, 6, 6>;

impl Servo {
    /// Matrix A of the loop x′ = A·x.
    #[must_use]
    pub fn system(&self) -> Loop {
        let (kp, VelocityLoop { bandwidth_per_s, integral_time_s }) = (self.gain_per_s, self.velocity);
        let mut a = Loop::zeros();
        // Commanded velocity as a row over the states.
        let mut velocity = [0.0; 6];
        match self.law {
            Law::P => (velocity[2], velocity[5]) = (-kp, kp),
            Law::Hpc => {
                velocity[0] = kp;
                a[(0, 1)] = kp;
                (a[(1, 0)], a[(1, 1)]) = (-HPC[0] * kp, -HPC[1] * kp);
                (a[(1, 2)], a[(1, 5)]) = (-HPC[0] * kp, HPC[0] * kp);
            }
        }
        a[(2, 3)] = 1.0;
        for (column, weight) in velocity.into_iter().enumerate() {
            a[(3, column)] = bandwidth_per_s * weight;
            a[(4, column)] = weight / integral_time_s;
        }
        a[(3, 3)] -= bandwidth_per_s;
        a[(3, 4)] += bandwidth_per_s;
        a[(4, 3)] -= 1.0 / integral_time_s;
        a
    }

    /// Motor positions for commands (both m), one sample apart, starting at rest.
    #[must_use]
    pub fn motor_m(&self, command_m: &[f64], sample_s: f64) -> Vec<f64> {
        let step = (self.system() * sample_s).exp();
        let lead_s = 1e-2 * self.feedforward_percent / self.gain_per_s;
        let origin = command_m.first().copied().unwrap_or(0.0);
        let mut state = SVector::<f64, 6>::zeros();
        let mut previous = origin;
        command_m
            .iter()
            .map(|&command| {
                let motor = origin + state[2];
                state[5] = command - origin + lead_s * (command - previous) / sample_s;
                previous = command;
                state = step * state;
                motor
            })
            .collect()
    }
}

/// From motor to table, one axis: equation (3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mechanics {
    /// Natural frequency ωi, rad/s.
    pub omega_per_s: f64,
    /// Damping ratio ζi.
    pub damping_ratio: f64,
}

impl Mechanics {
    /// Table positions for motor positions (both m), one sample apart, starting at rest.
    #[must_use]
    pub fn table_m(&self, motor_m: &[f64], sample_s: f64) -> Vec<f64> {
        let (stiffness, damping) = (self.omega_per_s.powi(2), 2.0 * self.damping_ratio * self.omega_per_s);
        // States: table, its velocity, motor, its velocity.
        #[rustfmt::skip]
        let system = Matrix4::new(
            0.0, 1.0, 0.0, 0.0,
            -stiffness, -damping, stiffness, 0.0,
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

/// Maximum real part of the poles, 1/s, of a loop with an integrator and equation (1) as printed,
/// Kpⁿ·k1k2Kp²/(s² + k2·s + k1k2Kp²). `leading_power` is n: 0 as printed, 1 with the leading Kp restored.
#[must_use]
pub fn printed_hpc_pole_per_s(gain_per_s: f64, leading_power: i32) -> f64 {
    let c = HPC[0] * gain_per_s.powi(2);
    let closed = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -c * gain_per_s.powi(leading_power), -c, -HPC[1]);
    numerics::max(closed.complex_eigenvalues().iter().map(|pole| pole.re))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLE_S: f64 = 2.5e-4;

    fn servo(law: Law, feedforward_percent: f64) -> Servo {
        // A velocity loop with a lag of only 1 µs.
        let velocity = VelocityLoop { bandwidth_per_s: 1e6, integral_time_s: 1e6 };
        Servo { law, gain_per_s: 50.0, feedforward_percent, velocity }
    }

    /// Response to a step of 1 m: time since the step (s) and motor position (m).
    fn step(servo: &Servo) -> impl Iterator<Item = (f64, f64)> {
        let command: Vec<f64> = std::iter::once(0.0).chain(std::iter::repeat_n(1.0, 800)).collect();
        let motor = servo.motor_m(&command, SAMPLE_S);
        motor.into_iter().skip(1).enumerate().map(|(k, y)| (k as f64 * SAMPLE_S, y))
    }

    /// P with an ideal velocity loop is a first-order lag of 1/Kp: 1 − e^(−Kp·t). The 1 µs of the velocity loop changes it
    /// by 50 ppm.
    #[test]
    fn p_is_a_first_order_lag() {
        for (t, y) in step(&servo(Law::P, 0.0)) {
            assert!((y - (1.0 - (-50.0 * t).exp())).abs() < 1e-4, "{t}: {y}");
        }
    }

    /// Closed loop with HPC: 16/((x + 2)(x² + 4x + 8)), x = s/Kp. Step response by partial fractions:
    /// 1 − 2·e^(−2τ) + e^(−2τ)·(cos 2τ − sin 2τ), τ = Kp·t.
    #[test]
    fn hpc_has_the_step_response_of_its_three_poles() {
        for (t, y) in step(&servo(Law::Hpc, 0.0)) {
            let tau = 50.0 * t;
            let exact = 1.0 + (-2.0 * tau).exp() * ((2.0 * tau).cos() - (2.0 * tau).sin() - 2.0);
            assert!((y - exact).abs() < 3e-4, "{t}: {y} {exact}");
        }
    }

    /// Equation (3) lags a ramp by 2ζ/ω, and overshoots a step by e^(−πζ/√(1 − ζ²)).
    #[test]
    fn the_table_is_a_second_order_system() {
        let mechanics = Mechanics { omega_per_s: 400.0, damping_ratio: 0.2 };
        let ramp: Vec<f64> = (0..2000).map(|k| 0.05 * f64::from(k) * SAMPLE_S).collect();
        let lag = ramp[1999] - mechanics.table_m(&ramp, SAMPLE_S)[1999];
        assert!((lag / (0.05 * 2.0 * 0.2 / 400.0) - 1.0).abs() < 1e-6, "{lag}");

        let mut step = vec![1.0; 400];
        step[0] = 0.0;
        let max = numerics::max(mechanics.table_m(&step, SAMPLE_S));
        let exact = 1.0 + (-std::f64::consts::PI * 0.2 / (1.0 - 0.04_f64).sqrt()).exp();
        // A maximum between two samples is missed by at most (ω·sample/2)²/2 of its height.
        assert!(max > exact - 1e-3 && max < exact + 1e-3, "{max} {exact}");
    }

    /// With 50 % of feed-forward the zero cancels the pole at −2: 8/(x² + 4x + 8) remains, with ζ = 1/√2 and an overshoot
    /// of e^(−π).
    #[test]
    fn hpc_with_half_feedforward_is_a_second_order_butterworth() {
        let max = numerics::max(step(&servo(Law::Hpc, 50.0)).map(|(_, y)| y));
        // The impulse of the lead is held for one sample and is thus half a sample late. This adds ½·(x/2)·|y″| with
        // x = Kp·sample, and y″ = −16·e^(−π) at the maximum, from the step response without feed-forward.
        let late = 0.25 * 50.0 * SAMPLE_S * 16.0;
        let exact = 1.0 + (1.0 + late) * (-std::f64::consts::PI).exp();
        assert!((max - exact).abs() < 2e-4, "{max} {exact}");
    }

    /// As printed, s³ + 6s² + c·s + c with c = 16·Kp² has a pole at −1/(1 − 5/c + …). With only the leading Kp restored the
    /// Routh criterion requires 6·c > c·Kp, which none of the printed gains satisfies.
    #[test]
    fn the_printed_hpc_is_too_slow_or_unstable() {
        for kp in [33.0_f64, 51.0, 75.0] {
            let slowest = printed_hpc_pole_per_s(kp, 0);
            assert!((-1.001..-0.999).contains(&slowest), "{slowest}");
            assert!(printed_hpc_pole_per_s(kp, 1) > 0.0);
        }
        assert!(printed_hpc_pole_per_s(5.9, 1) < 0.0 && printed_hpc_pole_per_s(6.1, 1) > 0.0);
    }
}
