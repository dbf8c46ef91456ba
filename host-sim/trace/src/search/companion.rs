//! Effects that are added together.
//!
//! What an effect describes may have a part that is an effect of its own, such as the slope of a pitch map
//! ([`EffectModel::added_with`](model::effects::EffectModel::added_with)), or a variation over the position
//! ([`EffectModel::variation`](model::effects::EffectModel::variation)).

use super::residual_shape::shape;
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::Fitted;
use crate::fit::scope::Scope;
use model::effects::Effect;

/// The model with a candidate, and before it with the effect that is added with it, if the model does not have that one.
#[must_use]
pub fn with_companion(model: &AxisModel, candidate: Effect) -> AxisModel {
    let is_missing = |companion: &Effect| !model.axis.effect.iter().any(|other| other.is_same(companion));
    match candidate.added_with().filter(is_missing) {
        Some(companion) => model.with(companion).with(candidate),
        None => model.with(candidate),
    }
}

/// Whether an effect is added with another one of the same model.
#[must_use]
pub fn is_companion(effect: &Effect, found: &[Effect]) -> bool {
    found.iter().any(|other| other.added_with().is_some_and(|companion| companion.is_same(effect)))
}

/// The model of a fit with a candidate and its variation over the position; `None` if it has none, or the model describes any shape
/// over the position already.
#[must_use]
pub fn with_variation(
    data: &FitData<'_>,
    fitted: &Fitted,
    scope: &Scope,
    candidate: &Effect,
) -> Option<AxisModel> {
    let model = &fitted.model;
    if has_any_shape(&model.axis.effect) {
        return None;
    }
    let residual = || shape(data, &fitted.residuals, scope, &model.axis.settings.mechanics);
    Some(with_companion(model, candidate.variation(&residual, data.travel_mm())?))
}

/// Whether one of the effects describes a residual of any shape over the position.
#[must_use]
pub fn has_any_shape(effects: &[Effect]) -> bool {
    effects.iter().any(|effect| effect.describes_any_shape_of().is_some())
}

/// Whether an effect is what another one leaves, and no effect of its own.
#[must_use]
pub fn is_remainder(effect: &Effect, found: &[Effect]) -> bool {
    effect.wave().is_some_and(|wave| found.iter().any(|other| other.leaves(wave)))
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
            is_remainder(&screw(0.02, 16.0), &found)
                && is_remainder(&screw(-0.07, 16.0), &found)
                && is_remainder(&screw(0.02, 10.0), &found)
        );
        assert!(!is_remainder(&screw(0.09, 16.0), &found), "larger than what a map leaves");
        assert!(!is_remainder(&screw(0.02, 5.0), &found), "shorter than half the distance");
        assert!(!is_remainder(&screw(0.02, 16.0), &[]), "no map");
    }

    #[test]
    fn a_resolver_has_fractions_of_the_lead() {
        let has_own_period = |effect: &Effect| effect.wave().unwrap().has_own_period(Some(20.0));
        let resolver = |period_mm| {
            let (amplitude_um, phase_rad) = (1.0, 0.0);
            Effect::ResolverDividing(ResolverDividing {
                amplitude_um,
                period_mm,
                phase_rad,
                fitted_period_mm: None,
            })
        };
        assert!(has_own_period(&resolver(17.27)) && has_own_period(&screw(1.0, 7.0)));
        assert!(!has_own_period(&resolver(4.0)) && !has_own_period(&screw(1.0, 20.0)));
    }
}
