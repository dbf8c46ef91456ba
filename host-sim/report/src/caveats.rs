//! Sentences on evidence against a model or an effect.

use super::parameters::brief;
use files::format::{percent, significant};
use files::log::Unit;
use trace::AxisIdentification;
use trace::fit::fit_data::FitAndValidationRms;
use trace::fit::limits::ParameterAtLimit;
use trace::judge::StageResidual;
use trace::judge::declared_value::DeclaredValue;
use trace::judge::found_effect::FoundEffect;
use trace::stages::{residual_unit, stage_names};

/// The rms residuals of the stages that a condition selects, as a list; `None` if it selects none.
fn list_residuals(
    axis: &AxisIdentification,
    is_listed: impl Fn(&StageResidual) -> bool,
    rms: fn(&FitAndValidationRms) -> f64,
) -> Option<String> {
    let of_stage = |error: &StageResidual| {
        let (unit, _) = residual_unit(axis.unit, error.stage);
        let residual = rms(&error.after);
        format!(
            "{} {} {unit} rms ({} times the sensors' noise)",
            stage_names(&[error.stage]),
            significant(residual, 3),
            significant(residual / error.noise, 2),
        )
    };
    let listed: Vec<String> = axis.residuals.iter().filter(|error| is_listed(error)).map(of_stage).collect();
    (!listed.is_empty()).then(|| listed.join(", "))
}

/// States that the model does not describe the fitted logs, with the stages that show it; `None` if it does.
#[must_use]
pub fn misfit(axis: &AxisIdentification) -> Option<String> {
    if axis.is_of_another_machine {
        let residuals = list_residuals(axis, |_| true, |pair| pair.fit)?;
        let is_far = |value: &DeclaredValue| value.is_undetermined() || value.is_beyond_tolerance;
        let keys: Vec<&str> = axis.written_values().filter(is_far).map(|value| value.key).collect();
        return Some(format!(
            "{}: this machine file does not describe this machine, so that no effect is reported; residuals: {residuals}; \
             farthest from the logs: {}.",
            axis.axis,
            keys.join(", ")
        ));
    }
    let residuals = list_residuals(axis, StageResidual::is_gross, |pair| pair.fit)?;
    Some(format!(
        "{}: nothing that is said of this axis can be relied on, as the model does not describe these logs; \
         residuals: {residuals}. To do: check sign, unit, axis and time of each channel, then the declared values.",
        axis.axis
    ))
}

/// States that the model describes the fitted logs but not those held out, with the stages that show it; `None` if it
/// describes both.
#[must_use]
pub fn misfit_held_out(axis: &AxisIdentification) -> Option<String> {
    let only_held_out = |error: &StageResidual| error.is_gross_held_out() && !error.is_gross();
    let residuals = list_residuals(axis, only_held_out, |pair| pair.validate)?;
    Some(format!(
        "{}: the model does not describe what was held out of its fit, so that this cannot validate the other results; \
         residuals: {residuals}. A channel may be wrong there, or the motion there excites behaviour that the \
         fitted part does not show.",
        axis.axis
    ))
}

/// States that the fit logs show an effect and the validation logs refute it.
#[must_use]
pub fn refuted(axis: &str, unit: Unit, found: &FoundEffect) -> String {
    let what = found.effect.sentence(&found.half_widths, unit == Unit::Degree);
    let [before, after] = [found.before, found.after].map(|pair| significant(pair.validate, 3));
    format!(
        "{axis}: refuted by the logs held out and not included in the model: {what}; with it, the {} residual of \
         these logs changes from {before} to {after} {} rms.",
        stage_names(&[found.stage]),
        residual_unit(unit, found.stage).0,
    )
}

/// States that an effect was not added because a parameter ended at a limit of its search range.
#[must_use]
pub fn at_limit(axis: &str, unit: Unit, limit: &ParameterAtLimit) -> String {
    let what = brief(&limit.effect, unit == Unit::Degree);
    format!(
        "{axis}: not added, although it explains a large part of the residual: {what}; {} is the limit of its \
         search range, so that the true value is outside or the residual has another cause.",
        significant(limit.limit, 3)
    )
}

/// States that the final model leaves a larger residual on the validation logs than the declared one; `None` if it does
/// not.
#[must_use]
pub fn worse(axis: &AxisIdentification, error: &StageResidual) -> Option<String> {
    /// Smallest ratio that is reported. Smaller ones may be chance.
    const MIN_RATIO: f64 = 1.1;
    let (before, after) = (error.before.validate, error.after.validate);
    if !(after > MIN_RATIO * before && after > MIN_RATIO * error.noise) {
        return None;
    }
    let (unit, _) = residual_unit(axis.unit, error.stage);
    Some(format!(
        "{}, {}: residual on held-out motions {} {unit} rms with everything fitted, {} more than the {} {unit} with \
         only the declared values fitted.",
        axis.axis,
        stage_names(&[error.stage]),
        significant(after, 3),
        percent(100.0 * (after / before - 1.0)),
        significant(before, 3),
    ))
}
