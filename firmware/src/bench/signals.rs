//! Sine and cosine of the encoder of the x motor: a period has 400 counts.

use shared::figures::EncoderSignals;
use shared::interpolate::sincos::sin_cos;
use shared::units::{PER_NM, Position};

/// A period of the signals, position units: 20 µm.
const PERIOD: i64 = 20_000 * PER_NM;

/// Amplitude, counts of a converter of 12 bits.
const AMPLITUDE: i32 = 1430;

/// Least and greatest amplitude of good signals, counts.
const LIMITS: [u16; 2] = [1050, 1950];

/// The signals at a reading from power-up.
#[must_use]
pub fn signals(reading: Position) -> EncoderSignals {
    let phase = reading.0.rem_euclid(PERIOD).unsigned_abs() * (u64::MAX / PERIOD.unsigned_abs());
    let (sine, cosine) = sin_cos(phase);
    // 62 fraction bits, of which 30 remain for the product.
    #[expect(clippy::cast_possible_truncation, reason = "at most the amplitude")]
    let counts = |part: i64| (((part >> 32) * i64::from(AMPLITUDE) + (1 << 29)) >> 30) as i32;
    EncoderSignals { sine: counts(sine), cosine: counts(cosine), limits: LIMITS }
}
