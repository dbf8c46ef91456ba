//! Waves of the screw that were taken for waves of the resolver, and vice versa.
//!
//! Both are waves of table − motor with the same size. They differ by what they do to the closed loop's force, which is small beside what
//! other effects left when the first of them was added. Once all effects are found, each wave is tried as that of the other part.

use std::f64::consts::PI;

use super::held_out::{compare, is_better, scores};
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted};
use crate::fit::scope::Scope;
use model::axis::Settings;
use model::effects::{Effect, PitchCyclic, ResolverDividing};

/// The fit with each wave that of the part of which it explains the logs better.
#[must_use]
pub fn with_exchanged_waves(data: &FitData<'_>, mut base: Fitted, scope: &Scope) -> Fitted {
    let travel_mm = data.travel_mm();
    let options = &data.options.search;
    for effect in base.model.found().to_vec() {
        let found = base.model.found();
        let Some(index) = found.iter().position(|other| *other == effect) else { continue };
        let Some(other) = of_other_part(&effect, &base.model.axis.settings, travel_mm) else { continue };
        if !scope.holds(&effect) || found.iter().any(|found| found.is_same(&other)) {
            continue;
        }
        let start = base.model.without(index).with(other);
        let exchanged = least_squares::fit(data, &start, scope, least_squares::STEPS);
        let comparison = compare(&scores(&base), &scores(&exchanged), &scope.stages, options);
        if is_better(&comparison, options) {
            base = exchanged;
        }
    }
    base
}

/// The wave of the other part with the same size over the position: table − reading is the error of the screw, or minus that of the
/// resolver. `None`: no wave, or the machine has no such part.
fn of_other_part(effect: &Effect, settings: &Settings, travel_mm: [f64; 2]) -> Option<Effect> {
    let lead_mm = settings.mechanics.lead_mm?;
    let period = |period_mm: f64, fitted_period_mm, turn_mm: f64| {
        // Periods within a quarter of a wave over the travel are the same.
        let of_order = turn_mm / (turn_mm / period_mm).round().max(1.0);
        let is_of_order =
            (of_order - period_mm).abs() < 0.25 * period_mm * period_mm / (travel_mm[1] - travel_mm[0]);
        if is_of_order { (of_order, None) } else { (period_mm, fitted_period_mm) }
    };
    match *effect {
        Effect::PitchCyclic(PitchCyclic { amplitude_um, period_mm, phase_rad, fitted_period_mm }) => {
            let electrical_mm = lead_mm / f64::from(settings.sensors.resolver_pole_pairs?);
            let (period_mm, fitted_period_mm) = period(period_mm, fitted_period_mm, electrical_mm);
            let phase_rad = phase_rad + PI;
            Some(Effect::ResolverDividing(ResolverDividing {
                amplitude_um,
                period_mm,
                phase_rad,
                fitted_period_mm,
            }))
        }
        Effect::ResolverDividing(ResolverDividing {
            amplitude_um,
            period_mm,
            phase_rad,
            fitted_period_mm,
        }) => {
            let (period_mm, fitted_period_mm) = period(period_mm, fitted_period_mm, lead_mm);
            let phase_rad = phase_rad + PI;
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
        let other = |effect: &Effect| of_other_part(effect, &settings, [-60.0, 60.0]).unwrap();
        let values = |effect: &Effect| effect.values()[1];
        let around = Some([15.5, 16.5]);

        let of_resolver = other(&of_screw(16.02, around));
        assert_eq!((of_resolver.name(), values(&of_resolver)), ("resolver_dividing", 16.02));
        let back = other(&of_resolver);
        assert_eq!((back.name(), values(&back), back.coordinates().len()), ("pitch_cyclic", 16.0, 2));
        let electrical = other(&of_screw(4.01, Some([3.9, 4.1])));
        assert_eq!((values(&electrical), electrical.coordinates().len()), (4.0, 2));

        settings.sensors.resolver_pole_pairs = None;
        assert!(of_other_part(&of_screw(4.0, None), &settings, [-60.0, 60.0]).is_none());
    }
}
