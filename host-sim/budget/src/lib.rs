//! The error budget: how much each cause contributes to the error of a motion at the tool, in µm.
//!
//! The closed loop of a model is simulated with all causes, with each alone, and with each removed. From these, each cause gets its
//! share of the mean square of the contour error; the shares add up to the whole.
//!
//! - [`cause`]: the causes of a machine, and the machine with some of them
//! - [`sizes`]: the figures of a contour error
//! - [`radial`]: the radial deviation over the angle, for a picture
//! - [`share`]: the rule that assigns shares to causes that act together
//! - [`simulation`]: the contour errors with each cause alone, and without it
//! - [`of_motion`]: the budget of a motion
//! - [`interval`]: the uncertainty of a share, from that of the values of its cause
//! - [`remedy`]: what to do about a cause
//! - [`limits`]: whether figures at the tool are within limits
//! - [`traced`]: the budget of the model found by a trace
//! - [`json`], [`text`]: the result for a file, and for a terminal

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod cause;
pub mod interval;
pub mod json;
pub mod limits;
pub mod of_motion;
pub mod radial;
pub mod remedy;
pub mod share;
pub mod simulation;
pub mod sizes;
pub mod text;
pub mod traced;

use commissioning::compensate::prediction::{PredictionError, TestMotion};
use model::machine::Machine;
use plant::equivalent::{self, Assumed};

pub use of_motion::{CauseShare, MotionBudget};

/// The budget of each motion, with the assumptions of its simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Budget {
    /// Name of the machine.
    pub machine: String,
    /// The motions, in the order in which they were given.
    pub motions: Vec<MotionBudget>,
    /// Assumptions about axes whose loops or masses are not known.
    pub assumed: Vec<Assumed>,
    /// What is not in the budget, one sentence each.
    pub notes: Vec<String>,
}

impl Budget {
    /// The share of an effect of an axis on the motion on which it is greatest, with that motion; `None` if the budget has no such effect, or
    /// several.
    #[must_use]
    pub fn of_effect(&self, axis: &str, name: &str) -> Option<(&MotionBudget, &CauseShare)> {
        let only = |motion: &'_ MotionBudget| {
            let mut own = motion.causes.iter();
            let is_it = |cause: &CauseShare| cause.name == name && cause.axis.as_deref() == Some(axis);
            let first = own.position(is_it)?;
            (!own.any(is_it)).then_some(first)
        };
        let shares = self.motions.iter().filter_map(|motion| Some((motion, &motion.causes[only(motion)?])));
        shares.max_by(|(_, a), (_, b)| a.share.rms.total_cmp(&b.share.rms))
    }

    /// The budget of a model on motions; `seed` is that of the noise of its sensors.
    ///
    /// # Errors
    /// If a motion does not fit the machine, or the machine does not complete it.
    pub fn of(model: &Machine, tests: &[TestMotion], seed: u64) -> Result<Self, PredictionError> {
        let (model, mut notes) = cause::simulated(model);
        let motions: Vec<MotionBudget> =
            tests.iter().map(|test| MotionBudget::of(&model, test, seed)).collect::<Result<_, _>>()?;
        if model.instruments.is_none() {
            notes.push(
                "Noise and resolution of the sensors are not in the machine file ([instruments]): they are not in the budget."
                    .to_owned(),
            );
        }
        let not_compensated =
            motions.iter().filter_map(|motion| Some((&motion.name, motion.not_compensated.as_ref()?)));
        notes.extend(
            not_compensated.map(|(name, why)| format!("{name}: not simulated with a compensation: {why}.")),
        );
        let with_residuals = model.axis.iter().filter(|(_, axis)| axis.has_residuals());
        notes.extend(with_residuals.map(|(name, _)| {
            format!("{name}: a table or a law of a residual has no cause, and stands in the budget as `unexplained`.")
        }));
        Ok(Self { machine: model.name.clone(), motions, assumed: equivalent::of(&model).1, notes })
    }
}
