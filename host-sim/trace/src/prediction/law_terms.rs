//! The terms of laws along a log.

use super::table_variable::values;
use crate::input::signals::Signals;
use crate::input::smoothing::Smooth;
use model::effects::Stage;
use model::residual_law::{Hysteresis, Term, Variables};
use model::residual_table::TableVariable;

/// The values of some variables of an axis over one log.
#[derive(Clone, Debug)]
pub struct LogVariables<'a> {
    values: Vec<(TableVariable, Vec<f64>)>,
    samples: usize,
    /// The channel whose filter the residual has passed; none in the motor stage.
    filter: Option<&'a Smooth>,
}

/// The values at one sample.
struct AtSample<'a> {
    log: &'a LogVariables<'a>,
    sample: usize,
}

impl<'a> LogVariables<'a> {
    /// The values of the variables that the log contains, for the residual of a stage.
    #[must_use]
    pub fn new(signals: &'a Signals, axis: usize, stage: Stage, variables: &[TableVariable]) -> Self {
        let values = variables.iter().filter_map(|&one| Some((one, values(signals, axis, one)?))).collect();
        let motion = signals.axes[axis].table_or_motor();
        let filter = motion.filter(|_| stage != Stage::Motor);
        Self { values, samples: signals.len(), filter }
    }

    /// Whether a term can be evaluated: its variables were measured.
    #[must_use]
    pub fn has(&self, term: &Term) -> bool {
        let is_known = |one: &TableVariable| self.values.iter().any(|(known, _)| known == one);
        term.variables().iter().all(is_known)
    }

    /// The parts of a term over the samples. Where it jumps, it passes the filter of the residual.
    #[must_use]
    pub fn parts(&self, term: &Term) -> [Vec<f64>; 2] {
        let mut hysteresis = Hysteresis::default();
        let at = |sample| term.parts(&AtSample { log: self, sample }, &mut hysteresis).into();
        let (first, second): (Vec<f64>, Vec<f64>) = (0..self.samples).map(at).unzip();
        match self.filter.filter(|_| term.has_jumps()) {
            Some(filter) => [filter.filtered(&first), second],
            None => [first, second],
        }
    }
}

impl Variables for AtSample<'_> {
    fn value(&self, variable: TableVariable) -> f64 {
        let known = self.log.values.iter().find(|(known, _)| *known == variable);
        known.and_then(|(_, values)| values.get(self.sample)).copied().unwrap_or(0.0)
    }
}
