//! The verdict: whether the model explains the logs.

use serde::Serialize;

use crate::data_faults::FaultHandling;
use crate::outcome::{AxisTrace, StageResidual, Trace};

/// Agreement of model and logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
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
pub fn of(trace: &Trace) -> Verdict {
    if trace.axes.iter().all(|axis| axis.residuals.is_empty()) {
        return Verdict::Unexplained;
    }
    trace.axes.iter().map(of_axis).max().unwrap_or(Verdict::Explained)
}

/// The verdict on one axis.
#[must_use]
pub fn of_axis(axis: &AxisTrace) -> Verdict {
    if axis.is_of_another_machine || axis.residuals.iter().any(is_gross) {
        Verdict::ModelDoesNotFit
    } else if !axis.unexplained.is_empty()
        || axis.residuals.iter().any(is_gross_held_out)
        || axis.data_faults.iter().any(|fault| fault.treatment == FaultHandling::Removed)
    {
        Verdict::Unexplained
    } else {
        Verdict::Explained
    }
}

/// Whether the model does not describe a stage of the fitted logs.
#[must_use]
pub fn is_gross(error: &StageResidual) -> bool {
    error.beside_exclusions.fit > error.max_described
}

/// Whether the model does not describe a stage of the validation logs. As their motion may differ from that of the fitted
/// logs, this does not show that the model describes another machine.
#[must_use]
pub fn is_gross_held_out(error: &StageResidual) -> bool {
    error.beside_exclusions.validate > error.max_described
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fit_data::FitAndValidationRms;
    use crate::options::VerdictOptions;
    use model::effects::Stage;

    fn error(fit: f64, validate: f64, noise: f64) -> StageResidual {
        let [before, after] = [FitAndValidationRms { fit, validate }; 2];
        let max_described = VerdictOptions::default().max_described(noise);
        StageResidual { stage: Stage::Table, before, after, beside_exclusions: after, noise, max_described }
    }

    #[test]
    fn an_error_is_gross_relative_to_noise_and_to_the_resolution_of_a_log() {
        assert!(is_gross(&error(0.51, 0.0, 0.01)) && !is_gross(&error(0.49, 9.0, 0.01)));
        assert!(is_gross_held_out(&error(0.0, 0.51, 0.01)) && !is_gross_held_out(&error(9.0, 0.49, 0.01)));
        // Without noise, one nanometre is assumed.
        assert!(is_gross(&error(0.051, 0.0, 0.0)) && !is_gross(&error(0.049, 0.0, 0.0)));
    }
}
