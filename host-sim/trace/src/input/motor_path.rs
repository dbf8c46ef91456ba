//! The measured motor position between the samples: the input of the driven mechanics.
//!
//! It does not depend on the model and is therefore computed once per log, not in each simulation of a fit.

use super::smoothing::Smooth;
use super::table_motions::TableMotions;
use plant::friction::smoothed_sign;

/// Longest step of the driven table, s.
const MAX_STEP_S: f64 = 1e-3;

/// Motion of a motor in steps of equal duration.
#[derive(Clone, Debug)]
pub struct MotorPath {
    /// Duration of a step, s.
    pub step_s: f64,
    /// Number of steps from one sample to the next.
    pub steps: usize,
    /// The first sample, then the ends of all steps.
    pub points: Vec<Point>,
    /// Smoothed sign of the velocity, −1 to 1, at each sample.
    pub sign: Vec<f64>,
    /// Motions of the table behind this path that were computed last.
    pub table_motions: TableMotions,
}

/// Reading of the motor encoder and its acceleration.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Reading, m.
    pub reading_m: f64,
    /// Acceleration, m/s².
    pub acceleration: f64,
}

impl MotorPath {
    /// The path of a motor encoder.
    ///
    /// The reading passes a play of ±`play_noise` standard deviations of its noise. Otherwise noise would relax the bristles
    /// of the guide's friction during a standstill.
    #[must_use]
    pub fn new(motor: &Smooth, play_noise: f64, sample_s: f64) -> Self {
        let play_m = play_noise * motor.noise;
        let per_sample = (sample_s / MAX_STEP_S).ceil().max(1.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a handful")]
        let steps = per_sample as usize;
        let mut points = Vec::with_capacity(motor.value.len() * steps);
        let mut reading_m = motor.value.first().copied().unwrap_or(0.0);
        points.extend(motor.acceleration.first().map(|&acceleration| Point { reading_m, acceleration }));
        for i in 1..motor.value.len() {
            let [before, after] = [motor.acceleration[i - 1], motor.acceleration[i]];
            for step in 1..=steps {
                let fraction = step as f64 / per_sample;
                let position_m = motor.between(i - 1, fraction, sample_s);
                reading_m = reading_m.clamp(position_m - play_m, position_m + play_m);
                points.push(Point { reading_m, acceleration: before + fraction * (after - before) });
            }
        }
        let sign = motor.velocity.iter().map(|&velocity| smoothed_sign(velocity)).collect();
        Self { step_s: sample_s / per_sample, steps, points, sign, table_motions: TableMotions::default() }
    }
}
