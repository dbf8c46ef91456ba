//! Figures for people: what a board tells an operator and never uses itself.
//!
//! They are computed when a host asks for the state of the board, not in the tick, with the approximations of `micromath`: short code
//! and no table. All of them consist of additions, multiplications, divisions and operations on the bits of an f32, which the processor
//! of a host and that of a chip round in the same way, so that both compute the same bits. The section "Figures for people" of `docs/firmware.md` has the errors against
//! libm over the whole range of each figure.
//!
//! | figure | function |
//! |---|---|
//! | amplitude | [`square_root`] |
//! | level, dB | [`level_db`] |
//! | phase, degrees | [`phase_deg`] |
//! | natural logarithm, of a thermistor | [`logarithm`] |
//! | rms | [`rms`] |
//!
//! # Example
//!
//! ```
//! use shared::figures::{level_db, phase_deg, square_root};
//!
//! assert!((square_root(1480.0 * 1480.0) - 1480.0).abs() < 0.01);
//! assert!((level_db(0.5) + 6.02).abs() < 0.01);
//! assert!((phase_deg(1.0, 1.0) - 45.0).abs() < 0.2);
//! ```

mod rms_meter;
mod signals;
mod thermistor;

use micromath::F32;

pub use rms_meter::{AxisRms, LARGEST, RmsMeter};
pub use signals::{EncoderSignals, SignalFigures};
pub use thermistor::{Thermistor, ThermistorSettings};

/// Level of an amplitude of zero, dB; no level is lower.
pub const LEAST_LEVEL_DB: f32 = -120.0;

/// The root of a finite value; 0 for what is not above 0.
///
/// The approximation of `micromath` is at most 6 % too large; two steps of Heron, y ← (y + x/y)/2, square its relative error twice and halve it.
#[must_use]
#[inline(never)]
pub fn square_root(value: f32) -> f32 {
    if value > 0.0 {
        let mut root = F32(value).sqrt().0;
        for _ in 0..2 {
            root = 0.5 * (root + value / root);
        }
        root
    } else {
        0.0
    }
}

/// The natural logarithm of a value above 0; 0 for others.
///
/// Below 1 it is that of the reciprocal with the other sign, as `micromath` approximates a reciprocal by 12 %.
#[must_use]
#[inline(never)]
pub fn logarithm(value: f32) -> f32 {
    if value >= 1.0 {
        F32(value).ln().0
    } else if value > 0.0 {
        -F32(1.0 / value).ln().0
    } else {
        0.0
    }
}

/// The level of a ratio of amplitudes, dB: 20·log₁₀, and [`LEAST_LEVEL_DB`] for a ratio of at most 10⁻⁶.
#[must_use]
pub fn level_db(ratio: f32) -> f32 {
    if ratio > 1e-6 { 20.0 * core::f32::consts::LOG10_E * logarithm(ratio) } else { LEAST_LEVEL_DB }
}

/// The phase of a sine and a cosine, −180° to 180°; 0 if both are 0.
#[must_use]
#[inline(never)]
pub fn phase_deg(sine: f32, cosine: f32) -> f32 {
    if sine == 0.0 && cosine == 0.0 {
        return 0.0;
    }
    F32(sine).atan2(F32(cosine)).0 * (180.0 / core::f32::consts::PI)
}

/// The rms of a number of values whose squares have a sum; 0 for no value.
#[must_use]
pub fn rms(sum_of_squares: u64, values: u32) -> f32 {
    if values == 0 { 0.0 } else { square_root(sum_of_squares as f32 / values as f32) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the ends of the ranges, and beyond them: no figure is infinite or not a number.
    #[test]
    fn what_is_out_of_range_has_a_figure() {
        let all = |figures: &[f32], value: f32| figures.iter().all(|figure| (figure - value).abs() < 1e-9);
        assert!(all(&[square_root(0.0), square_root(-1.0), square_root(f32::NAN)], 0.0));
        assert_eq!(square_root(0.0).to_bits(), 0);
        assert!(all(&[logarithm(0.0), logarithm(-1.0), logarithm(f32::NAN), logarithm(1.0)], 0.0));
        assert!(all(&[level_db(0.0), level_db(1e-6), level_db(f32::NAN)], LEAST_LEVEL_DB));
        assert!(all(&[phase_deg(0.0, 0.0), phase_deg(0.0, 1.0), rms(0, 0), rms(0, 5)], 0.0));
        assert!((level_db(1.001e-6) - LEAST_LEVEL_DB).abs() < 0.02);
    }

    /// The four quadrants, and the axes between them.
    #[test]
    fn the_phase_is_that_of_its_quadrant() {
        for degrees in (-179..180).step_by(1) {
            let angle = f64::from(degrees).to_radians();
            #[expect(clippy::cast_possible_truncation, reason = "a test")]
            let phase = phase_deg((1000.0 * libm::sin(angle)) as f32, (1000.0 * libm::cos(angle)) as f32);
            assert!((f64::from(phase) - f64::from(degrees)).abs() < 0.3, "{degrees}: {phase}");
        }
    }
}
