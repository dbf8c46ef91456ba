//! A second mode of the tool.
//!
//! Beside a second mode the first one has a participation of its own: the tool is no longer the mass that the table drives.

use rayon::prelude::*;

use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{self, Fitted};
use crate::fit::normal_equations::Column;
use crate::fit::scope::Scope;
use model::effects::{Effect, Resonance, Stage};

/// Steps of a fit that only shows whether the frequency with which it started is near that of the mode.
const TRIAL_STEPS: usize = 3;

/// The model with the participation of every found mode free, if its last effect is a second mode, and those of the known
/// derivatives that remain valid.
#[must_use]
pub fn with_free_modes<'a>(
    mut model: AxisModel,
    scope: &Scope,
    known: &'a [Column],
) -> (AxisModel, &'a [Column]) {
    let Some((Effect::Resonance(_), others)) = model.found().split_last() else { return (model, known) };
    let is_fixed = |effect: &Effect| matches!(effect, Effect::Resonance(mode) if !mode.fits_participation);
    let Some(first) = others.iter().position(is_fixed) else { return (model, known) };
    let valid = model.indices_of(scope, first).start.min(known.len());
    let declared = model.axis.effect.len() - model.found().len();
    for effect in &mut model.axis.effect[declared..] {
        if let Effect::Resonance(mode) = effect {
            mode.fits_participation = true;
        }
    }
    (model, &known[..valid])
}

/// The model of a fit with the second mode at the frequency that leaves least: far below its frequency every mode lags alike, so that
/// a fit ends at any frequency near that with which it started.
#[must_use]
pub fn at_best_frequency(data: &FitData<'_>, fitted: &Fitted, scope: &Scope) -> Option<AxisModel> {
    let (last, others) = fitted.model.found().split_last()?;
    let Effect::Resonance(second) = last else { return None };
    let has_first = others.iter().any(|effect| matches!(effect, Effect::Resonance(_)));
    let left = data.rms(&fitted.residuals, Stage::Tool);
    if !has_first {
        return None;
    }
    let with = |guess: Resonance| {
        let ratio = guess.frequency_hz / second.frequency_hz;
        let participation = second.participation * ratio * ratio;
        let mode = Effect::Resonance(Resonance { participation, ..guess });
        let start = fitted.model.without(others.len()).with(mode);
        let trial = least_squares::fit(data, &start, scope, TRIAL_STEPS);
        (data.rms(&trial.residuals, Stage::Tool), trial.model)
    };
    let guesses: Vec<Resonance> = Resonance::second_modes().collect();
    let trials: Vec<(f64, AxisModel)> = guesses.into_par_iter().map(with).collect();
    let best = trials.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 < left).then_some(best.1)
}
