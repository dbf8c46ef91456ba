//! What a fit to the logs as a whole needs of the fit to their stretches.

use super::exclusion::Exclusion;
use super::scope::Scope;
use super::scope_fit::ScopeFit;

/// A scope as it was fitted.
#[derive(Clone, Debug)]
pub struct FittedScope {
    /// The scope of the last fit.
    pub scope: Scope,
    /// Exclusions from its residuals.
    pub exclusions: Vec<Exclusion>,
    /// Weight of each series of its residuals, by log, then by stage.
    pub weights: Vec<f64>,
}

impl FittedScope {
    /// The scopes of some fits, each once.
    #[must_use]
    pub fn of(fits: &[ScopeFit]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for ScopeFit { fitted_scope, fitted, exclusions, .. } in fits {
            if all.iter().all(|other| other.scope != *fitted_scope) {
                let (scope, exclusions) = (fitted_scope.clone(), exclusions.clone());
                all.push(Self { scope, exclusions, weights: fitted.weights.clone() });
            }
        }
        all
    }

    /// The weights of the stages over one log.
    #[must_use]
    pub fn weights_of_log(&self, log: usize) -> &[f64] {
        let stages = self.scope.stages.len();
        self.weights.get(log * stages..(log + 1) * stages).unwrap_or_default()
    }
}
