//! Waves that a pitch map leaves between its knots, and that are no effect of their own.

use model::effects::Effect;

/// Largest amplitude of a remainder, as a fraction of the map's peak-to-peak error. A cubic spline with knots at the distance h
/// leaves at most 5/384·(2πh/P)⁴ of a wave of the period P (C. A. Hall and W. W. Meyer, 1976): 8 % with four knots a wave.
const MAX_FRACTION: f64 = 0.02;

/// Amplitude and period of a wave over the position of the screw.
fn wave(effect: &Effect) -> Option<[f64; 2]> {
    match effect {
        Effect::PitchCyclic(wave) => Some([wave.amplitude_um, wave.period_mm]),
        Effect::ResolverDividing(wave) => Some([wave.amplitude_um, wave.period_mm]),
        Effect::EncoderEllipticity(wave) => Some([wave.amplitude_um, wave.period_mm]),
        _ => None,
    }
}

/// Whether an effect is a wave, longer than half the distance of the knots, that is no larger than what a map of the same screw
/// leaves between its knots: a remainder that is zero at the knots, with the period of their distance, times the wave of the screw.
#[must_use]
pub fn is_remainder_of_map(effect: &Effect, found: &[Effect]) -> bool {
    let Some([amplitude_um, period_mm]) = wave(effect) else { return false };
    found.iter().any(|other| {
        let Effect::PitchMap(map) = other else { return false };
        let spacing_mm = map.positions_mm.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        let size_um = numerics::peak_to_peak(map.error_um.iter().copied());
        period_mm > 0.5 * spacing_mm && amplitude_um.abs() < MAX_FRACTION * size_um
    })
}

/// Whether an effect is a wave whose period is no whole fraction of the lead: beside a map it describes the map's remainder.
#[must_use]
pub fn is_wave_of_own_period(effect: &Effect, lead_mm: Option<f64>) -> bool {
    let Some([_, period_mm]) = wave(effect) else { return false };
    lead_mm.is_none_or(|lead_mm| {
        let order = lead_mm / period_mm;
        (order - order.round()).abs() > 1e-6 * order
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::{PitchCyclic, PitchMap, ResolverDividing};

    fn map() -> Effect {
        let positions_mm: Vec<f64> = (0..10).map(|i| 12.0 * f64::from(i)).collect();
        let error_um = positions_mm.iter().map(|mm| 2.0 * (0.1 * mm).sin()).collect();
        Effect::PitchMap(PitchMap { positions_mm, error_um, error_negative_um: None })
    }

    fn screw(amplitude_um: f64, period_mm: f64) -> Effect {
        Effect::PitchCyclic(PitchCyclic { amplitude_um, period_mm, phase_rad: 0.0, fitted_period_mm: None })
    }

    /// 2 % of a map of 4 µm peak to peak (3.9 at its knots) are 0.08 µm; its knots are 12 mm apart.
    #[test]
    fn a_small_long_wave_beside_a_map_is_its_remainder() {
        let found = [map()];
        assert!(
            is_remainder_of_map(&screw(0.02, 16.0), &found)
                && is_remainder_of_map(&screw(-0.07, 16.0), &found)
                && is_remainder_of_map(&screw(0.02, 10.0), &found)
        );
        assert!(!is_remainder_of_map(&screw(0.09, 16.0), &found), "larger than what a map leaves");
        assert!(!is_remainder_of_map(&screw(0.02, 5.0), &found), "shorter than half the distance");
        assert!(!is_remainder_of_map(&screw(0.02, 16.0), &[]), "no map");
    }

    #[test]
    fn a_resolver_has_fractions_of_the_lead() {
        let resolver = |period_mm| {
            let phase_rad = 0.0;
            Effect::ResolverDividing(ResolverDividing {
                amplitude_um: 1.0,
                period_mm,
                phase_rad,
                fitted_period_mm: None,
            })
        };
        assert!(
            is_wave_of_own_period(&resolver(17.27), Some(20.0))
                && is_wave_of_own_period(&screw(1.0, 7.0), Some(20.0))
        );
        assert!(
            !is_wave_of_own_period(&resolver(4.0), Some(20.0))
                && !is_wave_of_own_period(&screw(1.0, 20.0), Some(20.0))
        );
    }
}
