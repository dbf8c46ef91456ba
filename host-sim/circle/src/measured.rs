//! A measured circle, from whatever file.

use std::f64::consts::{PI, TAU};

use numerics::wrapped;

use super::samples::Samples;

/// Angle after a reversal in which a spike may be, rad.
const AFTER_REVERSAL_RAD: f64 = 15.0 * PI / 180.0;

/// Steps of the sampling around a reversal that are left out: on which side of it a sample is, is not known.
const AT_REVERSAL_STEPS: f64 = 1.5;

/// Tolerance of the angle at which an arc starts, rad.
const START_RAD: f64 = 1e-3;

/// Smallest deviation of a reading from its neighbours that is a fault, in typical deviations, and µm.
const FAULT_DEVIATIONS: f64 = 20.0;
const FAULT_UM: f64 = 20.0;

/// Channels of the tool: that of a log, and the radius of a ballbar.
const AT_TOOL: [&str; 2] = ["tool", "radius"];

/// A measured circle with what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// File name given by the user, for messages.
    pub source: String,
    /// Names of the axes.
    pub axes: [String; 2],
    /// What was measured: `tool`, `table`, `motor` or `radius`.
    pub channel: &'static str,
    /// Whether the nominal radius is known.
    pub has_nominal_radius: bool,
    /// Time by which both axes follow the command, s, if command and position were measured.
    pub delay_s: Option<f64>,
    /// The samples.
    pub samples: Samples,
    /// Angle from the start of each arc to its first sample, rad.
    pub starts_rad: Vec<f64>,
    /// What was assumed or left out.
    pub notes: Vec<String>,
}

impl Measured {
    /// Whether it was measured at the tool.
    #[must_use]
    pub fn is_at_tool(&self) -> bool {
        AT_TOOL.contains(&self.channel)
    }

    /// The samples that are not at a reversal, and whose last reversals were on the same arc or are further behind than a spike. What
    /// happened before the start of an arc is not known.
    #[must_use]
    pub fn after_known_reversals(&self) -> Samples {
        let samples = &self.samples;
        let at_reversal = AT_REVERSAL_STEPS * samples.step_rad();
        let mut is_known = vec![true; samples.instants.len()];
        for (arc, start_rad) in samples.arcs.iter().zip(&self.starts_rad) {
            let mut travelled = *start_rad;
            for i in arc.clone() {
                if i > arc.start {
                    travelled +=
                        wrapped(samples.instants[i].angle - samples.instants[i - 1].angle, TAU).abs();
                }
                is_known[i] = (0..2).all(|axis| {
                    let since = samples.instants[i].since_reversal(axis);
                    let is_behind = since > AFTER_REVERSAL_RAD || travelled > since + START_RAD;
                    is_behind && since.min(PI - since) > at_reversal
                });
            }
        }
        samples.filtered(|i| is_known[i])
    }
}

/// Readings that are far from both neighbours on either side: faults of the data.
#[must_use]
pub fn faults(values: &[f64]) -> Vec<usize> {
    let from_median = |i: usize| {
        let around = &values[i.saturating_sub(2)..(i + 3).min(values.len())];
        (values[i] - numerics::median(around).unwrap_or(values[i])).abs()
    };
    let deviations: Vec<f64> = (0..values.len()).map(from_median).collect();
    let typical = 1.4826 * numerics::median(&deviations).unwrap_or(0.0);
    let limit = FAULT_UM.max(FAULT_DEVIATIONS * typical);
    (0..values.len()).filter(|&i| deviations[i] > limit).collect()
}
