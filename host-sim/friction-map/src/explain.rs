//! The result of a map: the declared and the selected law, and their errors on runs that were left out.

use rayon::prelude::*;

use super::law::Law;
use super::map::{FrictionMap, Run};
use super::ranges::ranges;
use super::selection::{Candidate, MIN_DEGREES_OF_FREEDOM, Selection, select};
use super::term::{TERMS, Term};

/// Maximum number of folds of the cross-validation, each of which repeats the whole selection; maps with fewer runs
/// leave out one run at a time.
const MAX_FOLDS: usize = 64;

/// Root mean square errors of runs, in the unit of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Error of all runs under the law that was fitted to them.
    pub fit: f64,
    /// Error of runs that were left out; the selection was repeated without them.
    pub left_out: f64,
    /// Error of ranges of speed that were left out; the selection was repeated without each range.
    pub ranges_left_out: f64,
}

/// The result of a map.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// The selection from all runs.
    pub selection: Selection,
    /// Errors of the declared law.
    pub before: Errors,
    /// Errors of the selected law.
    pub after: Errors,
    /// Terms that the map cannot show, with the missing runs.
    pub not_testable: Vec<(Term, String)>,
}

impl Explanation {
    /// Reduction of the rms error of left-out runs when a selected term was added, percent.
    #[must_use]
    pub fn reduction_percent(&self, term: Term) -> f64 {
        let mut added = self.selection.rounds.iter().filter_map(|round| round.added());
        let reduction = added.find(|candidate| candidate.term == term).map_or(0.0, |c| c.reduction);
        numerics::rms_reduction_percent(reduction)
    }

    /// Terms that left-out runs supported as well as the added one, and that are not part of the law. The map does not
    /// distinguish them.
    #[must_use]
    pub fn equally_good(&self, term: Term) -> Vec<Term> {
        let is_added = |candidate: &Candidate| candidate.term == term;
        let round = self.selection.rounds.iter().find(|round| round.added().is_some_and(is_added));
        let Some((round, added)) = round.and_then(|round| Some((round, round.added()?))) else {
            return Vec::new();
        };
        let trials = round.candidates.len();
        let is_in_law =
            |term: Term| self.selection.fitted.law.terms.iter().any(|held| held.name() == term.name());
        let equal = round.candidates.iter().filter(|c| !is_in_law(c.term) && c.is_as_good_as(added, trials));
        equal.map(|candidate| candidate.term).collect()
    }
}

/// Explains a map; `None` if its runs do not determine Coulomb and viscous friction.
#[must_use]
pub fn explain(map: &FrictionMap) -> Option<Explanation> {
    let selection = select(map, &map.runs)?;
    let folds = map.runs.len().min(MAX_FOLDS);
    let fold_of: Vec<usize> = (0..map.runs.len()).map(|i| i % folds).collect();
    let [by_run, by_range] = [fold_of, ranges(&map.runs)].map(|fold_of| cross_validation(map, &fold_of));
    let rms = |law: &Law| numerics::rms(map.runs.iter().map(|run| run.force - law.force(run.velocity)));
    Some(Explanation {
        before: Errors {
            fit: rms(&selection.declared.law),
            left_out: by_run[0],
            ranges_left_out: by_range[0],
        },
        after: Errors { fit: rms(&selection.fitted.law), left_out: by_run[1], ranges_left_out: by_range[1] },
        not_testable: not_testable(map),
        selection,
    })
}

/// Rms errors of the declared and of the selected law. Each fold is predicted by laws selected on the other folds. NaN if
/// these do not determine a law. `fold_of` is the fold of each run.
fn cross_validation(map: &FrictionMap, fold_of: &[usize]) -> [f64; 2] {
    let folds = fold_of.iter().max().map_or(0, |last| last + 1);
    let of_fold = |fold: usize| {
        let (out, seen): (Vec<_>, Vec<_>) = map.runs.iter().zip(fold_of).partition(|(_, f)| **f == fold);
        let seen: Vec<Run> = seen.into_iter().map(|(run, _)| *run).collect();
        let selection = select(map, &seen)?;
        let squares =
            |law: &Law| out.iter().map(|(run, _)| (run.force - law.force(run.velocity)).powi(2)).sum::<f64>();
        Some([squares(&selection.declared.law), squares(&selection.fitted.law)])
    };
    let squares: Vec<Option<[f64; 2]>> = (0..folds).into_par_iter().map(of_fold).collect();
    let rms = |which: usize| {
        let all: Option<Vec<f64>> = squares.iter().map(|s| s.map(|s| s[which])).collect();
        all.map_or(f64::NAN, |all| (all.iter().sum::<f64>() / fold_of.len().max(1) as f64).sqrt())
    };
    [rms(0), rms(1)]
}

/// The terms that a map cannot show, with the missing runs.
fn not_testable(map: &FrictionMap) -> Vec<(Term, String)> {
    let mut all = Vec::new();
    for term in TERMS {
        let min_runs = 2 + term.parameter_count() + MIN_DEGREES_OF_FREEDOM;
        if !map.has_both_directions() && term.is_directional() {
            all.push((term, "runs in both directions".to_owned()));
        } else if map.runs.len() < min_runs {
            all.push((term, format!("{min_runs} runs that move or more")));
        }
    }
    all
}
