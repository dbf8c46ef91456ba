//! A law that was found.

use crate::fit::fit_data::FitAndValidationRms;
use model::effects::Stage;
use model::residual_law::{ResidualLaw, Term};
use model::residual_table::TableChannel;

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
    /// By how many standard errors the term, fitted to the held-out logs alone, differs from zero.
    pub held_out_t: f64,
    /// Terms that describe the fitted logs as well in its place.
    pub rivals: Vec<Term>,
    /// A term of the same motion that is [`MIN_SHADOW_RATIO`] times as large: the small one may be what its form lacks.
    pub shadowed_by: Option<Term>,
    /// Whether the law of each two thirds of the fitted logs contains the term.
    pub is_in_all_folds: bool,
}

/// A form describes its cause to a few percent: a direction, for one, turns over within a speed. By its rms over the fitted logs, a term is in the
/// shadow of one that is this many times as large.
pub const MIN_SHADOW_RATIO: f64 = 30.0;

impl FoundLaw {
    /// Whether the logs determine that a term is in the law: no other term describes them as well in its place, none is so large that this one
    /// may be what its form lacks, and the law describes what the model leaves. A larger remainder has a cause of which the term may
    /// describe a part.
    #[must_use]
    pub fn is_certain(&self, term: &FoundTerm) -> bool {
        self.is_complete && term.rivals.is_empty() && term.shadowed_by.is_none() && term.is_in_all_folds
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
