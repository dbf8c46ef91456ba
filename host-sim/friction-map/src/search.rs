//! Terms added one at a time, each judged on runs that were left out.

use numerics::distributions::{f_test_p_value, student_t_975};
use rayon::prelude::*;

use super::fit::{Fitted, Law, fit, fit_with, weights};
use super::law::{TERMS, Term};
use super::{FrictionMap, Run};

/// Greatest chance of adding anything to a map that lacks nothing, in one round over all terms.
pub const CHANCE: f64 = 0.01;

/// A term must take this share of the squares of left-out runs away.
pub const LEAST_REDUCTION: f64 = 0.04;

/// Most terms that a map may gain.
const MOST_TERMS: usize = 5;

/// Degrees of freedom that a fit must leave.
const LEAST_FREE: usize = 3;

/// Most folds in which the whole search is repeated; up to here each is one run.
const MOST_FOLDS: usize = 64;

/// A term as tried in one round.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The term.
    pub term: Term,
    /// The law with it.
    pub fitted: Fitted,
    /// Share of the squares of left-out runs that it takes away.
    pub reduction: f64,
    /// The same where whole ranges of speed are left out; not a number where the rest has decided already.
    pub range_reduction: f64,
    /// Chance that a law without it gives so much, in one trial (F test).
    pub chance: f64,
    /// Whether all sizes are such as friction can have.
    pub is_physical: bool,
}

impl Candidate {
    /// Whether left-out runs and ranges support it beyond chance; `tried` is the number of terms in the round.
    #[must_use]
    pub fn is_supported(&self, tried: usize) -> bool {
        self.is_physical
            && self.chance * tried as f64 <= CHANCE
            && self.reduction >= LEAST_REDUCTION
            && self.range_reduction > 0.0
    }
}

/// One round: all terms that were tried, best first, and the one that was added.
#[derive(Clone, Debug)]
pub struct Round {
    /// By what they leave on left-out runs.
    pub candidates: Vec<Candidate>,
    /// Index of the one that was added.
    pub added: Option<usize>,
}

/// What the search ended with.
#[derive(Clone, Debug)]
pub struct Searched {
    /// Coulomb and viscous friction alone.
    pub declared: Fitted,
    /// With the terms found, in the order in which they were added.
    pub fitted: Fitted,
    /// The rounds.
    pub rounds: Vec<Round>,
    /// Terms that were added and that later ones made needless.
    pub dropped: Vec<Term>,
}

/// Root mean square errors of runs, in the unit of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Of the runs that were fitted.
    pub fit: f64,
    /// Of runs left out one by one, the whole search done again without each.
    pub left_out: f64,
    /// Of whole ranges of speed left out, the whole search done again without each.
    pub ranges_left_out: f64,
}

/// What a map told.
#[derive(Clone, Debug)]
pub struct Explained {
    /// From all runs.
    pub searched: Searched,
    /// The declared law's errors.
    pub before: Errors,
    /// The found law's errors.
    pub after: Errors,
    /// Terms that the map cannot show, and what it would take.
    pub not_testable: Vec<(Term, String)>,
}

/// Explains a map.
#[must_use]
pub fn explain(map: &FrictionMap) -> Option<Explained> {
    let searched = search(map, &map.runs)?;
    let folds = map.runs.len().min(MOST_FOLDS);
    let fold_of: Vec<usize> = (0..map.runs.len()).map(|i| i % folds).collect();
    let by_range = ranges(&map.runs);
    let [by_run, by_range] = [fold_of, by_range].map(|fold_of| held_out(map, &fold_of));
    let rms = |law: &Law| {
        let squares = map.runs.iter().map(|run| (run.force - law.force(run.velocity)).powi(2));
        (squares.sum::<f64>() / map.runs.len() as f64).sqrt()
    };
    Some(Explained {
        before: Errors {
            fit: rms(&searched.declared.law),
            left_out: by_run[0],
            ranges_left_out: by_range[0],
        },
        after: Errors { fit: rms(&searched.fitted.law), left_out: by_run[1], ranges_left_out: by_range[1] },
        not_testable: not_testable(map),
        searched,
    })
}

