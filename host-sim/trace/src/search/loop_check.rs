//! Check of mechanical candidates with the closed loop, which was not used in their fit.

use super::candidates::Candidate;
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::least_squares;
use crate::fit::scope::Scope;
use model::effects::{Effect, KINDS, Stage};

/// Largest number of steps of a fit to the closed loop.
const STEPS: usize = 3;

/// The check of candidates of one scope.
#[derive(Clone, Copy, Debug)]
pub struct LoopCheck<'a> {
    /// The logs, without exclusions.
    pub data: &'a FitData<'a>,
    /// The scope of the motor stage, if it can be evaluated.
    pub servo: Option<&'a Scope>,
    /// The scope on which the candidates were fitted.
    pub scope: &'a Scope,
}

/// What is fitted to the closed loop before it judges a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LoopState {
    /// Nothing.
    Declared,
    /// The mass and the timing of the loop. While these are wrong, they may leave so much that a correct force leaves more than a wrong one.
    Fitted,
}

impl LoopCheck<'_> {
    /// Whether held-out data support a candidate, and the residual of the closed loop does not increase much.
    ///
    /// If the scope is the force stage alone, a gain in the closed loop replaces the test of significance: friction that
    /// depends on the position or on the time since a reversal differs between blocks by its nature, which increases the
    /// standard error.
    #[must_use]
    pub fn supports(&self, base: &AxisModel, candidate: &Candidate) -> bool {
        let options = &self.data.options.search;
        let loss = |state| self.loss(base, candidate, state);
        let is_alone = self.scope.stages == [Stage::Force];
        if candidate.is_supported(options) {
            // Some loss is tolerated, as a correct friction may reveal another error in the model of the closed loop.
            let max = options.tolerable_loss(candidate.gain);
            let tolerates = |state| loss(state).is_none_or(|loss| loss <= max);
            return tolerates(LoopState::Declared) || tolerates(LoopState::Fitted);
        }
        let is_confirmed = || loss(LoopState::Declared).is_some_and(|loss| loss <= -options.min_gain());
        is_alone && changes_loop(candidate) && candidate.is_consistent(options) && is_confirmed()
    }

    /// Increase of the logarithm of the motor stage's rms caused by a candidate, averaged over the logs. `None` if the
    /// candidate does not change the loop or was fitted to it.
    fn loss(&self, base: &AxisModel, candidate: &Candidate, state: LoopState) -> Option<f64> {
        let (Some(servo), Some(fitted), true) = (self.servo, &candidate.fitted, changes_loop(candidate))
        else {
            return None;
        };
        if servo.stages == self.scope.stages {
            return None;
        }
        let [before, after] = [base, &fitted.model].map(|model| self.motor_residuals(model, servo, state));
        let of_log = |residuals: &[ResidualSeries], log: usize| {
            self.data.rms(&residuals[log..=log], Stage::Motor).max(1e-12)
        };
        let logs = before.len();
        let loss = (0..logs).map(|log| libm::log(of_log(&after, log) / of_log(&before, log))).sum::<f64>();
        Some(loss / logs.max(1) as f64)
    }

    /// The residuals of the motor stage. If the scope is the force stage alone, effects that hide the influence of friction on the
    /// loop are fitted first, although they are searched for later.
    fn motor_residuals(&self, model: &AxisModel, servo: &Scope, state: LoopState) -> Vec<ResidualSeries> {
        let has = |effect: &Effect| model.axis.effect.iter().any(|other| other.is_same(effect));
        let hiding = KINDS.iter().filter_map(|kind| (kind.hides_friction)());
        let is_alone = self.scope.stages == [Stage::Force];
        let missing: Vec<Effect> = hiding.filter(|effect| is_alone && !has(effect)).collect();
        if state == LoopState::Declared && missing.is_empty() {
            return self.data.residuals(model, servo);
        }
        let mut model = missing.into_iter().fold(model.clone(), |model, effect| model.with(effect));
        model.pin_mass(self.scope, 0.0);
        self.data.residuals(&least_squares::fit(self.data, &model, servo, STEPS).model, servo)
    }
}

fn changes_loop(candidate: &Candidate) -> bool {
    candidate.effect.stages().contains(&Stage::Motor)
}
