//! Drifts whose time constant the logs do not hold.
//!
//! Over a time that is short beside its time constant, a drift is a straight line: where it ends is not measured, however well an
//! exponential fits. It is a rate.

use crate::fit::fit_data::FitData;
use crate::fit::fitted_axis::FittedAxis;
use crate::fit::least_squares;
use crate::judge::found_effect::FoundEffect;
use crate::search::held_out::{compare, scores};
use model::effects::Stage;

/// Time on the session clock at which the last fit log ends, s. A drift begins at time zero.
fn end_s(data: &FitData<'_>) -> f64 {
    numerics::max(data.logs.iter().map(|log| log.start_s + log.len() as f64 * log.sample_s))
}

/// The axis with rates in the place of drifts that may outlast the logs, where they explain these as well.
#[must_use]
pub fn with_rates(data: &FitData<'_>, mut axis: FittedAxis) -> FittedAxis {
    let end_s = end_s(data);
    for index in (0..axis.model.found().len()).rev() {
        let half_widths = axis.half_widths(data, index);
        let Some(rate) = axis.model.found()[index].within_logs(&half_widths, end_s) else { continue };
        let model = axis.model.without(index).with(rate);
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
        let rate = one.effect.within_logs(&one.half_widths, end_s);
        one.rivals.extend(rate);
    }
}
