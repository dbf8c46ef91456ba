//! Drifts whose time constant the logs do not hold.
//!
//! Over a time that is short beside its time constant, a drift is a straight line: where it ends is not measured, however well an
//! exponential fits. It is a `thermal_rate`.

use crate::fit::fit_data::FitData;
use crate::fit::least_squares;
use crate::search::held_out::{compare, scores};
use crate::validation::fitted_axis::FittedAxis;
use crate::validation::found_effect::FoundEffect;
use model::effects::{Effect, Stage, ThermalDrift, ThermalRate};

/// Time on the session clock at which the last fit log ends, s. A drift begins at time zero.
fn end_s(data: &FitData<'_>) -> f64 {
    numerics::max(data.logs.iter().map(|log| log.start_s + log.len() as f64 * log.sample_s))
}

/// Mean rate of a drift until a time, µm per minute.
fn mean_rate(drift: &ThermalDrift, end_s: f64) -> Effect {
    Effect::ThermalRate(ThermalRate { um_per_min: 60e6 * drift.offset_m(end_s) / end_s })
}

/// Whether an effect is a drift whose time constant, by its interval, may be longer than the logs.
fn outlasts<'a>(effect: &'a Effect, half_widths: &[f64], end_s: f64) -> Option<&'a ThermalDrift> {
    match effect {
        Effect::ThermalDrift(drift) => {
            let half_width_s = half_widths.get(1).copied().unwrap_or(0.0);
            (drift.time_constant_s + half_width_s > end_s).then_some(drift)
        }
        _ => None,
    }
}

/// The axis with rates in the place of drifts that may outlast the logs, where they explain these as well.
#[must_use]
pub fn with_rates(data: &FitData<'_>, mut axis: FittedAxis) -> FittedAxis {
    let end_s = end_s(data);
    for index in (0..axis.model.found().len()).rev() {
        let half_widths = axis.half_widths(data, index);
        let Some(drift) = outlasts(&axis.model.found()[index], &half_widths, end_s) else { continue };
        let model = axis.model.without(index).with(mean_rate(drift, end_s));
        let Some(fit) = axis.fits.iter_mut().find(|fit| fit.scope.stages == [Stage::Tool]) else { continue };
        let of_fit = FitData { exclusions: &fit.exclusions, ..*data };
        let fitted = least_squares::fit(&of_fit, &model, &fit.scope, least_squares::STEPS);
        let options = &data.options.search;
        let loses = compare(&scores(&fitted), &scores(&fit.fitted), &[Stage::Tool], options)
            .iter()
            .any(|c| c.t > options.chance_t && c.reduction > options.min_reduction);
        if !loses {
            axis.model = fitted.model.clone();
            fit.fitted = fitted;
        }
    }
    axis
}

/// Names a rate as a rival of the drifts that may outlast the logs: a single exponential fits a part of several.
pub fn doubt(data: &FitData<'_>, found: &mut [FoundEffect]) {
    let end_s = end_s(data);
    for one in found {
        if let Some(drift) = outlasts(&one.effect, &one.half_widths, end_s) {
            let rival = mean_rate(drift, end_s);
            one.rivals.push(rival);
        }
    }
}
