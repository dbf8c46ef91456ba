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

/// What every harmonic effect declares in the same way: its parameters (amplitude in the unit given, `period_mm`,
/// `phase_rad`), the coordinates with the step and limit of the amplitude, and that its period tells it from others.
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
