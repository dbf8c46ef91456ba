//! What speaks against a model or an effect, in words.

use super::number::{percent, significant};
use super::parameters::brief;
use super::words::{effect, rotary};
use files::log::Unit;
use trace::fit::fit_data::Pair;
use trace::fit::limits::AtLimit;
use trace::outcome::{AxisTrace, StageError};
use trace::stages::{residual_unit, stage_names};
use trace::validation::found::Found;
use trace::verdict;

/// The stages of which so much stays, and how much.
fn what_stays(
    axis: &AxisTrace,
    is_told: impl Fn(&StageError) -> bool,
    rms: fn(&Pair) -> f64,
) -> Option<String> {
    let of_stage = |error: &StageError| {
        let (unit, _) = residual_unit(axis.unit, error.stage);
        let stays = rms(&error.after);
        format!(
            "{} {} {unit} rms ({} times the sensors' noise)",
            stage_names(&[error.stage]),
            significant(stays, 3),
            significant(stays / error.noise, 2),
        )
    };
    let told: Vec<String> = axis.errors.iter().filter(|error| is_told(error)).map(of_stage).collect();
    (!told.is_empty()).then(|| told.join(", "))
}

/// That a model does not describe the logs, if it does not, with the stages that show it.
#[must_use]
pub fn misfit(axis: &AxisTrace) -> Option<String> {
    let stays = what_stays(axis, verdict::is_gross, |pair| pair.fit)?;
    Some(format!(
        "{}: the model does not describe these logs, whatever else is told of them; what stays: {stays}. A channel may be \
         wrong (its sign, unit, axis or time), or a declared value.",
        axis.axis
    ))
}

/// That a model which describes the fitted logs does not describe those held out, if it does not.
#[must_use]
pub fn misfit_held_out(axis: &AxisTrace) -> Option<String> {
    let only_there = |error: &StageError| verdict::is_gross_held_out(error) && !verdict::is_gross(error);
    let stays = what_stays(axis, only_there, |pair| pair.validate)?;
    Some(format!(
        "{}: the model does not describe the logs held out, so that they are no judge of what else is told; what stays \
         there: {stays}. A channel of theirs may be wrong, or they ask more of the machine than the fitted logs.",
        axis.axis
    ))
}

/// The sentence for an effect that the fit logs show and the validation logs refute.
#[must_use]
pub fn refuted(axis: &str, unit: Unit, found: &Found) -> String {
    let what = effect(&found.effect, &found.half_widths);
    let what = if unit == Unit::Degree { rotary(&what) } else { what };
    let [before, after] = [found.before, found.after].map(|pair| significant(pair.validate, 3));
    format!(
        "{axis}: refuted by the logs held out, and not in the model (all that these logs decide): {what}; the {} residual \
         there goes from {before} to {after} {} rms with it.",
        stage_names(&[found.stage]),
        residual_unit(unit, found.stage).0,
    )
}

/// The sentence for an effect that was not taken because a parameter ended at a limit of its search.
#[must_use]
pub fn at_limit(axis: &str, unit: Unit, limit: &AtLimit) -> String {
    let what = brief(&limit.effect);
    let what = if unit == Unit::Degree { rotary(&what) } else { what };
    format!(
        "{axis}: not taken, though it would explain much: {what}; {} is the limit of its search, so that the value lies \
         beyond or the effect is another one.",
        significant(limit.limit, 3)
    )
}

/// That the model as fitted in the end does worse on the validation logs than the declared one.
#[must_use]
pub fn worse(axis: &AxisTrace, error: &StageError) -> Option<String> {
    /// A tenth more of the residual is no matter of chance.
    const LARGER: f64 = 1.1;
    let (before, after) = (error.before.validate, error.after.validate);
    // Within the noise there is nothing to lose.
    if !(after > LARGER * before && after > LARGER * error.noise) {
        return None;
    }
    let (unit, _) = residual_unit(axis.unit, error.stage);
    Some(format!(
        "{}, {}: on motions not used {} {unit} rms stay with all that was fitted, {} more than the {} {unit} with the declared \
         values fitted alone.",
        axis.axis,
        stage_names(&[error.stage]),
        significant(after, 3),
        percent(100.0 * (after / before - 1.0)),
        significant(before, 3),
    ))
}