/// Errors of the declared and of the found law on runs that neither fit nor choice has seen.
fn held_out(map: &FrictionMap, fold_of: &[usize]) -> [f64; 2] {
    let folds = fold_of.iter().max().map_or(0, |last| last + 1);
    let of_fold = |fold: usize| {
        let (out, seen): (Vec<_>, Vec<_>) = map.runs.iter().zip(fold_of).partition(|(_, f)| **f == fold);
        let seen: Vec<Run> = seen.into_iter().map(|(run, _)| *run).collect();
        let searched = search(map, &seen)?;
        let squares =
            |law: &Law| out.iter().map(|(run, _)| (run.force - law.force(run.velocity)).powi(2)).sum::<f64>();
        Some([squares(&searched.declared.law), squares(&searched.fitted.law)])
    };
    let squares: Vec<Option<[f64; 2]>> = (0..folds).into_par_iter().map(of_fold).collect();
    let sum = |which: usize| {
        let all: Option<Vec<f64>> = squares.iter().map(|s| s.map(|s| s[which])).collect();
        all.map_or(f64::NAN, |all| (all.iter().sum::<f64>() / fold_of.len().max(1) as f64).sqrt())
    };
    [sum(0), sum(1)]
}

/// Contiguous ranges of speed, each way for itself: the number of the range of each run, by rising velocity.
#[must_use]
pub fn ranges(runs: &[Run]) -> Vec<usize> {
    let backward = runs.iter().filter(|run| run.velocity < 0.0).count();
    let mut numbers = Vec::with_capacity(runs.len());
    let mut next = 0;
    for count in [backward, runs.len() - backward] {
        if count == 0 {
            continue;
        }
        // Five ranges each way, of no fewer than two runs.
        let parts = (count / 2).clamp(1, 5);
        numbers.extend((0..count).map(|i| next + i * parts / count));
        next += parts;
    }
    numbers
}

/// The law that the runs support.
#[must_use]
pub fn search(map: &FrictionMap, runs: &[Run]) -> Option<Searched> {
    let top = numerics::max_abs(map.runs.iter().map(|run| run.velocity));
    let declared = Law { terms: Vec::new(), sizes: vec![0.0; 2], shapes: Vec::new(), top };
    let declared = fit(map, runs, &declared)?;
    let mut fitted = declared.clone();
    let mut rounds = Vec::new();
    while fitted.law.terms.len() < MOST_TERMS {
        let mut candidates: Vec<Candidate> =
            tried(map, runs, &fitted.law).filter_map(|term| tried_out(map, runs, &fitted, term)).collect();
        candidates.sort_by(|a, b| b.reduction.total_cmp(&a.reduction));
        let added = chosen(&candidates);
        let best = added.map(|index| candidates[index].fitted.clone());
        rounds.push(Round { candidates, added });
        let Some(best) = best else { break };
        fitted = best;
    }
    let mut dropped = Vec::new();
    while let Some((needless, without)) = needless(map, runs, &fitted) {
        dropped.push(needless);
        fitted = without;
    }
    Some(Searched { declared, fitted, rounds, dropped })
}

/// Laws whose left-out errors (squares) are within this of the best are as good.
pub const AS_GOOD: f64 = 1.2;

/// The best candidate that is supported, or a simpler one that is as good.
fn chosen(candidates: &[Candidate]) -> Option<usize> {
    let count = candidates.len();
    let best = candidates.iter().find(|candidate| candidate.is_supported(count))?;
    let as_good =
        |c: &Candidate| c.is_supported(count) && 1.0 - c.reduction < AS_GOOD * (1.0 - best.reduction);
    let all = candidates.iter().enumerate().filter(|(_, candidate)| as_good(candidate));
    all.min_by_key(|(_, candidate)| candidate.term.width()).map(|(index, _)| index)
}

/// Terms that a law lacks and that the runs can show. Stribeck friction has one form at a time.
fn tried<'a>(map: &'a FrictionMap, runs: &'a [Run], law: &'a Law) -> impl Iterator<Item = Term> + 'a {
    let two_way = map.is_two_way();
    let width: usize = 2 + law.terms.iter().map(|term| term.width()).sum::<usize>();
    TERMS.into_iter().filter(move |term| {
        (two_way || !term.is_one_way())
            && runs.len() >= width + term.width() + LEAST_FREE
            && law.terms.iter().all(|there| there.name() != term.name())
    })
}

