//! Where a measured motor has been between its samples: what the driven mechanics are given.
//!
//! It does not hang on the model, so it is made once a log and not in each of the simulations of a fit.

use super::signals::Smooth;

/// Longest step of the driven table, s.
const LONGEST_STEP_S: f64 = 5e-4;

/// Sharpness of the motor's own friction, m/s (the contract's tanh(v/0.2 mm/s)).
const SIGN_WIDTH_M_PER_S: f64 = 0.2e-3;

/// A motor's path in steps of equal length.
#[derive(Clone, Debug)]
pub struct MotorPath {
    /// Length of a step, s.
    pub step_s: f64,
    /// Steps from one sample to the next.
    pub steps: usize,
    /// The first sample, then every step after it.
    pub points: Vec<Point>,
    /// Reading − the place that the mechanics are given, m, at each sample.
    pub held_back_m: Vec<f64>,
    /// Smoothed sign of the velocity, −1 to 1, at each sample.
    pub sign: Vec<f64>,
}

/// Place and acceleration of the motor's reading.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// m.
    pub reading_m: f64,
    /// m/s².
    pub acceleration: f64,
}

impl MotorPath {
    /// Of a motor reading.
    ///
    /// Sensor noise must not wear the bristles of a guide straight while the axis stands: the mechanics see the motor
    /// through a play of that width, and the table is given what the play held back.
    #[must_use]
    pub fn new(motor: &Smooth, sample_s: f64) -> Self {
        let n = motor.position.len();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a handful")]
        let steps = (sample_s / LONGEST_STEP_S).ceil().max(1.0) as usize;
        let play_m = 1.5 * motor.noise;
        let mut points = Vec::with_capacity(n * steps);
        let mut held_back_m = Vec::with_capacity(n);
        let mut reading_m = motor.position.first().copied().unwrap_or(0.0);
        for i in 0..n {
            for step in 1..=(if i == 0 { 0 } else { steps }) {
                let fraction = step as f64 / steps as f64;
                let seen_m = motor.between(i - 1, fraction, sample_s);
                reading_m = reading_m.clamp(seen_m - play_m, seen_m + play_m);
                let [before, after] = [motor.acceleration[i - 1], motor.acceleration[i]];
                points.push(Point { reading_m, acceleration: before + fraction * (after - before) });
            }
            if i == 0 {
                points.push(Point { reading_m, acceleration: motor.acceleration[0] });
            }
            held_back_m.push(motor.position[i] - reading_m);
        }
        let sign = motor.velocity.iter().map(|v| (v / SIGN_WIDTH_M_PER_S).tanh()).collect();
        Self { step_s: sample_s / steps as f64, steps, points, held_back_m, sign }
    }
}
