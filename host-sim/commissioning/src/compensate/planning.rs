//! From what a compensation is planned.

use crate::compensate::choice::{Choice, Strength};
use crate::compensate::file::CompensationFile;
use crate::compensate::prediction::{PredictionError, TestMotion};
use crate::compensate::servo::MOST_AHEAD_TICKS;
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

impl Planning<'_> {
    /// The compensation of everything that the model gives reason for, without the search of [`Planning::plan`] for what of it helps; `None`: it
    /// gives no reason for any. The velocity feed-forward is ahead by the tick by which its difference is late, and by the time constant of a
    /// drive whose velocity is commanded.
    ///
    /// # Errors
    /// If the controller has too few settings for the model, or a motion does not fit the machine.
    pub fn everything(&self) -> Result<Option<CompensationFile>, PredictionError> {
        if self.parts().is_empty() {
            return Ok(None);
        }
        self.check_capacity()?;
        let tick_s = self.tick_s();
        let ahead_s = (tick_s + self.drive_time_constant_s()).min(MOST_AHEAD_TICKS * tick_s);
        let strength = Strength { ahead_s, ..Strength::default() };
        self.file(&Choice { strength, ..Choice::default() }).map(Some)
    }
}
