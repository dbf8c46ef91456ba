//! The cogging of a motor: a force that repeats with the position of the motor.

use shared::interpolate::sincos::{SINE_STEPS, sine_q14};

use super::axis::LEAD;

/// amplitude·sin(2π·order·motor/lead + phase), with the position of the motor from the homed zero.
#[derive(Clone, Copy, Debug)]
pub struct CoggingWave {
    /// Periods per turn of the screw.
    pub order: u8,
    /// Half of the peak-to-peak value, N.
    pub amplitude_n: f32,
    /// Phase at zero, 1/[`SINE_STEPS`] of a turn.
    pub phase_steps: u16,
}

/// The cogging of the x motor, once it is switched on: 8 N with four periods per turn, and their second harmonic. Together they are below the
/// friction of the table, so that an axis without drives stands.
pub const COGGING: [CoggingWave; 2] = [
    CoggingWave { order: 4, amplitude_n: 8.0, phase_steps: SINE_STEPS / 8 },
    CoggingWave { order: 8, amplitude_n: 3.0, phase_steps: SINE_STEPS / 3 },
];

/// Force of the cogging on a motor at a position (position units), N.
pub(super) fn force_n(motor: i64) -> f32 {
    let turn = motor.rem_euclid(LEAD) as f32 / LEAD as f32;
    let wave = |wave: &CoggingWave| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to the order times 8192"
        )]
        let steps = (turn * f32::from(wave.order) * f32::from(SINE_STEPS)) as u32;
        #[expect(clippy::cast_possible_truncation, reason = "modulo whole turns")]
        let step = (steps + u32::from(wave.phase_steps)) as u16 % SINE_STEPS;
        wave.amplitude_n * sine_q14(step) as f32 / 16_384.0
    };
    COGGING.iter().map(wave).sum()
}
