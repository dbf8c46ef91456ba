//! The final fit: all that was found, with the error of the tracer's own simulation subtracted, until that error is the
//! fitted model's own.

use super::axis_model::AxisModel;
use super::fit_data::{FitData, ResidualSeries};
use super::model_bias::{self, log_rms};
use super::scope::{Mechanics, Scope};
use super::scope_fit::{Progress, ScopeFit, fit_again};

/// Most fits, each with the error of the model of the fit before. One is enough where the error hardly depends on the
/// model; behind a backlash, where it depends on the instants at which the gap closes, four or five are.
const MAX_FITS: usize = 10;

/// The fits end when taking the error of the last model instead of that of the model before changes the residuals by less
/// than this fraction in all.
const MIN_CHANGE: f64 = 2e-3;

/// A model with its fits and its own error.
struct Unbiased {
    model: AxisModel,
    fits: Vec<ScopeFit>,
    /// The error on the fit logs, of this model.
    bias: Vec<ResidualSeries>,
}

/// The model that the search found, after its final fit.
pub struct FinalFit {
    /// The model.
    pub model: AxisModel,
    /// The fits of its scopes.
    pub fits: Vec<ScopeFit>,
    /// The error that is subtracted from the residuals of the fit logs and of the validation logs; empty if not known.
    pub bias: [Vec<ResidualSeries>; 2],
}

/// Fits what the search found with the error of the tracer's own simulation subtracted, if that lowers the residuals of
/// the fit logs. `written` is the model as in the machine file: where nothing was found it is kept, if an earlier trace
/// wrote it and another fit is no better.
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
    let kept = has_nothing_new.then(|| kept(fit_data, written, &result.model, scopes)).flatten();
    if let Some((model, bias)) = kept {
        (result.model, result.bias[0]) = (model, bias);
    }
    if let Some(driven) = driven(scopes).filter(|_| !result.bias[0].is_empty()) {
        result.bias[1] = model_bias::of(validate, &result.model, driven);
    }
    result
}

/// The scope of the stages that the measured motor drives.
fn driven(scopes: &[Scope]) -> Option<&Scope> {
    scopes.iter().find(|scope| scope.mechanics == Mechanics::All)
}

/// Fits all that was found without the model's own error, and again with that of the new model while this lowers the
/// residuals. `None` if the error is not known or the residuals of the fit logs are lower with it.
fn unbiased(
    data: &FitData<'_>,
    model: &AxisModel,
    fits: &[ScopeFit],
    scopes: &[Scope],
    progress: &Progress<'_>,
) -> Option<Unbiased> {
    let driven = driven(scopes)?;
    let biased = log_rms(data, &data.residuals(model, driven), driven);
    let first = with_bias(data, model.clone(), fits.to_vec(), driven)?;
    let mut best: Option<(Unbiased, f64)> = None;
    for _ in 0..MAX_FITS {
        progress(&format!("{}: fitting again without the error of the tracer's own simulation", data.name()));
        let last = best.as_ref().map_or(&first, |(last, _)| last);
        let without_last = FitData { bias: &last.bias, ..*data };
        let (model, fits) = fit_again(&without_last, &last.model, &last.fits, scopes, progress);
        let size_with_last = total_log_rms(data, &model, &last.bias, scopes);
        let Some(next) = with_bias(data, model, fits, driven) else { break };
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

/// The model of a file that an earlier trace wrote, with its own error, if another fit of it is no better on these logs:
/// otherwise each trace would change poorly determined parameters a little. `None` for a model that was declared.
#[must_use]
pub fn kept(
    data: &FitData<'_>,
    written: &AxisModel,
    fitted: &AxisModel,
    scopes: &[Scope],
) -> Option<(AxisModel, Vec<ResidualSeries>)> {
    let driven = driven(scopes).filter(|_| written.was_fitted())?;
    let [bias, bias_of_fitted] =
        [written, fitted].map(|model| model_bias::of_fitted_file(data, model, driven));
    let size = total_log_rms(data, written, &bias, scopes);
    let size_of_fitted = total_log_rms(data, fitted, &bias_of_fitted, scopes);
    let mut model = written.clone();
    model.pin_mass(driven);
    (size_of_fitted > size - data.options.model.min_gain_of_refit).then_some((model, bias))
}

/// A model with its own error, if that is known.
fn with_bias(data: &FitData<'_>, model: AxisModel, fits: Vec<ScopeFit>, driven: &Scope) -> Option<Unbiased> {
    let bias = model_bias::of(data, &model, driven);
    (!bias.is_empty()).then_some(Unbiased { model, fits, bias })
}
