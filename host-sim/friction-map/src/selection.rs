//! Forward selection of terms by their errors on runs that were left out of the fit, and backward elimination at the end.

use numerics::distributions::f_test_p_value;

use super::fit::{Fit, fit, fit_with};
use super::law::Law;
use super::map::{FrictionMap, Run};
use super::ranges::left_out_squares;
use super::term::{TERMS, Term};

/// Significance level of one round over all its terms: the probability of adding a term to a complete law.
pub const MAX_P_VALUE: f64 = 0.01;

/// Minimum relative reduction of the sum of squares on left-out runs by a term.
pub const MIN_REDUCTION: f64 = 0.04;

/// Laws whose sum of squares on left-out runs is within this factor of the smallest one count as equally good.
pub const EQUALLY_GOOD: f64 = 1.2;

/// Maximum number of terms.
const MAX_TERMS: usize = 5;

/// Degrees of freedom that a fit must leave.
pub(crate) const MIN_DEGREES_OF_FREEDOM: usize = 3;

/// A term that was tried in a round.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The term.
    pub term: Term,
    /// The fit of the law with the term.
    pub fit: Fit,
    /// Relative reduction of the sum of squares on left-out runs; negative if the sum increases.
    pub reduction: f64,
    /// Relative reduction of the sum of squares on left-out ranges of speed; NaN if another criterion is not met.
    pub range_reduction: f64,
    /// p value of the F test of this term against the law without it, for one trial.
    pub p_value: f64,
    /// Whether no friction coefficient is negative.
    pub is_physical: bool,
}

impl Candidate {
    /// Whether left-out runs and ranges support the term; `trials` is the number of terms in the round (Bonferroni).
    #[must_use]
    pub fn is_supported(&self, trials: usize) -> bool {
        self.is_physical
            && self.p_value * trials as f64 <= MAX_P_VALUE
            && self.reduction >= MIN_REDUCTION
            && self.range_reduction > 0.0
    }

    /// Whether the term is supported in its round and as good as another candidate.
    #[must_use]
    pub fn is_as_good_as(&self, other: &Self, trials: usize) -> bool {
        self.is_supported(trials) && 1.0 - self.reduction < EQUALLY_GOOD * (1.0 - other.reduction)
    }
}

/// One round: all terms that were tried, and the added one.
#[derive(Clone, Debug)]
pub struct Round {
    /// Candidates by descending reduction.
    pub candidates: Vec<Candidate>,
    /// Index of the added candidate.
    pub added: Option<usize>,
}

impl Round {
    fn new(mut candidates: Vec<Candidate>) -> Self {
        candidates.sort_by(|a, b| b.reduction.total_cmp(&a.reduction));
        let trials = candidates.len();
        let best = candidates.iter().find(|candidate| candidate.is_supported(trials));
        let added = best.and_then(|best| {
            let equal = candidates.iter().enumerate().filter(|(_, c)| c.is_as_good_as(best, trials));
            // Among equally good candidates, the first with the fewest parameters is added.
            equal.min_by_key(|(_, candidate)| candidate.term.parameter_count()).map(|(index, _)| index)
        });
        Self { candidates, added }
    }

    /// The added candidate.
    #[must_use]
    pub fn added(&self) -> Option<&Candidate> {
        self.added.map(|index| &self.candidates[index])
    }
}

/// The selected law and the rounds of its selection.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Fit of Coulomb and viscous friction only.
    pub declared: Fit,
    /// Fit with the selected terms, in the order in which they were added.
    pub fitted: Fit,
    /// The rounds.
    pub rounds: Vec<Round>,
    /// Terms that were added and dropped again, as later ones made them unnecessary.
    pub dropped: Vec<Term>,
}

