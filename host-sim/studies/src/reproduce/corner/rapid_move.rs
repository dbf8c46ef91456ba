//! Table 1: each axis at its rapid speed, with its printed acceleration.

use super::machine::{ACCELERATION_M_PER_S2, RAPID_M, RAPID_M_PER_S, Tuning, rapid};
use crate::reproduce::study::ReproduceError;

/// Speed (m/s) and acceleration (m/s²) that an axis reaches in a rapid move: the mean speed over the last 40 % of the
/// constant-speed section, and the slope of the speed over the second half of the ramp.
///
/// # Errors
/// If the simulation fails.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand samples")]
pub fn reached(tuning: Tuning, axis: usize) -> Result<[f64; 2], ReproduceError> {
    let motion = rapid(tuning, axis)?;
    let motor = if axis == 0 { &motion.motor.x_m } else { &motion.motor.y_m };
    let command = if axis == 0 { &motion.command.x_m } else { &motion.command.y_m };
    let start = command.iter().take_while(|m| (**m - command[0]).abs() < 1e-9).count();
    let ramp_s = RAPID_M_PER_S / ACCELERATION_M_PER_S2[axis];
    let at = |seconds: f64| start + (seconds / motion.sample_s).round() as usize;
    let speed = |from: usize, to: usize| (motor[to] - motor[from]) / ((to - from) as f64 * motion.sample_s);
    // After half the ramp, 42 ms, the loop has settled: 2 · 75 1/s · 42 ms = 6 time constants.
    let (from, to) = (at(0.5 * ramp_s), at(ramp_s));
    let middle = usize::midpoint(from, to);
    let acceleration =
        (speed(middle, to) - speed(from, middle)) / (0.5 * (to - from) as f64 * motion.sample_s);
    let constant_speed_s = (RAPID_M - RAPID_M_PER_S * ramp_s) / RAPID_M_PER_S;
    Ok([speed(at(ramp_s + 0.6 * constant_speed_s), at(ramp_s + constant_speed_s)), acceleration])
}
