//! Pitch error over the travel: the screw moves the table too far, or the scale reads too much.

use super::motion::CommandMotion;
use super::names::points_names;
use super::settings::{self, PitchSource};
use super::table::{Table, ValueRange};
use crate::config::ConfigError;
use crate::scalar::Scalar;
use crate::units::LENGTH_M;

/// A table for each direction of travel, or one for both.
#[derive(Clone, Copy, Debug)]
pub struct Pitch<S: Scalar> {
    forward: Table<S>,
    backward: Option<Table<S>>,
    source: PitchSource,
}

impl<S: Scalar> Pitch<S> {
    /// From settings in m.
    ///
    /// # Errors
    /// [`ConfigError`] with a setting of `pitch`.
    pub fn new(settings: &settings::Pitch, bound_m: f64) -> Result<Self, ConfigError> {
        let range = ValueRange { unit: LENGTH_M, bound: bound_m };
        Ok(Self {
            forward: Table::new(&points_names!("pitch.forward"), &settings.forward, range)?,
            backward: settings
                .backward
                .as_ref()
                .map(|points| Table::new(&points_names!("pitch.backward"), points, range))
                .transpose()?,
            source: settings.of,
        })
    }

    /// Source of the error.
    pub(super) const fn source(&self) -> PitchSource {
        self.source
    }

    /// Correction of the command, error units: − the error of a screw, + the error of a scale.
    #[must_use]
    pub fn correction(&self, own: &CommandMotion<S>) -> S {
        let table = match &self.backward {
            Some(backward) if !own.forward => backward,
            _ => &self.forward,
        };
        let error = table.at(own.position);
        match self.source {
            PitchSource::Screw => -error,
            PitchSource::Scale => error,
        }
    }
}
