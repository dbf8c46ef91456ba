//! Pitch error: what the screw moves the table too far, or the scale reads too much, over the travel.

use super::motion::Motion;
use super::settings::{self, Of, Points};
use super::table::Table;
use crate::config::ConfigError;
use crate::scalar::Scalar;
use crate::units::LENGTH_M;

/// A table for each direction of travel, or one for both.
#[derive(Clone, Copy, Debug)]
pub struct Pitch<S: Scalar> {
    forward: Table<S>,
    backward: Option<Table<S>>,
    of: Of,
}

impl<S: Scalar> Pitch<S> {
    /// From settings in m.
    ///
    /// # Errors
    /// Names `pitch`.
    pub fn new(settings: &settings::Pitch, bound_m: f64) -> Result<Self, ConfigError> {
        let table = |points: &Points| over(points, "pitch", LENGTH_M, bound_m);
        Ok(Self {
            forward: table(&settings.forward)?,
            backward: settings.backward.as_ref().map(table).transpose()?,
            of: settings.of,
        })
    }

    /// What to add to the command, error units: minus what a screw moves too far, plus what a scale reads
    /// too much.
    #[must_use]
    pub fn correction(&self, own: &Motion<S>) -> S {
        let table = match &self.backward {
            Some(backward) if !own.forward => backward,
            _ => &self.forward,
        };
        let error = table.at(own.place);
        match self.of {
            Of::Screw => -error,
            Of::Scale => error,
        }
    }
}

/// A table from points.
///
/// # Errors
/// As [`Table::new`].
pub fn over<S: Scalar>(
    points: &Points,
    name: &'static str,
    unit: f64,
    bound: f64,
) -> Result<Table<S>, ConfigError> {
    Table::new(name, &points.values, points.start_m, points.spacing_m, unit, bound)
}
