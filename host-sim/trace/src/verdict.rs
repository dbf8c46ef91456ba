//! What a trace comes to in a word.

use serde::Serialize;

use super::Trace;
use super::axis::{AxisTrace, StageError};

/// A residual that stays so many times above its noise is none of a model that describes the log: less than one part in
/// two thousand of its power is noise. Machines that are described leave less, be it with small effects outside the
/// catalogue: the measured axis EMPS 29 times the noise of its encoder, a robot 22, the demo machines at most 25. Logs with
/// a scale that slips or sticks, a wrong sign or unit, or masses three times too large leave a hundred times and more.
const GROSS: f64 = 50.0;

/// No log of positions is finer than this, µm or mdeg, and no model holds to less.
const FINEST: f64 = 1e-3;

/// How far model and logs agree in the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The fitted logs down to their noise.
    Explained,
    /// More than noise stays.
    Unexplained,
    /// So much stays that the model is none of the logs' machine, or a channel is wrong.
    ModelDoesNotFit,
}

/// Of all axes: the worst. Where no stage of any could be formed, nothing is explained.
#[must_use]
pub fn of(trace: &Trace) -> Verdict {
    if trace.axes.iter().all(|axis| axis.errors.is_empty()) {
        return Verdict::Unexplained;
    }
    trace.axes.iter().map(of_axis).max().unwrap_or(Verdict::Explained)
}

/// Of one axis.
#[must_use]
pub fn of_axis(axis: &AxisTrace) -> Verdict {
    if axis.errors.iter().any(is_gross) {
        Verdict::ModelDoesNotFit
    } else if !axis.unexplained.is_empty() || axis.errors.iter().any(is_gross_held_out) {
        Verdict::Unexplained
    } else {
        Verdict::Explained
    }
}

/// Whether a stage of the fitted logs is not described by the model.
#[must_use]
pub fn is_gross(error: &StageError) -> bool {
    error.after.fit > GROSS * error.noise.max(FINEST)
}

/// The same of the validation logs. The fitted ones may not have asked as much of the model: that is said, but does not
/// make the model one of another machine.
#[must_use]
pub fn is_gross_held_out(error: &StageError) -> bool {
    error.after.validate > GROSS * error.noise.max(FINEST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Pair;
    use model::effects::Stage;

    fn error(fit: f64, validate: f64, noise: f64) -> StageError {
        let [before, after] = [Pair { fit, validate }; 2];
        StageError { stage: Stage::Table, before, after, noise }
    }

    #[test]
    fn gross_is_measured_in_noise_and_in_what_a_log_resolves() {
        assert!(is_gross(&error(0.51, 0.0, 0.01)) && !is_gross(&error(0.49, 9.0, 0.01)));
        assert!(is_gross_held_out(&error(0.0, 0.51, 0.01)) && !is_gross_held_out(&error(9.0, 0.49, 0.01)));
        // Without noise: a nanometre stands for it.
        assert!(is_gross(&error(0.051, 0.0, 0.0)) && !is_gross(&error(0.049, 0.0, 0.0)));
    }
}
