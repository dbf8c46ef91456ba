//! The final fit of all effects found, with the error of the tracer's own simulation subtracted. The fit is repeated until
//! the subtracted error is that of the fitted model.

use super::axis_model::AxisModel;
use super::fit_data::{FitData, ResidualSeries};
use super::model_bias::{self, log_rms};
use super::scope::{Mechanics, Scope};
use super::scope_fit::{ScopeFit, fit_again};
use crate::task::Progress;

/// Largest number of fits. Each fit subtracts the error of the previous model. One fit suffices if the error hardly depends
/// on the model. With backlash, where the error depends on the instants at which the gap closes, four or five are needed.
const MAX_FITS: usize = 10;

/// The fits end if replacing the error of the previous model by that of the last model changes the residuals by less than
/// this fraction in total.
const MIN_CHANGE: f64 = 2e-3;

/// A model with its fits and its own error.
struct Unbiased {
    model: AxisModel,
    fits: Vec<ScopeFit>,
    /// Error of this model on the fit logs.
    bias: Vec<ResidualSeries>,
}

/// The result of the final fit.
pub struct FinalFit {
    /// The model.
    pub model: AxisModel,
    /// The fits of its scopes.
    pub fits: Vec<ScopeFit>,
    /// The error that is subtracted from the residuals of the fit logs and of the validation logs; empty if not known.
    pub bias: [Vec<ResidualSeries>; 2],
}

/// Fits the model with the error of the tracer's own simulation subtracted, if this lowers the residuals of the fit logs.
/// `written` is the model of the machine file. If no effect was found, it is kept if an earlier trace wrote it and the new
/// fit is not better.
#[must_use]
pub fn final_fit(
    [fit_data, validate]: [&FitData<'_>; 2],
    written: &AxisModel,
    (model, fits): (AxisModel, Vec<ScopeFit>),
    scopes: &[Scope],
    progress: &Progress<'_>,
) -> FinalFit {
    let mut result = match unbiased(fit_data, &model, &fits, scopes, progress) {
        Some(Unbiased { model, fits, bias }) => FinalFit { model, fits, bias: [bias, Vec::new()] },
        None => FinalFit { model, fits, bias: [Vec::new(), Vec::new()] },
    };
    let has_nothing_new = result.model.found().is_empty();
    let previous =
        has_nothing_new.then(|| reuse_previous_fit(fit_data, written, &result.model, scopes)).flatten();
    if let Some((model, bias)) = previous {
        (result.model, result.bias[0]) = (model, bias);
    }
    if driven(scopes).is_some() && !result.bias[0].is_empty() {
        result.bias[1] = model_bias::of_all(validate, &result.model, scopes);
    }
    result
}

/// The scope of the stages that the measured motor drives.
fn driven(scopes: &[Scope]) -> Option<&Scope> {
    scopes.iter().find(|scope| scope.mechanics == Mechanics::All)
}

/// Fits the model with its own error subtracted, and repeats this with the error of the new model as long as the residuals
/// decrease. `None` if the error cannot be computed, or if the residuals of the fit logs are lower without the subtraction.
fn unbiased(
    data: &FitData<'_>,
    model: &AxisModel,
    fits: &[ScopeFit],
    scopes: &[Scope],
    progress: &Progress<'_>,
) -> Option<Unbiased> {
    let driven = driven(scopes)?;
    let biased = log_rms(data, &data.residuals(model, driven), driven);
    let first = with_bias(data, model.clone(), fits.to_vec(), scopes)?;
    let mut best: Option<(Unbiased, f64)> = None;
    for _ in 0..MAX_FITS {
        progress(&format!("{}: fitting again without the error of the tracer's own simulation", data.name()));
        let last = best.as_ref().map_or(&first, |(last, _)| last);
        let without_last = FitData { bias: &last.bias, ..*data };
        let (model, fits) = fit_again(&without_last, &last.model, &last.fits, scopes, progress);
        let size_with_last = total_log_rms(data, &model, &last.bias, scopes);
        let Some(next) = with_bias(data, model, fits, scopes) else { break };
        let size = total_log_rms(data, &next.model, &next.bias, scopes);
        if best.as_ref().is_some_and(|(_, min)| size > min - MIN_CHANGE) {
            break;
        }
        best = Some((next, size));
        if (size - size_with_last).abs() < MIN_CHANGE {
            break;
        }
    }
    let (best, _) = best?;
    let without = FitData { bias: &best.bias, ..*data };
    (log_rms(&without, &without.residuals(&best.model, driven), driven) < biased).then_some(best)
}

/// Sum over all stages of the logarithm of the residual that a model leaves after subtraction of `bias`.
fn total_log_rms(data: &FitData<'_>, model: &AxisModel, bias: &[ResidualSeries], scopes: &[Scope]) -> f64 {
    let data = FitData { bias, ..*data };
    scopes.iter().map(|scope| log_rms(&data, &data.residuals(model, scope), scope)).sum()
}

/// The model of a file that an earlier trace wrote, with its own error, if a new fit is not better on these logs. Otherwise
/// each trace would change poorly determined parameters slightly. `None` if no trace wrote the file.
#[must_use]
pub fn reuse_previous_fit(
    data: &FitData<'_>,
    written: &AxisModel,
    fitted: &AxisModel,
    scopes: &[Scope],
) -> Option<(AxisModel, Vec<ResidualSeries>)> {
    let driven = driven(scopes).filter(|_| written.was_fitted())?;
    let of_fitted = |model: &AxisModel, scope: &Scope| model_bias::of_fitted_file(data, model, scope);
    let [bias, bias_of_fitted] = [written, fitted].map(|model| -> Vec<ResidualSeries> {
        scopes.iter().flat_map(|scope| of_fitted(model, scope)).collect()
    });
    let size = total_log_rms(data, written, &bias, scopes);
    let size_of_fitted = total_log_rms(data, fitted, &bias_of_fitted, scopes);
    let mut model = written.clone();
    model.pin_mass(driven, 0.0);
    (size_of_fitted > size - data.options.model.min_gain_of_refit).then_some((model, bias))
}

/// A model with its own error, if the error can be computed.
fn with_bias(
    data: &FitData<'_>,
    model: AxisModel,
    fits: Vec<ScopeFit>,
    scopes: &[Scope],
) -> Option<Unbiased> {
    let bias = model_bias::of_all(data, &model, scopes);
    (!bias.is_empty()).then_some(Unbiased { model, fits, bias })
}
