//! One round, and when its compensation is kept.

use commissioning::compensate::file::CompensationFile;
use commissioning::compensate::plan::Plan;
use commissioning::compensate::prediction::total_rms_um;
use commissioning::margins::MarginLimits;
use commissioning::margins::change::first_too_little;
use contour::ContourError;
use contour::verification::{is_better, is_worse};
use model::machine::Machine;
use plant::instruments::Instruments;
use trace::AxisIdentification;
use trace::Identification;
use trace::verdict::{self, Verdict};

/// One round: what was traced, and the motions before, as predicted, and after.
pub struct Round {
    /// The trace of all logs so far.
    pub trace: Identification,
    /// The traced machine.
    pub model: Machine,
    /// Its compensation.
    pub plan: Plan,
    /// Contour error of each motion with the compensation kept so far, without the error of the probe that the traced machine knows.
    pub before: Vec<ContourError>,
    /// Contour error of each motion with this round's compensation, as predicted.
    pub predicted: Vec<ContourError>,
    /// Contour error of each motion with this round's compensation, as measured.
    pub after: Vec<ContourError>,
}

impl Round {
    /// Whether the traced model describes the logs of every axis.
    #[must_use]
    pub fn fits(&self) -> bool {
        verdict::of(&self.trace) != Verdict::ModelDoesNotFit
    }

    /// Whether the compensation is kept: its model describes the logs, at least one motion became better by more than chance, and
    /// none became worse. What a model that does not fit makes better on these motions, it can make worse on others.
    #[must_use]
    pub fn is_kept(&self) -> bool {
        let is = |changed: fn(&ContourError, &ContourError) -> bool| {
            self.before.iter().zip(&self.after).any(|(before, after)| changed(before, after))
        };
        self.fits() && is(is_better) && !is(is_worse)
    }

    /// Rms over all motions before, as predicted, and after, µm.
    #[must_use]
    pub fn totals_um(&self) -> [f64; 3] {
        [&self.before, &self.predicted, &self.after].map(|errors| total_rms_um(errors))
    }

    /// The effects found in this round, as `axis: name`; and the axes whose logs the model does not describe.
    #[must_use]
    pub fn found_words(&self) -> String {
        let found = match self.trace.found_names() {
            found if found.is_empty() => "nothing new".to_owned(),
            found => found.join(", "),
        };
        let is_wrong = |axis: &&AxisIdentification| verdict::of_axis(axis) == Verdict::ModelDoesNotFit;
        let wrong: Vec<&str> =
            self.trace.axes().iter().filter(is_wrong).map(|axis| axis.axis.as_str()).collect();
        if wrong.is_empty() {
            return found;
        }
        format!("{found}; the model does not describe the logs of {}", wrong.join(", "))
    }
}

/// Whether a compensation leaves the loops of a machine their margins. A machine without the keys that the margins follow from
/// has none to keep.
#[must_use]
pub fn keeps_margins(file: &CompensationFile, machine: &Machine, limits: MarginLimits) -> bool {
    let instruments = Instruments::of(machine, 0);
    !matches!(first_too_little(machine, &file.applied_to(machine), &instruments, limits), Ok(Some(_)))
}
