//! Proposes settings of the loops from the identified plant: Kv, Ti and notches for the velocity loop, then law, feedback, Kp and
//! velocity feed-forward for the position loop, each as fast as given margins allow. The simulated contour error decides.
//!
//! - [`velocity_loop`]: the fastest velocity loop of an axis
//! - [`measured`]: loops with other settings, from a measured frequency response
//! - [`candidate`]: the position loops that are tried
//! - [`error`]: why there is no proposal
//! - [`outcome`]: the proposal as text and JSON

pub mod candidate;
pub mod error;
pub mod measured;
pub mod outcome;
pub mod velocity_loop;

#[cfg(test)]
mod measured_tests;
#[cfg(test)]
mod tests;

pub use error::TuningError;

use rayon::prelude::*;

use crate::compensate::file::CompensationFile;
use crate::compensate::prediction::{TestMotion, contour_errors, total_rms_um};
use crate::margins::MarginLimits;
use crate::margins::axis_margins::{self, AxisLoops, AxisMargins};
use candidate::Candidate;
use measured::MeasuredAxis;
use model::machine::Machine;
use outcome::{Proposal, Tried};
use plant::instruments::Instruments;

/// What is tuned, and for what.
#[derive(Clone, Copy)]
pub struct Tuning<'a> {
    /// The machine, with the effects found.
    pub machine: &'a Machine,
    /// Its sensors and drives.
    pub instruments: Instruments,
    /// Margins of every loop.
    pub limits: MarginLimits,
    /// The motions whose contour error decides.
    pub tests: &'a [TestMotion],
    /// Axes whose frequency response was measured: their loops have the margins as measured, too.
    pub measured: &'a [MeasuredAxis],
}

impl Tuning<'_> {
    /// Tries the position loops on the fastest velocity loops.
    ///
    /// # Errors
    /// If the machine lacks a key, cannot be simulated, or an axis has no velocity loop with the margins.
    pub fn propose(&self) -> Result<Proposal, TuningError> {
        let declared = self.tried(self.machine.clone(), None)?;
        let fast = velocity_loop::fastest(self.machine, &self.instruments, self.limits, self.measured)?;
        let candidates = candidate::of_machine(&fast, self.measured);
        let tried = candidates.into_par_iter().filter_map(|candidate| {
            let machine =
                candidate.applied_to(&fast, &self.instruments, self.limits, self.measured).transpose()?;
            Some(machine.map_err(TuningError::from).and_then(|machine| self.tried(machine, Some(candidate))))
        });
        let mut tried: Vec<Tried> = tried.collect::<Result<_, _>>()?;
        tried.sort_by(Tried::cmp_error);
        Ok(Proposal { declared, tried, limits: self.limits })
    }

    /// Margins and contour error of a machine with its settings.
    fn tried(&self, machine: Machine, candidate: Option<Candidate>) -> Result<Tried, TuningError> {
        let none = CompensationFile::none(&machine);
        let margins: Vec<AxisMargins> = axis_margins::of_machine(&machine, &self.instruments, self.limits)?;
        // An unstable loop stops at a fault: its contour error is that of no motion.
        let is_stable =
            margins.iter().all(|axis| axis.velocity.unstable.or(axis.position.unstable).is_none());
        let contour_um = if is_stable {
            Some(total_rms_um(&contour_errors(&machine, &none, self.tests, self.instruments)?))
        } else {
            None
        };
        let loops = AxisLoops::of_machine(&machine, &self.instruments)?;
        let measured = self.measured.iter().map(|axis| axis.loops(&loops[axis.index])).collect();
        Ok(Tried { candidate, machine, margins, measured, contour_um })
    }
}