/// Selects the law that the runs support; `None` if they do not determine the declared law.
#[must_use]
pub fn select(map: &FrictionMap, runs: &[Run]) -> Option<Selection> {
    let top_speed = numerics::max_abs(map.runs.iter().map(|run| run.velocity));
    let declared = fit(map, runs, &Law::declared(top_speed))?;
    let mut fitted = declared.clone();
    let mut rounds = Vec::new();
    while fitted.law.terms.len() < MAX_TERMS {
        let terms = testable(map, runs, &fitted.law);
        let round = Round::new(terms.filter_map(|term| candidate(map, runs, &fitted, term)).collect());
        let best = round.added().map(|added| added.fit.clone());
        rounds.push(round);
        let Some(best) = best else { break };
        fitted = best;
    }
    let mut dropped = Vec::new();
    while let Some((term, without)) = unnecessary(map, runs, &fitted) {
        dropped.push(term);
        fitted = without;
    }
    Some(Selection { declared, fitted, rounds, dropped })
}

/// Terms that a law lacks and that the runs can determine. A law contains at most one form of Stribeck friction.
fn testable<'a>(map: &'a FrictionMap, runs: &'a [Run], law: &'a Law) -> impl Iterator<Item = Term> + 'a {
    let has_both_directions = map.has_both_directions();
    let count: usize = 2 + law.terms.iter().map(|term| term.parameter_count()).sum::<usize>();
    TERMS.into_iter().filter(move |term| {
        (has_both_directions || !term.is_directional())
            && runs.len() >= count + term.parameter_count() + MIN_DEGREES_OF_FREEDOM
            && law.terms.iter().all(|present| present.name() != term.name())
    })
}

fn candidate(map: &FrictionMap, runs: &[Run], base: &Fit, term: Term) -> Option<Candidate> {
    let fit = fit_with(map, runs, &base.law, term)?;
    let base_press = base.press().max(f64::MIN_POSITIVE);
    let mut candidate = Candidate {
        term,
        reduction: 1.0 - fit.press() / base_press,
        range_reduction: 1.0,
        p_value: p_value(base, &fit),
        is_physical: is_physical(&fit),
        fit,
    };
    // Each range requires a fit. Ranges are therefore evaluated last, and only if the other criteria are met for one trial.
    if candidate.is_supported(1) {
        let [before, after] = [&base.law, &candidate.fit.law].map(|law| left_out_squares(map, runs, law));
        candidate.range_reduction = 1.0 - after / before.max(f64::MIN_POSITIVE);
    } else {
        candidate.range_reduction = f64::NAN;
    }
    Some(candidate)
}

/// p value of the F test of two nested fits.
fn p_value(without: &Fit, with: &Fit) -> f64 {
    let count = with.parameter_count - without.parameter_count;
    let free = with.degrees_of_freedom();
    if free == 0 {
        return 1.0;
    }
    let gained = (without.squares - with.squares) / count as f64;
    f_test_p_value(gained / (with.squares / free as f64).max(f64::MIN_POSITIVE), count, free)
}

/// Whether no friction coefficient is negative. Coulomb and viscous friction may be negative within their intervals.
fn is_physical(fit: &Fit) -> bool {
    let half_widths = fit.half_widths();
    let may_be_negative = |i: usize| i >= 2 && fit.law.terms[i - 2].is_directional();
    fit.law.sizes.iter().enumerate().all(|(i, &size)| {
        let margin = if i < 2 { half_widths[i] } else { 0.0 };
        may_be_negative(i) || size > -margin
    })
}

/// The least significant of the unnecessary terms, and the fit without it.
fn unnecessary(map: &FrictionMap, runs: &[Run], full: &Fit) -> Option<(Term, Fit)> {
    if full.law.terms.len() < 2 {
        return None;
    }
    let one = |index: usize| {
        let (law, term) = full.law.without(index);
        let without = fit(map, runs, &law)?;
        let p_value = p_value(&without, full);
        (p_value * TERMS.len() as f64 > MAX_P_VALUE).then_some((p_value, term, without))
    };
    let all = (0..full.law.terms.len()).filter_map(one);
    all.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, term, without)| (term, without))
}
