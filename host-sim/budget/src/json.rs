//! The budget as JSON; see `docs/budget.md`.

use schemars::JsonSchema;
use serde::Serialize;

use crate::Budget;
use crate::of_motion::{CauseShare, MotionBudget};
use crate::sizes::Sizes;

/// The error budget of a model: what each cause costs at the tool.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "ErrorBudget")]
pub struct Document {
    motions: Vec<Motion>,
    /// What is assumed of axes whose loops or masses are not known.
    assumed: Vec<String>,
    notes: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "BudgetOfMotion")]
struct Motion {
    name: String,
    whole_um: Sizes,
    /// With a compensation of everything that the model gives reason for; `null`: it gives none, or it was not simulated.
    compensated_um: Option<Sizes>,
    /// Largest first.
    causes: Vec<Cause>,
    sum_um: Sum,
    /// Part of the mean square that the causes make together and that is shared in proportion.
    shared_in_proportion_percent: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "SumOfShares")]
struct Sum {
    rms: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "CauseShare")]
struct Cause {
    #[serde(rename = "cause")]
    name: &'static str,
    /// Empty: all axes together.
    axis: String,
    um: Sizes,
    /// Of the rms; `null`: unknown.
    ci95: Option<[f64; 2]>,
    alone_um: Sizes,
    without_um: Sizes,
    /// Its share where everything is compensated.
    compensated_um: Option<Sizes>,
    certainty: &'static str,
    rivals: Vec<String>,
    remedy: String,
}

impl Document {
    /// The document of a budget.
    #[must_use]
    pub fn of(budget: &Budget) -> Self {
        Self {
            motions: budget.motions.iter().map(Motion::of).collect(),
            assumed: budget.assumed.iter().map(plant::equivalent::Assumed::sentence).collect(),
            notes: budget.notes.clone(),
        }
    }
}

impl Motion {
    fn of(motion: &MotionBudget) -> Self {
        Self {
            name: motion.name.clone(),
            whole_um: motion.whole,
            compensated_um: motion.compensated,
            causes: motion.causes.iter().map(Cause::of).collect(),
            sum_um: Sum { rms: motion.sum_um() },
            shared_in_proportion_percent: 100.0 * motion.shared_in_proportion,
        }
    }
}

impl Cause {
    fn of(share: &CauseShare) -> Self {
        Self {
            name: share.name,
            axis: share.axis.clone().unwrap_or_default(),
            um: share.share,
            ci95: share.interval_um,
            alone_um: share.alone,
            without_um: share.without,
            compensated_um: share.compensated,
            certainty: share.certainty.word(),
            rivals: share.rivals.clone(),
            remedy: share.remedy.clone(),
        }
    }
}
