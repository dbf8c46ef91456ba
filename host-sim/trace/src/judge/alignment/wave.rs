//! Waves of the scale against those of screw and motor encoder: see [`crate::search::scale_waves`].

use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::scope::Scope;
use crate::judge::found_effect::FoundEffect;
use crate::search::scale_waves::share_of_scale;
use model::axis::Settings;
use model::effects::{Effect, harmonic};

/// Share of a wave that the tool shows, up to which it is not that of the scale.
const LEAST_SHARE: f64 = 0.15;

/// Names the scale as a rival of the waves for which the tool decides neither way; `tool`: its scope, if it can be evaluated.
pub fn doubt(data: &FitData<'_>, model: &AxisModel, tool: Option<&Scope>, found: &mut [FoundEffect]) {
    let [lowest_mm, highest_mm] = data.travel_mm();
    for one in found {
        let Some(rival) = one.effect.of_scale() else { continue };
        let index = model.found().iter().position(|effect| effect.is_same(&one.effect));
        let is_of_machine = match (tool, index) {
            (Some(tool), Some(index)) => {
                share_of_scale(data, model, (index, rival.clone()), tool) < LEAST_SHARE
            }
            _ => is_of_a_turn(&one.effect, &model.axis.settings, highest_mm - lowest_mm),
        };
        if !is_of_machine {
            one.rivals.push(rival);
        }
    }
}

/// Whether a wave has a whole number of periods per turn of the motor or per electrical period: then it is hardly the scale's.
fn is_of_a_turn(effect: &Effect, settings: &Settings, travel_mm: f64) -> bool {
    let (Some(wave), Some(lead_mm)) = (effect.wave(), settings.mechanics.lead_mm) else { return false };
    harmonic::order(wave.period_mm, lead_mm, travel_mm).is_some()
}
