//! Common part of harmonic effects: amplitude·sin(2π·position/period + phase).

use std::f64::consts::{PI, TAU};

use super::{Coordinate, EffectContext, Found, WaveOf};

/// sin(2π·position/period + phase).
#[must_use]
pub fn wave(position_mm: f64, period_mm: f64, phase_rad: f64) -> f64 {
    libm::sin(TAU * position_mm / period_mm + phase_rad)
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

    /// The error with the opposite sign.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self { phase_rad: self.phase_rad + PI, ..self }
    }

    /// Whether the period is no whole fraction of the lead (mm).
    #[must_use]
    pub fn has_own_period(&self, lead_mm: Option<f64>) -> bool {
        lead_mm.is_none_or(|lead_mm| {
            let order = lead_mm / self.period_mm;
            (order - order.round()).abs() > 1e-6 * order
        })
    }
}

/// Periods of the harmonics from order 1 to the highest order.
pub fn periods(fundamental_mm: f64, highest_order: u32) -> impl Iterator<Item = f64> {
    (1..=highest_order).map(move |order| fundamental_mm / f64::from(order))
}

/// Highest order of which a period found in a residual may be.
const HIGHEST_FOUND_ORDER: f64 = 60.0;

/// Two periods are the same if their numbers of waves over the travel differ by less than this: a peak of a spectrum over
/// the travel is one wave wide, and its centre is known to a fraction of that.
const SAME_WAVES: f64 = 0.25;

/// Largest change of a period by the fit, in waves over the travel: half the width of a peak. A period that leaves it is no
/// longer that of the wave that was found.
const PEAK_WAVES: f64 = 0.5;

/// A harmonic with which a fit starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HarmonicGuess {
    /// Period, mm.
    pub period_mm: f64,
    /// Amplitude of the wave in the residual; zero for an order that is tried in any case.
    pub amplitude: f64,
    /// Phase of this wave.
    pub phase_rad: f64,
    /// The range in which the period is fitted, as it is no order of the fundamental one, mm.
    pub fitted_period_mm: Option<[f64; 2]>,
}

/// The order of a fundamental period that a period is, as far as waves over the travel tell; all in mm. `None`: it is none.
#[must_use]
pub fn order(period_mm: f64, fundamental_mm: f64, travel_mm: f64) -> Option<f64> {
    let order = (fundamental_mm / period_mm).round();
    let waves = [period_mm, fundamental_mm / order].map(|mm| travel_mm / mm);
    let is_order = (1.0..=HIGHEST_FOUND_ORDER).contains(&order) && (waves[0] - waves[1]).abs() < SAME_WAVES;
    is_order.then_some(order)
}

/// The harmonics of a fundamental period (mm) from order 1 to the highest order, and the waves found in a residual: with the
/// period of their order, if they have one above the highest, or with a period of their own.
#[must_use]
pub fn guesses(
    context: &EffectContext<'_>,
    of: WaveOf,
    fundamental_mm: Option<f64>,
    highest_order: u32,
) -> Vec<HarmonicGuess> {
    let still =
        |period_mm| HarmonicGuess { period_mm, amplitude: 0.0, phase_rad: 0.0, fitted_period_mm: None };
    let orders = fundamental_mm.into_iter().flat_map(|mm| periods(mm, highest_order)).map(still);
    let travel_mm = context.travel_mm[1] - context.travel_mm[0];
    let found = context.residual.waves.iter().filter(|wave| wave.of == of).filter_map(|wave| {
        let of_order = fundamental_mm.and_then(|mm| Some((mm, order(wave.period_mm, mm, travel_mm)?)));
        let is_tried = of_order.is_some_and(|(_, order)| order <= f64::from(highest_order));
        (!is_tried).then_some(HarmonicGuess {
            period_mm: of_order.map_or(wave.period_mm, |(mm, order)| mm / order),
            amplitude: wave.amplitude,
            phase_rad: wave.phase_rad,
            fitted_period_mm: of_order.is_none().then(|| {
                let waves = travel_mm / wave.period_mm;
                [waves + PEAK_WAVES, waves - PEAK_WAVES].map(|waves| travel_mm / waves)
            }),
        })
    });
    orders.chain(found).collect()
}

/// A found wave of one part as that of another one, whose fundamental period is given, mm; its sign is reversed. Both are waves of
/// table − motor with the same size: table − reading is the error of the screw, or minus that of the resolver. They differ by the force
/// that the closed loop applies, which is small beside what other effects left when the wave was added. `None`: no wave.
#[must_use]
pub fn of_other_part(found: &Found<'_>, fundamental_mm: f64) -> Option<HarmonicGuess> {
    let [amplitude, period_mm, phase_rad] =
        [found.value("amplitude_um")?, found.value("period_mm")?, found.value("phase_rad")?];
    let (period_mm, fitted_period_mm) = match order(period_mm, fundamental_mm, found.travel_mm) {
        Some(order) => (fundamental_mm / order, None),
        // The period is the coordinate after those of sine and cosine.
        None => (period_mm, found.coordinates.get(2).map(|period| [period.lower, period.upper])),
    };
    Some(HarmonicGuess { period_mm, amplitude, phase_rad: phase_rad + PI, fitted_period_mm })
}

/// The coordinate of a period that is fitted within a range, mm.
#[must_use]
pub fn period(period_mm: f64, [lower, upper]: [f64; 2]) -> Coordinate {
    Coordinate::between(period_mm, 1e-5 * period_mm, lower, upper)
}

