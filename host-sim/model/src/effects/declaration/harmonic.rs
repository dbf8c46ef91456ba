//! What harmonic effects share: amplitude·sin(2π·position/period + phase).

use std::f64::consts::TAU;

use super::Coordinate;

/// sin(2π·position/period + phase), position and period in the same unit.
#[must_use]
pub fn wave(position_mm: f64, period_mm: f64, phase_rad: f64) -> f64 {
    (TAU * position_mm / period_mm + phase_rad).sin()
}

/// The periods of the first orders of a fundamental period.
pub fn periods(fundamental_mm: f64, highest_order: u32) -> impl Iterator<Item = f64> {
    (1..=highest_order).map(move |order| fundamental_mm / f64::from(order))
}

/// Sine and cosine part of a harmonic: the coordinates in which the model is linear.
#[must_use]
pub fn parts(amplitude: f64, phase_rad: f64, step: f64, limit: f64) -> Vec<Coordinate> {
    vec![
        Coordinate::signed(amplitude * phase_rad.cos(), step, limit),
        Coordinate::signed(amplitude * phase_rad.sin(), step, limit),
    ]
}

/// Amplitude (not negative) and phase (−π to π) of the parts that [`parts`] gave.
#[must_use]
pub fn polar(parts: &[f64]) -> (f64, f64) {
    (parts[0].hypot(parts[1]), parts[1].atan2(parts[0]))
}
