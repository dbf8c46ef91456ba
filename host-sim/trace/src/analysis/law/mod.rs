//! A law for a residual that no effect describes: an equation of a few measured variables.
//!
//! | step | module |
//! |---|---|
//! | the terms that may be in a law | [`library`], [`waves`] |
//! | the samples, and normal equations block by block | [`samples`] |
//! | the subsets of one to three terms that leave least | [`subsets`] |
//! | how many terms, and their distances and periods | [`choice`] |
//! | which terms held-out logs support, and which have a rival | [`judgement`] |
//! | as text | [`equation`] |
//!
//! A law says how a residual depends on the motion. It does not say what causes it, and holds for motions like those in which it was
//! found.

pub mod choice;
pub mod equation;
pub mod judgement;
pub mod library;
pub mod samples;
pub mod subsets;
pub mod waves;

#[cfg(test)]
mod tests;

use crate::fit::fit_data::{FitAndValidationRms, FitData, ResidualSeries};
use crate::fit::normal_equations::Column;
use choice::Chosen;
use model::effects::Stage;
use model::residual_law::{ResidualLaw, Term};
use model::residual_table::TableChannel;
use samples::{Normal, Samples};
use subsets::independent;

/// A law that held-out logs support.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundLaw {
    /// Stage.
    pub stage: Stage,
    /// Axis.
    pub axis: String,
    /// The first other axis, of which variables are in the law; empty: there is none.
    pub other: String,
    /// Its constant, µm or N.
    pub constant: f64,
    /// Its terms.
    pub terms: Vec<FoundTerm>,
    /// Rms without the law, µm or N.
    pub before: FitAndValidationRms,
    /// Rms with the law.
    pub after: FitAndValidationRms,
    /// Whether the law leaves no more than a model may leave in the stage of a certain effect.
    pub is_complete: bool,
}

/// A term of a law.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundTerm {
    /// The term with its coefficients.
    pub term: Term,
    /// Half of the 95 % interval of each coefficient.
    pub half_widths: [f64; 2],
    /// By how many standard errors the term lowers Σr² of the held-out logs.
    pub held_out_t: f64,
    /// Terms that describe the fitted logs as well in its place.
    pub rivals: Vec<Term>,
    /// Whether the law of each two thirds of the fitted logs contains the term.
    pub is_in_all_folds: bool,
}

impl FoundLaw {
    /// Whether the logs determine that a term is in the law: no other term describes them as well in its place, and the law describes what the
    /// model leaves. A larger remainder has a cause of which the term may describe a part.
    #[must_use]
    pub fn is_certain(&self, term: &FoundTerm) -> bool {
        self.is_complete && term.rivals.is_empty() && term.is_in_all_folds
    }

    /// The law for the model of the axis.
    #[must_use]
    pub fn residual_law(&self) -> ResidualLaw {
        ResidualLaw {
            channel: TableChannel::of(self.stage),
            constant: self.constant,
            term: self.terms.iter().map(|found| found.term.clone()).collect(),
        }
    }
}

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
    let judged = judgement::judged(&chosen, &held_out, criteria)?;
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
        is_complete: judged.after.fit <= fit.data.options.verdict.max_certain_ratio * noise.max(fit.data.options.verdict.min_noise),
        before: judged.before,
        after: judged.after,
    })
}
