//! One round of the search.

use super::ambiguity::Ambiguity;
use super::candidates::Candidate;
use crate::fit::limits::ParameterAtLimit;
use crate::options::SearchOptions;
use model::effects::Stage;

/// One round of the search: the candidates, and which of them was added.
#[derive(Clone, Debug)]
pub struct Round {
    /// The scope's stages.
    pub stages: Vec<Stage>,
    /// All candidates, best first.
    pub candidates: Vec<Candidate>,
    /// Index of the one that was added: the best of those that held-out data support.
    pub added: Option<usize>,
    /// Candidates that explain as much as the one that was added.
    pub ambiguities: Vec<Ambiguity>,
    /// The thresholds of the search.
    pub options: SearchOptions,
}

impl Round {
    /// Index of the best candidate that gained much and was not added, except for a parameter at a limit, which is
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

/// The effects that the last rounds of searches would have added but for a parameter at a limit.
#[must_use]
pub fn refused_at_limit(rounds: &[Round]) -> Vec<ParameterAtLimit> {
    let last = rounds.iter().filter(|round| round.added.is_none());
    let limit = |round: &Round| {
        let supported = round.candidates.iter().filter(|candidate| candidate.stands_out(&round.options));
        supported.filter_map(|candidate| candidate.limit.clone()).collect::<Vec<_>>()
    };
    last.flat_map(limit).collect()
}
