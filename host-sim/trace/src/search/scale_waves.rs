//! Waves of the scale in the place of those of screw and motor encoder.
//!
//! A wave of the scale's reading looks in the table stage like a wave of the screw. The tool, which is predicted from the scale, then
//! has the same wave with the opposite sign; with a wave of the screw it has none.

use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::scope::Scope;
use model::effects::{Effect, Stage};

/// Share of a wave that the tool shows, half-way between one of the scale and one that the tool follows.
const SHARE_OF_SCALE: f64 = 0.5;

/// The model with another effect in the place of a found one, by its index.
fn with_exchanged(model: &AxisModel, found: usize, effect: Effect) -> AxisModel {
    let mut exchanged = model.clone();
    let declared = exchanged.axis.effect.len() - exchanged.found().len();
    exchanged.axis.effect[declared + found] = effect;
    exchanged
}

/// Σr² of the tool stage about its mean, and Σr·w with the wave w that an exchange adds, and Σw².
struct Sums {
    residual: f64,
    product: f64,
    wave: f64,
}

impl Sums {
    fn of(data: &FitData<'_>, model: &AxisModel, exchanged: &AxisModel, scope: &Scope) -> Self {
        let mut sums = Self { residual: 0.0, product: 0.0, wave: 0.0 };
        let residuals = [model, exchanged].map(|model| data.residuals(model, scope));
        for (base, other) in residuals[0].iter().zip(&residuals[1]) {
            let counts = data.counting(Stage::Tool, base.log);
            let counted = || (0..base.values.len()).filter(|&i| counts(i));
            let wave = |i: usize| other.values[i] - base.values[i];
            let [mean, mean_wave] =
                [numerics::mean(counted().map(|i| base.values[i])), numerics::mean(counted().map(wave))];
            for i in counted() {
                let (residual, wave) = (base.values[i] - mean, wave(i) - mean_wave);
                sums.residual += residual * residual;
                sums.product += residual * wave;
                sums.wave += wave * wave;
            }
        }
        sums
    }

    /// Share of the wave that the tool shows: 1 if it is that of the scale, 0 if the tool follows it.
    fn share(&self) -> f64 {
        -self.product / self.wave.max(f64::MIN_POSITIVE)
    }
}

/// Share of a found wave, by its index, that the tool shows: 1 if it is the scale's, whose effect is given, 0 if the tool follows it.
#[must_use]
pub fn share_of_scale(
    data: &FitData<'_>,
    model: &AxisModel,
    (found, of_scale): (usize, Effect),
    tool: &Scope,
) -> f64 {
    Sums::of(data, model, &with_exchanged(model, found, of_scale), tool).share()
}

/// The model in which the search for effects of the tool has to start again, with fewer waves of the scale: without those that the tool does not show
/// once its other effects are known. `None` if it shows all. A mode of the tool may resemble a wave until it is found.
#[must_use]
pub fn taken_back(
    data: &FitData<'_>,
    [before, exchanged, found]: [&AxisModel; 3],
    tool: &Scope,
) -> Option<AxisModel> {
    let mut start = None;
    for (index, (first, of_scale)) in before.found().iter().zip(exchanged.found()).enumerate() {
        let place = found.found().iter().position(|effect| effect.is_same(of_scale));
        let Some(place) = place.filter(|_| !first.is_same(of_scale)) else { continue };
        let without = with_exchanged(found, place, first.clone());
        if Sums::of(data, &without, found, tool).share() < SHARE_OF_SCALE {
            start = Some(with_exchanged(start.as_ref().unwrap_or(exchanged), index, first.clone()));
        }
    }
    start
}

/// The model in which waves are the scale's where that removes a part of the tool's residual, before other effects of the tool are
/// known.
#[must_use]
pub fn with_waves_of_scale(data: &FitData<'_>, mut model: AxisModel, tool: &Scope) -> AxisModel {
    for index in 0..model.found().len() {
        let Some(effect) = model.found()[index].of_scale() else { continue };
        let exchanged = with_exchanged(&model, index, effect);
        let sums = Sums::of(data, &model, &exchanged, tool);
        let removed = -2.0 * sums.product - sums.wave;
        if sums.share() > SHARE_OF_SCALE && removed > data.options.search.min_reduction * sums.residual {
            model = exchanged;
        }
    }
    model
}
