//! Common part of harmonic effects: amplitude·sin(2π·position/period + phase).

use std::f64::consts::TAU;

use super::Coordinate;

/// sin(2π·position/period + phase).
#[must_use]
pub fn wave(position_mm: f64, period_mm: f64, phase_rad: f64) -> f64 {
    (TAU * position_mm / period_mm + phase_rad).sin()
}

/// A periodic error of a position: amplitude·sin(2π·position/period + phase).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeriodicError {
    /// Half of the peak-to-peak value.
    pub amplitude_um: f64,
    /// Period.
    pub period_mm: f64,
    /// Phase at position zero.
    pub phase_rad: f64,
}

impl PeriodicError {
    /// The error at a position, both in m.
    #[must_use]
    pub fn error_m(&self, position_m: f64) -> f64 {
        1e-6 * self.amplitude_um * wave(1e3 * position_m, self.period_mm, self.phase_rad)
    }
}

/// Periods of the harmonics from order 1 to the highest order.
pub fn periods(fundamental_mm: f64, highest_order: u32) -> impl Iterator<Item = f64> {
    (1..=highest_order).map(move |order| fundamental_mm / f64::from(order))
}

/// Coefficients of sine and cosine, amplitude·cos(phase) and amplitude·sin(phase). The model is linear in them.
#[must_use]
pub fn parts(amplitude: f64, phase_rad: f64, step: f64, limit: f64) -> Vec<Coordinate> {
    vec![
        Coordinate::signed(amplitude * phase_rad.cos(), step, limit),
        Coordinate::signed(amplitude * phase_rad.sin(), step, limit),
    ]
}

/// Amplitude (not negative) and phase (−π to π) of the coefficients of [`parts`].
#[must_use]
pub fn polar(parts: &[f64]) -> (f64, f64) {
    (parts[0].hypot(parts[1]), parts[1].atan2(parts[0]))
}

/// Items of [`EffectModel`](super::EffectModel) that are the same for all harmonic effects: the parameters (amplitude in
/// the given unit, `period_mm`, `phase_rad`), the coordinates with the given step and limit of the amplitude, and the
/// period as distinction.
macro_rules! harmonic_effect {
    ($amplitude:ident, $unit:expr, step $step:literal, limit $limit:literal) => {
        const PARAMETERS: &'static [super::declaration::Parameter] = &[
            super::declaration::Parameter::new(
                stringify!($amplitude),
                $unit,
                super::declaration::Range::Signed,
            ),
            super::declaration::Parameter::new(
                "period_mm",
                super::declaration::Unit::Millimetre,
                super::declaration::Range::Positive,
            ),
            super::declaration::Parameter::phase("phase_rad"),
        ];
        const OCCURRENCE: super::declaration::Occurrence = super::declaration::Occurrence::Repeated;

        fn coordinates(&self) -> Vec<super::declaration::Coordinate> {
            super::declaration::harmonic::parts(self.$amplitude, self.phase_rad, $step, $limit)
        }

        fn at(&self, x: &[f64]) -> Self {
            let (amplitude, phase_rad) = super::declaration::harmonic::polar(x);
            Self { $amplitude: amplitude, phase_rad, ..self.clone() }
        }

        fn values(&self) -> Vec<f64> {
            vec![self.$amplitude, self.period_mm, self.phase_rad]
        }

        fn distinction(&self) -> super::declaration::Distinction<'_> {
            super::declaration::Distinction::Period(self.period_mm)
        }

        fn abscissa(&self) -> super::declaration::Abscissa {
            super::declaration::Abscissa::WithinPeriod(self.period_mm)
        }
    };
}

pub(in crate::effects) use harmonic_effect;
