//! What a trace does with a machine file.

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
