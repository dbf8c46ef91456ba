//! From what a compensation is planned.

use crate::compensate::prediction::TestMotion;
use model::machine::Machine;
use plant::instruments::Instruments;

/// From what a compensation is planned.
#[derive(Clone, Copy, Debug)]
pub struct Planning<'a> {
    /// The model, with the effects found.
    pub model: &'a Machine,
    /// Its file.
    pub model_file: &'a str,
    /// The motions whose contour error counts.
    pub tests: &'a [TestMotion],
    /// Further motions that may not become worse: see [`crate::compensate::standard_motions`].
    pub watched: &'a [TestMotion],
    /// Sensors and drives of the machine.
    pub instruments: Instruments,
    /// Time on the session clock at which the compensation is set, s.
    pub set_at_s: f64,
}