/// What a map cannot show, and why.
fn not_testable(map: &FrictionMap) -> Vec<(Term, String)> {
    let mut all = Vec::new();
    for term in TERMS {
        let least = 2 + term.width() + LEAST_FREE;
        if !map.is_two_way() && term.is_one_way() {
            all.push((term, "runs in both directions".to_owned()));
        } else if map.runs.len() < least {
            all.push((term, format!("{least} runs that move or more")));
        }
    }
    all
}

fn tried_out(map: &FrictionMap, runs: &[Run], base: &Fitted, term: Term) -> Option<Candidate> {
    let fitted = fit_with(map, runs, &base.law, term)?;
    let base_out = base.left_out().max(f64::MIN_POSITIVE);
    let mut candidate = Candidate {
        term,
        reduction: 1.0 - fitted.left_out() / base_out,
        range_reduction: 1.0,
        chance: chance(base, &fitted),
        is_physical: is_physical(&fitted),
        fitted,
    };
    // The ranges cost a fit each: they are asked last, with the least that a round can ask.
    if candidate.is_supported(1) {
        let [before, after] = [&base.law, &candidate.fitted.law].map(|law| without_ranges(map, runs, law));
        candidate.range_reduction = 1.0 - after / before.max(f64::MIN_POSITIVE);
    } else {
        candidate.range_reduction = f64::NAN;
    }
    Some(candidate)
}

/// Chance of so much smaller squares by a term that is not there.
fn chance(without: &Fitted, with: &Fitted) -> f64 {
    let width = with.width - without.width;
    let free = with.free();
    if free == 0 {
        return 1.0;
    }
    let gained = (without.squares - with.squares) / width as f64;
    f_test_p_value(gained / (with.squares / free as f64).max(f64::MIN_POSITIVE), width, free)
}

/// Weighted squares of ranges of speed that were left out; without bound where a fit is not determined.
fn without_ranges(map: &FrictionMap, runs: &[Run], law: &Law) -> f64 {
    let numbers = ranges(runs);
    let weights = weights(runs);
    let count = numbers.last().map_or(0, |last| last + 1);
    let of_range = |range: usize| {
        let seen: Vec<Run> =
            runs.iter().zip(&numbers).filter(|(_, n)| **n != range).map(|(run, _)| *run).collect();
        let Some(fitted) = fit(map, &seen, law) else { return f64::INFINITY };
        let out = runs.iter().zip(&weights).zip(&numbers).filter(|(_, n)| **n == range);
        out.map(|((run, weight), _)| (weight * (run.force - fitted.law.force(run.velocity))).powi(2)).sum()
    };
    (0..count).map(of_range).sum()
}

/// Whether no friction is less than none, beyond what its interval leaves open.
fn is_physical(fitted: &Fitted) -> bool {
    let half = half_widths(fitted);
    let signed = |i: usize| i >= 2 && fitted.law.terms[i - 2].is_one_way();
    fitted.law.sizes.iter().enumerate().all(|(i, &size)| {
        let room = if i < 2 { half[i] } else { 0.0 };
        signed(i) || size > -room
    })
}

/// Half widths of the 95 % intervals of all sizes, then of the logarithms of the free shapes.
#[must_use]
pub fn half_widths(fitted: &Fitted) -> Vec<f64> {
    let spread = student_t_975(fitted.free()) * fitted.scatter();
    fitted.covariance.diagonal().iter().map(|variance| spread * variance.max(0.0).sqrt()).collect()
}

/// A term that can go without the others missing it, and the law without it.
fn needless(map: &FrictionMap, runs: &[Run], full: &Fitted) -> Option<(Term, Fitted)> {
    if full.law.terms.len() < 2 {
        return None;
    }
    let one = |index: usize| {
        let mut law = full.law.clone();
        let term = law.terms.remove(index);
        law.sizes.remove(index + 2);
        law.shapes.remove(index);
        let without = fit(map, runs, &law)?;
        let chance = chance(&without, full);
        (chance * TERMS.len() as f64 > CHANCE).then_some((chance, term, without))
    };
    let all = (0..full.law.terms.len()).filter_map(one);
    all.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, term, without)| (term, without))
}
