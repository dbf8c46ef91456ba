//! Waves of the screw that were taken for waves of the resolver, and vice versa.
//!
//! Both are waves of table − motor with the same size. They differ by the force that the closed loop applies, which is small beside
//! what other effects left when the first of them was added. Once all effects are found, each wave is tried as that of the other
//! part.

use std::f64::consts::PI;

use super::replacement::better;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::Fitted;
use crate::fit::scope::Scope;
use model::axis::Settings;
use model::effects::{Effect, PitchCyclic, ResolverDividing, harmonic};

/// The fit in which each wave is an error of the screw or of the resolver, whichever explains the logs better.
#[must_use]
pub fn with_exchanged_waves(data: &FitData<'_>, mut base: Fitted, scope: &Scope) -> Fitted {
    let [lowest_mm, highest_mm] = data.travel_mm();
    for effect in base.model.found().to_vec() {
        let found = base.model.found();
        let Some(index) = found.iter().position(|other| *other == effect) else { continue };
        let other = of_other_part(&effect, &base.model.axis.settings, highest_mm - lowest_mm);
        let Some(other) = other else { continue };
        if scope.holds(&effect) && !found.iter().any(|found| found.is_same(&other)) {
            let start = base.model.without(index).with(other);
            base = better(data, base, &start, scope);
        }
    }
    base
}

/// The wave of the other part with the same size over the position: table − reading is the error of the screw, or minus that of the
/// resolver. `None`: no wave, or the machine has no such part.
fn of_other_part(effect: &Effect, settings: &Settings, travel_mm: f64) -> Option<Effect> {
    let lead_mm = settings.mechanics.lead_mm?;
    let period = |period_mm, fitted_period_mm, fundamental_mm| match harmonic::order(
        period_mm,
        fundamental_mm,
        travel_mm,
    ) {
        Some(order) => (fundamental_mm / order, None),
        None => (period_mm, fitted_period_mm),
    };
    match *effect {
        Effect::PitchCyclic(PitchCyclic { amplitude_um, period_mm, phase_rad, fitted_period_mm }) => {
            let electrical_mm = lead_mm / f64::from(settings.sensors.resolver_pole_pairs?);
            let (period_mm, fitted_period_mm) = period(period_mm, fitted_period_mm, electrical_mm);
            let phase_rad = phase_rad + PI;
            let wave = ResolverDividing { amplitude_um, period_mm, phase_rad, fitted_period_mm };
            Some(Effect::ResolverDividing(wave))
        }
        Effect::ResolverDividing(ref wave) => {
            let (period_mm, fitted_period_mm) = period(wave.period_mm, wave.fitted_period_mm, lead_mm);
            let (amplitude_um, phase_rad) = (wave.amplitude_um, wave.phase_rad + PI);
            Some(Effect::PitchCyclic(PitchCyclic { amplitude_um, period_mm, phase_rad, fitted_period_mm }))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With four pole pairs on a lead of 16 mm, a wave of 16 mm is no order of the resolver, one of 4 mm is its first and the fourth of
    /// the screw. Over a travel of 120 mm, 16.02 mm is a turn: a quarter of a wave is 0.53 mm.
    #[test]
    fn a_wave_keeps_its_period_or_takes_that_of_an_order() {
        let mut settings = Settings::default();
        settings.mechanics.lead_mm = Some(16.0);
        settings.sensors.resolver_pole_pairs = Some(4);
        let of_screw = |period_mm: f64, fitted_period_mm: Option<[f64; 2]>| {
            Effect::PitchCyclic(PitchCyclic {
                amplitude_um: 5.0,
                period_mm,
                phase_rad: 0.5,
                fitted_period_mm,
            })
        };
        let other = |effect: &Effect| of_other_part(effect, &settings, 120.0).unwrap();
        let values = |effect: &Effect| effect.values()[1];
        let around = Some([15.5, 16.5]);

        let of_resolver = other(&of_screw(16.02, around));
        assert_eq!((of_resolver.name(), values(&of_resolver)), ("resolver_dividing", 16.02));
        let back = other(&of_resolver);
        assert_eq!((back.name(), values(&back), back.coordinates().len()), ("pitch_cyclic", 16.0, 2));
        let electrical = other(&of_screw(4.01, Some([3.9, 4.1])));
        assert_eq!((values(&electrical), electrical.coordinates().len()), (4.0, 2));

        settings.sensors.resolver_pole_pairs = None;
        assert!(of_other_part(&of_screw(4.0, None), &settings, 120.0).is_none());
    }
}