/// Coefficients of sine and cosine, amplitude·cos(phase) and amplitude·sin(phase). The model is linear in them.
#[must_use]
pub fn parts(amplitude: f64, phase_rad: f64, step: f64, limit: f64) -> Vec<Coordinate> {
    vec![
        Coordinate::signed(amplitude * libm::cos(phase_rad), step, limit),
        Coordinate::signed(amplitude * libm::sin(phase_rad), step, limit),
    ]
}

/// Amplitude (not negative) and phase (−π to π) of the coefficients of [`parts`].
#[must_use]
pub fn polar(parts: &[f64]) -> (f64, f64) {
    (libm::hypot(parts[0], parts[1]), libm::atan2(parts[1], parts[0]))
}

/// Items of [`EffectModel`](super::EffectModel) that are the same for all harmonic effects: the parameters (amplitude in
/// the given unit, `period_mm`, `phase_rad`), the coordinates with the given step and limit of the amplitude (and the
/// period, within the range in the given field, if there is one), and the period as distinction.
macro_rules! harmonic_effect {
    ($amplitude:ident, $unit:expr, step $step:literal, limit $limit:literal $(, period $range:ident)?) => {
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
            let parts = super::declaration::harmonic::parts(self.$amplitude, self.phase_rad, $step, $limit);
            $(if let Some(range) = self.$range {
                let period = super::declaration::harmonic::period(self.period_mm, range);
                return [parts, vec![period]].concat();
            })?
            parts
        }

        fn at(&self, x: &[f64]) -> Self {
            let (amplitude, phase_rad) = super::declaration::harmonic::polar(x);
            let moved = Self { $amplitude: amplitude, phase_rad, ..self.clone() };
            $(if self.$range.is_some() {
                return Self { period_mm: x[2], ..moved };
            })?
            moved
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Settings;
    use crate::effects::{ResidualShape, ResidualWave, Stage};
    use shared::config::Rates;

    #[test]
    fn without_a_lead_every_period_is_its_own() {
        let error = PeriodicError { amplitude_um: 1.0, period_mm: 20.0, phase_rad: 0.0 };
        assert!(error.has_own_period(None) && !error.has_own_period(Some(20.0)));
    }

    /// Over a travel of 300 mm, waves of 37 mm (belt), 3.205 mm (93.60 waves; a fifth of a lead of 16 mm: 93.75), 8 mm (an order
    /// that is tried in any case), and 3.3 mm (90.9 waves, far from 93.75).
    #[test]
    fn a_wave_is_an_order_or_has_a_period_of_its_own() {
        let wave = |period_mm| ResidualWave { of: WaveOf::Table, period_mm, amplitude: 2.0, phase_rad: 0.5 };
        let residual =
            ResidualShape { waves: [37.0, 3.205, 8.0, 3.3].map(wave).to_vec(), ..ResidualShape::default() };
        let context = EffectContext {
            axis: &Settings::default(),
            logged: super::super::LoggedChannels::ALL,
            first: true,
            others: &[],
            stages: &[Stage::Table],
            travel_mm: [-100.0, 200.0],
            effects: &[],
            residual: &residual,
        };
        let of = |of, lead_mm| {
            let guesses = guesses(&context, of, lead_mm, 2).into_iter();
            guesses.map(|guess| (guess.period_mm, guess.fitted_period_mm.is_some())).collect::<Vec<_>>()
        };
        let expected = [(16.0, false), (8.0, false), (37.0, true), (3.2, false), (3.3, true)];
        assert_eq!(of(WaveOf::Table, Some(16.0)), expected);
        assert_eq!(of(WaveOf::Table, None), [(37.0, true), (3.205, true), (8.0, true), (3.3, true)]);
        assert_eq!(of(WaveOf::Force, Some(16.0)), expected[..2]);
    }

    /// On a lead of 16 mm, 4 mm are an electrical period of four pole pairs: a wave of 16 mm is no order of it, one of 4 mm the first.
    /// Over a travel of 120 mm, 16.02 mm is a turn: a quarter of a wave is 0.53 mm.
    #[test]
    fn a_wave_of_another_part_keeps_its_period_or_takes_that_of_an_order() {
        let axis = Settings::default();
        let rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 4 };
        let other = |period_mm: f64, fitted_mm: Option<[f64; 2]>, fundamental_mm: f64| {
            let mut coordinates = parts(5.0, 0.5, 0.1, 1e3);
            coordinates.extend(fitted_mm.map(|range| period(period_mm, range)));
            let parameters = vec![("amplitude_um", 5.0), ("period_mm", period_mm), ("phase_rad", 0.5)];
            let found =
                Found { name: "", parameters, coordinates, mode: None, axis: &axis, rates, travel_mm: 120.0 };
            let wave = of_other_part(&found, fundamental_mm).unwrap();
            assert_eq!((wave.amplitude, wave.phase_rad), (5.0, 0.5 + PI));
            (wave.period_mm, wave.fitted_period_mm)
        };
        let around = Some([15.5, 16.5]);
        assert_eq!(other(16.02, around, 4.0), (16.02, around));
        assert_eq!(other(16.02, around, 16.0), (16.0, None));
        assert_eq!(other(4.01, Some([3.9, 4.1]), 4.0), (4.0, None));
    }
}
