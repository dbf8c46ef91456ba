//! What of a model is beyond what the controller can compensate.

use crate::compensate::choice::{Choice, Part};
use crate::compensate::file::{CompensationFile, Refused};
use crate::compensate::planning::Planning;
use crate::compensate::prediction::PredictionError;

impl Planning<'_> {
    /// Checks that the controller takes the compensation of all parts of the model.
    ///
    /// # Errors
    /// The part without which it would take that of its axis, or the setting that it refuses.
    pub(crate) fn check_capacity(&self) -> Result<(), PredictionError> {
        let all = Choice::default();
        let Some(refused) = self.file(&all)?.refused(self.model) else { return Ok(()) };
        for part in self.parts() {
            let without = self.file(&all.without(&part))?;
            if !is_refused(&without, &refused, self) {
                return Err(self.beyond(&part, refused));
            }
        }
        Err(refused.into())
    }

    fn beyond(&self, part: &Part, refused: Refused) -> PredictionError {
        let (name, _) = self.names(part);
        PredictionError::Beyond { part: name, refused }
    }
}

/// Whether the axis is still refused.
fn is_refused(file: &CompensationFile, refused: &Refused, planning: &Planning<'_>) -> bool {
    file.refused(planning.model).is_some_and(|other| other.axis == refused.axis)
}
