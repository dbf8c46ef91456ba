//! The verdict: whether the model explains the logs.

use schemars::JsonSchema;
use serde::Serialize;

use super::identification::{AxisIdentification, Identification};
use crate::data_faults::FaultHandling;
use crate::judge::axis_findings::StageResidual;

/// Agreement of model and logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The residual of the fitted logs is at the level of the noise.
    Explained,
    /// The residual exceeds the noise, or a channel with a fault could not be used.
    Unexplained,
    /// The residual is so large that the model describes another machine, or a channel is wrong.
    ModelDoesNotFit,
}

/// The verdict on a machine: the worst of its axes. `Unexplained` if no stage of any axis could be evaluated.
#[must_use]
pub fn of(trace: &Identification) -> Verdict {
    if trace.axes.iter().all(|axis| axis.residuals.is_empty()) {
        return Verdict::Unexplained;
    }
    trace.axes.iter().map(of_axis).max().unwrap_or(Verdict::Explained)
}

/// The verdict on one axis.
#[must_use]
pub fn of_axis(axis: &AxisIdentification) -> Verdict {
    if axis.is_undescribed() {
        Verdict::ModelDoesNotFit
    } else if !axis.unexplained.is_empty()
        || axis.residuals.iter().any(StageResidual::is_gross_held_out)
        || axis.data_faults.iter().any(|fault| fault.treatment == FaultHandling::Removed)
    {
        Verdict::Unexplained
    } else {
        Verdict::Explained
    }
}
