//! A law for a residual that no effect describes: an equation of a few measured variables.
//!
//! | step | module |
//! |---|---|
//! | the terms that may be in a law | [`library`], [`waves`] |
//! | the samples without those near a reversal, and normal equations block by block | [`samples`], [`reversals`] |
//! | the subsets of one to three terms that leave least | [`subsets`] |
//! | how many terms, and their distances and periods | [`choice`] |
//! | which terms held-out logs support, and which have a rival | [`judgement`] |
//! | the intervals of coefficients, periods and distances | [`spread`] |
//! | the law | [`found_law`], as text [`equation`] |
//!
//! A law says how a residual depends on the motion. It does not say what causes it, and holds for motions like those in which it was
//! found.

pub mod choice;
pub mod equation;
pub mod found_law;
pub mod judgement;
pub mod library;
pub mod reversals;
pub mod samples;
pub mod spread;
pub mod subsets;
pub mod waves;

#[cfg(test)]
mod tests;

use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::normal_equations::Column;
use choice::Chosen;
pub use found_law::{FoundLaw, FoundTerm, Resemblance};
use model::effects::Stage;
use samples::{Normal, Samples};
use subsets::independent;

/// A residual of which a law is searched for.
#[derive(Clone, Copy, Debug)]
pub struct Left<'a> {
    /// The logs.
    pub data: &'a FitData<'a>,
    /// The residuals of the model.
    pub residuals: &'a [ResidualSeries],
    /// Their derivatives with respect to the parameters that stay free beside the law: an effect that describes a part of it
    /// gives this part back.
    pub free: &'a [Column],
}

/// Smallest fraction of the held-out residual's power above its noise that a law explains.
const MIN_EXPLAINED: f64 = 0.5;

/// The law of the residual of a stage with this noise, if the fitted and the held-out logs support one.
#[must_use]
pub fn law(fit: &Left<'_>, validate: &Left<'_>, stage: Stage, noise: f64) -> Option<FoundLaw> {
    let variables = library::variables(fit.data, stage);
    let [fitted, held_out] =
        [fit, validate].map(|left| Samples::of(left.data, (left.residuals, left.free), stage, &variables));
    if held_out.blocks.is_empty() {
        return None;
    }
    let free = independent(&Normal::sum(fitted.normal(&[]).iter())?);
    let (fitted, held_out) = (fitted.with_free(&free), held_out.with_free(&free));
    let criteria = &fit.data.options.search;
    let chosen = Chosen::of(&fitted, &variables, criteria)?;
    let judged = judgement::judged(&chosen, [&fitted, &held_out], criteria)?;
    let [before, after] = [judged.before, judged.after].map(|rms| rms.validate.powi(2) - noise * noise);
    if after > (1.0 - MIN_EXPLAINED) * before {
        return None;
    }
    let (axis, names) = (fit.data.name(), fit.data.names);
    Some(FoundLaw {
        stage,
        axis: axis.to_owned(),
        other: names.iter().find(|name| *name != axis).cloned().unwrap_or_default(),
        constant: judged.constant,
        terms: judged.terms,
        spread: judged.spread,
        is_complete: judged.after.fit <= fit.data.options.verdict.max_certain(noise),
        before: judged.before,
        after: judged.after,
        resembles: Vec::new(),
    })
}
