//! What is traced in the logs of a compensated machine.
//!
//! The model of the motor stage is a loop without compensation. It would explain the compensation itself, so that in later rounds
//! only force, table and tool are traced, each driven by the measured signal before it.

use files::error::InputError;
use files::log::Log;
use model::machine::Machine;
use trace::Identification;

/// The logs of all rounds.
pub struct Logs {
    /// Logs of the fit: of every round.
    pub fit: Vec<Log>,
    /// Logs of the motions whose contour error counts: of the last round.
    pub judged: Vec<Log>,
}

impl Logs {
    /// The logs of the first round.
    #[must_use]
    pub const fn new(fit: Vec<Log>, judged: Vec<Log>) -> Self {
        Self { fit, judged }
    }

    /// Traces the logs with a model.
    ///
    /// # Errors
    /// If a log cannot be traced.
    pub fn trace(
        &self,
        model: &Machine,
        is_compensated: bool,
        progress: &(dyn Fn(&str) + Sync),
    ) -> Result<Identification, InputError> {
        let open = if is_compensated { without_loops(model) } else { model.clone() };
        trace::trace(&open, &self.fit, &self.judged, progress)
    }
}

/// A machine whose loops are not declared, so that its motor stage is not modelled.
fn without_loops(machine: &Machine) -> Machine {
    let mut machine = machine.clone();
    for axis in machine.axis.values_mut() {
        axis.settings.controller.law = None;
    }
    machine
}

/// A traced machine with the loops that another one declares.
#[must_use]
pub fn with_loops_of(machine: &Machine, declared: &Machine) -> Machine {
    let mut machine = machine.clone();
    for (name, axis) in &mut machine.axis {
        if let Some(declared) = declared.axis.get(name) {
            axis.settings.controller.law = declared.settings.controller.law;
        }
    }
    machine
}
