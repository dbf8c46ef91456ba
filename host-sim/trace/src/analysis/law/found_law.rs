//! A law that was found.

use super::spread::Spread;
use crate::fit::fit_data::FitAndValidationRms;
use model::effects::{Abscissa, Effect, Stage};
use model::residual_law::{ResidualLaw, Term};
use model::residual_table::{TableChannel, TableVariable};

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
    /// How uncertain the values of the terms are.
    pub spread: Spread,
    /// Rms without the law, µm or N.
    pub before: FitAndValidationRms,
    /// Rms with the law.
    pub after: FitAndValidationRms,
    /// Whether the law leaves no more than a model may leave in the stage of a certain effect.
    pub is_complete: bool,
    /// Effects of the catalogue that could describe a part of the law, best first; empty: none was compared.
    pub resembles: Vec<Resemblance>,
}

/// An effect of the catalogue that a law resembles. A resemblance is no cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Resemblance {
    /// Name of the effect.
    pub effect: &'static str,
    /// The part of the variance of the law over the fitted logs that the effect could describe, 0 to 1.
    pub share: f64,
}

impl Resemblance {
    /// Below this share, a law does not resemble an effect.
    pub const MIN_SHARE: f64 = 0.5;
}

/// A term of a law.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundTerm {
    /// The term with its coefficients.
    pub term: Term,
    /// Half of the 95 % interval of each coefficient.
    pub half_widths: [f64; 2],
    /// Half of the 95 % interval of the amplitude of a wave; of other terms, that of the coefficient.
    pub amplitude_half_width: f64,
    /// Half of the 95 % interval of a period or a distance, mm; NaN: the logs do not give it. None of a product.
    pub length_half_width: Option<f64>,
    /// By how many standard errors the term, fitted to the held-out logs alone, differs from zero.
    pub held_out_t: f64,
    /// Terms that describe the fitted logs as well in its place.
    pub rivals: Vec<Term>,
    /// A term of the same motion that is [`MIN_SHADOW_RATIO`] times as large: the small one may be what its form lacks.
    pub shadowed_by: Option<Term>,
    /// An effect of the model that has rivals and depends on the variable of the term: what the term describes may be an error of this effect.
    pub beside_ambiguous: Option<&'static str>,
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
        self.is_complete
            && term.rivals.is_empty()
            && term.shadowed_by.is_none()
            && term.beside_ambiguous.is_none()
            && term.is_in_all_folds
    }

    /// This law, in which each term names an effect of its variable, of those of the model that the logs do not tell from others.
    #[must_use]
    pub fn doubted_beside(mut self, ambiguous: &[&Effect]) -> Self {
        for term in &mut self.terms {
            let is_of_its_variable = |effect: &&&Effect| {
                let variable = variable_of(&effect.abscissa());
                effect.stages().contains(&self.stage)
                    && term.term.variables().iter().all(|one| *one == variable)
            };
            term.beside_ambiguous = ambiguous.iter().find(is_of_its_variable).map(|effect| effect.name());
        }
        self
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

/// The variable of a law that an effect depends on.
const fn variable_of(abscissa: &Abscissa) -> TableVariable {
    match abscissa {
        Abscissa::Time => TableVariable::TimeS,
        Abscissa::Position | Abscissa::WithinPeriod(_) => TableVariable::PositionMm,
        Abscissa::Velocity => TableVariable::VelocityMPerS,
        Abscissa::Acceleration => TableVariable::AccelerationMPerS2,
        Abscissa::Force => TableVariable::ForceN,
        Abscissa::OtherPosition(_) => TableVariable::OtherPositionMm,
        Abscissa::OtherAcceleration(_) => TableVariable::OtherAccelerationMPerS2,
    }
}
