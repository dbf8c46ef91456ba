//! What limits the contour error that a compensation leaves.
//!
//! The motions are executed once more without the noise of the sensors, then also without their resolution. What is left is
//! divided into what the model predicts with such sensors, which is due to the bandwidth of the loops and to effects without a
//! compensation, and the rest, which the model does not describe. The parts are root mean squares; their squares add up.

use rayon::prelude::*;
use serde_json::{Value, json};

use crate::compensate::file::CompensationFile;
use crate::compensate::prediction::{self, PredictionError, TestMotion, contour_error, total_rms_um};
use crate::compensate::round_trip::{MachineUnderTest, Sensing, with_sensing};
use model::machine::Machine;
use plant::instruments::Instruments;

/// The parts of a contour error, µm rms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Due to the noise of the sensors.
    pub noise_um: f64,
    /// Due to their resolution.
    pub resolution_um: f64,
    /// That the model predicts with ideal sensors: bandwidth of the loops, effects without a compensation.
    pub loops_um: f64,
    /// That the model does not describe.
    pub unmodelled_um: f64,
}

/// A part of a contour error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Limit {
    /// Noise of the sensors.
    Noise,
    /// Resolution of the sensors.
    Resolution,
    /// Bandwidth of the loops, and effects without a compensation.
    Loops,
    /// What the model does not describe.
    Unmodelled,
}

impl Limit {
    /// Every part.
    pub const ALL: [Self; 4] = [Self::Noise, Self::Resolution, Self::Loops, Self::Unmodelled];

    /// A word for a table.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Noise => "noise",
            Self::Resolution => "resolution",
            Self::Loops => "bandwidth",
            Self::Unmodelled => "unmodelled",
        }
    }
}

impl Limits {
    /// From the contour errors with the sensors as they are, without noise, and ideal, and from the one that is predicted with
    /// ideal sensors, µm rms.
    #[must_use]
    pub fn of(installed_um: f64, noiseless_um: f64, ideal_um: f64, predicted_um: f64) -> Self {
        let without = |whole: f64, part: f64| (whole.powi(2) - part.powi(2)).max(0.0).sqrt();
        Self {
            noise_um: without(installed_um, noiseless_um),
            resolution_um: without(noiseless_um, ideal_um),
            loops_um: predicted_um.min(ideal_um),
            unmodelled_um: without(ideal_um, predicted_um),
        }
    }

    /// Measures them on a machine with a compensation, whose contour error with the sensors as they are is `after_um`.
    ///
    /// # Errors
    /// If a motion cannot be simulated.
    pub fn measure(
        machine_under_test: &dyn MachineUnderTest,
        (model, instruments): (&Machine, Instruments),
        file: &CompensationFile,
        tests: &[TestMotion],
        after_um: f64,
    ) -> Result<Self, PredictionError> {
        let measured = |sensing| {
            let errors: Result<Vec<_>, _> = tests
                .par_iter()
                .map(|test| contour_error(&machine_under_test.log(file, test, 0, sensing)?, model))
                .collect();
            Ok::<f64, PredictionError>(total_rms_um(&errors?))
        };
        let ideal = with_sensing(instruments, Sensing::Ideal);
        let predicted = prediction::contour_errors(model, file, tests, ideal)?;
        Ok(Self::of(
            after_um,
            measured(Sensing::Noiseless)?,
            measured(Sensing::Ideal)?,
            total_rms_um(&predicted),
        ))
    }

    /// A part, µm rms.
    #[must_use]
    pub const fn part_um(&self, limit: Limit) -> f64 {
        match limit {
            Limit::Noise => self.noise_um,
            Limit::Resolution => self.resolution_um,
            Limit::Loops => self.loops_um,
            Limit::Unmodelled => self.unmodelled_um,
        }
    }

    /// The largest part.
    #[must_use]
    pub fn largest(&self) -> Limit {
        let larger = |a, b| if self.part_um(b) > self.part_um(a) { b } else { a };
        Limit::ALL.into_iter().reduce(larger).unwrap_or(Limit::Noise)
    }

    /// As a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        format!(
            "What is left: {:.3} µm rms are due to the noise of the sensors, {:.3} µm to their resolution, {:.3} µm to the bandwidth \
             of the loops and to effects without a compensation, and {:.3} µm are not described by the model (the squares add up).",
            self.noise_um, self.resolution_um, self.loops_um, self.unmodelled_um
        )
    }

    /// As JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "noise_um": self.noise_um,
            "resolution_um": self.resolution_um,
            "bandwidth_um": self.loops_um,
            "unmodelled_um": self.unmodelled_um,
            "largest": self.largest().word(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_squares_of_the_parts_add_up() {
        let limits = Limits::of(0.5, 0.4, 0.35, 0.3);
        let sum: f64 = Limit::ALL.iter().map(|limit| limits.part_um(*limit).powi(2)).sum();
        assert!((sum - 0.25).abs() < 1e-12, "{limits:?}");
        // 0.5² − 0.4² = 0.3²; 0.4² − 0.35² = 0.19²; 0.35² − 0.3² = 0.18².
        assert!((limits.noise_um - 0.3).abs() < 1e-12);
        assert_eq!(Limits::of(0.5, 0.2, 0.1, 0.05).largest(), Limit::Noise);
        assert_eq!(Limits::of(0.5, 0.5, 0.1, 0.05).largest(), Limit::Resolution);
        assert_eq!(Limits::of(0.5, 0.5, 0.5, 0.5).largest(), Limit::Loops);
        assert_eq!(Limits::of(0.5, 0.5, 0.5, 0.1).largest(), Limit::Unmodelled);
    }

    #[test]
    fn a_prediction_above_the_measured_error_leaves_nothing_unmodelled() {
        let limits = Limits::of(0.5, 0.5, 0.4, 0.6);
        assert!((limits.loops_um - 0.4).abs() < 1e-12 && limits.unmodelled_um.abs() < 1e-12, "{limits:?}");
    }
}
