//! What a trace does with a machine file, and what all of its steps work with.

use files::log::Log;
use model::machine::Machine;

use crate::options::TraceOptions;

/// Called with a message for each step of the trace, from several threads.
pub type Progress<'a> = dyn Fn(&str) + Sync + 'a;

/// Fit logs and validation logs. Without validation logs the last quarter of each fit log is held out.
pub type Logs<'a> = [&'a [Log]; 2];

/// What a trace does with a machine file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Task {
    /// Searches for effects that the file lacks. "Before" is the declared model fitted, "after" that with the effects.
    #[default]
    Search,
    /// Evaluates the file without a search. "Before" is the file with the values that it contains, where only the zeros
    /// and sampling instants of the logs are fitted; "after" is the file with its declared values fitted.
    Evaluate,
}

/// What is asked of a trace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Request {
    /// What it does with the machine file.
    pub task: Task,
    /// Whether residuals that no effect describes become tables of the model, where held-out data confirm them.
    pub tables: bool,
}

/// What each step of a trace works with, besides the value that it takes from the step before.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The declared machine.
    pub machine: &'a Machine,
    /// The thresholds.
    pub options: &'a TraceOptions,
    /// What is asked.
    pub request: Request,
    /// Called with a message for each step.
    pub progress: &'a Progress<'a>,
}
