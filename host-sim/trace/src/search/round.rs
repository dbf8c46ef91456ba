//! One round of the search.

use super::ambiguity::Ambiguity;
use super::candidates::Candidate;
use crate::dropped::Dropped;
use crate::fit::least_squares::Fitted;
use crate::fit::limits::ParameterAtLimit;
use crate::options::SearchOptions;
use model::effects::Stage;

/// One round of the search: all candidates, and the added one.
#[derive(Clone, Debug)]
pub struct Round {
    /// Stages of the scope.
    pub stages: Vec<Stage>,
    /// All candidates, best first; a candidate with fewer parameters that only chance separates from the best comes before it.
    pub candidates: Vec<Candidate>,
    /// Index of the added candidate: the first of those that held-out data support, or one that was added provisionally.
    pub added: Option<usize>,
    /// Candidates that explain the residual as well as the added one.
    pub ambiguities: Vec<Ambiguity>,
    /// Effects that were dropped after this round.
    pub dropped: Vec<Dropped>,
    /// The thresholds of the search.
    pub options: SearchOptions,
}

impl Round {
    /// Frees the memory of the fits of its candidates: their effects and comparisons remain.
    pub fn forget_data(&mut self) {
        let fits = self.candidates.iter_mut().filter_map(|candidate| candidate.fitted.as_mut());
        fits.for_each(Fitted::forget_data);
    }

    /// Index of the best candidate with a large gain that was not supported. Candidates with a parameter at a limit are
    /// reported separately.
    #[must_use]
    pub fn refused(&self) -> Option<usize> {
        let is_refused = |c: &Candidate| {
            c.gain > self.options.min_reported_gain
                && c.exceeds_tolerance
                && c.fitted.is_some()
                && c.limit.is_none()
                && !c.is_supported(&self.options)
        };
        self.candidates.iter().position(is_refused)
    }
}

/// The effects that the last rounds of the searches did not add only because a parameter was at a limit.
#[must_use]
pub fn refused_at_limit(rounds: &[Round]) -> Vec<ParameterAtLimit> {
    let last = rounds.iter().filter(|round| round.added.is_none());
    let limit = |round: &Round| {
        let supported =
            round.candidates.iter().filter(|candidate| candidate.passes_significance(&round.options));
        supported.filter_map(|candidate| candidate.limit.clone()).collect::<Vec<_>>()
    };
    last.flat_map(limit).collect()
}
