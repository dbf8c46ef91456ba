//! Which terms of a chosen law held-out logs support, which of them have a rival, and the intervals of their coefficients.

use super::choice::{Chosen, improvement_t, price};
use super::found_law::{FoundTerm, MIN_SHADOW_RATIO};
use super::samples::{Normal, Samples};
use super::spread::Spread;
use super::subsets::Subset;
use crate::fit::fit_data::FitAndValidationRms;
use crate::fit::normal_equations::FOLDS;
use crate::options::SearchOptions;
use model::residual_law::Term;

/// A law is a rival of one that leaves less by no more than this many standard errors.
const MAX_AMBIGUOUS_T: f64 = 2.0;

/// A law whose terms are all supported.
pub struct Judged {
    /// Its constant.
    pub constant: f64,
    /// Its terms.
    pub terms: Vec<FoundTerm>,
    /// How uncertain their values are.
    pub spread: Spread,
    /// Rms without it.
    pub before: FitAndValidationRms,
    /// Rms with it.
    pub after: FitAndValidationRms,
}

/// The largest law of a choice of which the held-out logs support each term; `None` if they support none.
#[must_use]
pub fn judged(
    chosen: &Chosen,
    [fitted, held_out]: [&Samples<'_>; 2],
    options: &SearchOptions,
) -> Option<Judged> {
    let held_out = held_out.normal(&chosen.library.terms);
    let total = Normal::sum(chosen.blocks.iter())?;
    let left =
        |subset: &Subset| held_out.iter().map(|block| block.squares_with(&subset.coefficients)).sum::<f64>();
    let (best, held_out_t) = (1..=chosen.size).rev().find_map(|size| {
        let best = chosen.by_size[size].first()?;
        let t = chosen.library.t_of_terms(&held_out, best);
        let is_better = |&term: &usize| {
            let others = best.terms.iter().copied().filter(|&other| other != term).collect();
            let without = chosen.library.fitted(&total, others, 1.0);
            without.is_some_and(|without| left(best) * price(options) < left(&without))
        };
        let is_supported = t.iter().all(|t| *t >= options.min_t_of(held_out.len()));
        (is_supported && best.terms.iter().all(is_better)).then_some((best, t))
    })?;
    let alike = rivals(chosen, best, options);
    let of_folds = of_folds(chosen, best.terms.len(), options);
    let with = chosen.library.with_coefficients(best);
    let spread = Spread::of(fitted, &with);
    let squares = chosen.library.squares_of_terms(&chosen.blocks, best);
    let law: Vec<(&Term, f64)> = with.iter().zip(squares).collect();
    let terms = law.iter().zip(held_out_t).enumerate().map(|(index, (&(term, squares), held_out_t))| {
        let has = |law: &[Term]| law.iter().any(|other| chosen.is_same_form(term, other));
        FoundTerm {
            rivals: replaced(chosen, term, (&with, &alike)),
            shadowed_by: shadow(&law, (term, squares)),
            beside_ambiguous: None,
            is_in_all_folds: of_folds.iter().all(|law| has(law)),
            half_widths: spread.of_coefficients(index),
            amplitude_half_width: spread.of_amplitude(index, term),
            length_half_width: spread.of_length(index),
            held_out_t,
            term: term.clone(),
        }
    });
    let terms = terms.collect();
    let rms = |blocks: &[Normal], coefficients: &[(usize, f64)]| {
        let squares: f64 = blocks.iter().map(|block| block.squares_with(coefficients)).sum();
        let samples: usize = blocks.iter().map(|block| block.samples).sum();
        (squares / samples.max(1) as f64).sqrt()
    };
    let both = |coefficients: &[(usize, f64)]| FitAndValidationRms {
        fit: rms(&chosen.blocks, coefficients),
        validate: rms(&held_out, coefficients),
    };
    let without = chosen.library.fitted(&total, Vec::new(), 1.0)?;
    Some(Judged {
        constant: best.coefficients[0].1,
        terms,
        spread,
        before: both(&without.coefficients),
        after: both(&best.coefficients),
    })
}

/// The laws of the same size that these logs do not distinguish from the best one: the difference is below the significance of an
/// ambiguity, or what they leave beyond the best is below the price of a value.
fn rivals(chosen: &Chosen, best: &Subset, options: &SearchOptions) -> Vec<Vec<Term>> {
    let is_alike = |other: &&Subset| {
        other.terms != best.terms
            && (other.squares < price(options) * best.squares
                || improvement_t(&chosen.blocks, other, best) < MAX_AMBIGUOUS_T)
    };
    let alike = chosen.by_size[best.terms.len()].iter().filter(is_alike);
    alike.map(|subset| chosen.library.with_coefficients(subset)).collect()
}

/// The terms that replace a term in rival laws, each once.
fn replaced(chosen: &Chosen, term: &Term, (best, rivals): (&[Term], &[Vec<Term>])) -> Vec<Term> {
    let is_in = |law: &[Term], one: &Term| law.iter().any(|other| chosen.is_same_form(one, other));
    let mut all: Vec<Term> = Vec::new();
    for law in rivals.iter().filter(|law| !is_in(law, term)) {
        for other in law.iter().filter(|other| !is_in(best, other)) {
            if !is_in(&all, other) {
                all.push(other.clone());
            }
        }
    }
    all
}

/// A term of a law that depends on the motions of a small one, and is so large that the small one may be what its form lacks. `law`: the terms, each with Σ of its
/// square.
fn shadow(law: &[(&Term, f64)], (small, of_small): (&Term, f64)) -> Option<Term> {
    let is_of_its_motion = |large: &Term| {
        let has = |other: bool| large.variables().iter().any(|one| one.is_of_other_axis() == other);
        small.variables().iter().all(|one| has(one.is_of_other_axis()))
    };
    let least = MIN_SHADOW_RATIO.powi(2) * of_small;
    let large = law.iter().find(|(term, squares)| *squares >= least && is_of_its_motion(term));
    large.map(|(term, _)| (*term).clone())
}

/// The best law of the same size of the samples without each fold.
fn of_folds(chosen: &Chosen, size: usize, options: &SearchOptions) -> Vec<Vec<Term>> {
    let law = |fold: usize| {
        let total = Normal::sum(chosen.blocks.iter().filter(|block| block.fold != fold))?;
        let by_size = chosen.library.best(&total, size, price(options));
        Some(chosen.library.with_coefficients(by_size[size].first()?))
    };
    (0..FOLDS).map(|fold| law(fold).unwrap_or_default()).collect()
}
