//! The budget of what a trace has found, and the JSON of a trace with it.

use compensate::prediction::PredictionError;
use files::format::significant;
use files::log::Unit;
use model::effects::Stage;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::Serialize;
use serde_json::Value;
use trace::input::signals::Signals;
use trace::stages::stage_names;
use trace::{AxisIdentification, Identification};

use crate::Budget;
use crate::json;
use crate::motions::{Travel, standard};

/// Seed of the noise of the sensors.
const SEED: u64 = 1;

/// The JSON of `lost-motion trace --json`: the result of the trace, and the error budget of its model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "Result of lost-motion trace")]
pub struct Document {
    #[serde(flatten)]
    trace: trace::json::Document,
    /// What each cause costs at the tool on standard motions; `null` if the model has no linear axis or cannot be simulated.
    budget: Option<json::Document>,
}

impl Document {
    /// The result of a trace with the budget of its model.
    #[must_use]
    pub fn of(trace: trace::json::Document, budget: Option<&Budget>) -> Self {
        Self { trace, budget: budget.map(json::Document::of) }
    }

    /// The document as a JSON value.
    #[must_use]
    pub fn value(&self) -> Value {
        // Nothing in it can fail: its keys are texts.
        serde_json::to_value(self).unwrap_or_default()
    }
}

/// The JSON schema of [`Document`].
#[must_use]
pub fn schema() -> Value {
    let generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    generator.into_root_schema_for::<Document>().to_value()
}

/// The budget of the model of a trace, on standard motions within the travel of its logs; `None` if no linear axis was traced.
///
/// # Errors
/// If the model cannot be simulated.
pub fn budget(trace: &Identification) -> Result<Option<Budget>, PredictionError> {
    let linear = trace.axes().iter().enumerate().filter(|(_, axis)| axis.unit == Unit::Millimetre);
    let logs = || trace.fit_logs().iter().chain(trace.validate_logs());
    let travels: Vec<Travel> = linear
        .filter_map(|(index, axis)| {
            let ends_mm = logs().filter_map(|log| travelled_mm(log, index)).reduce(joined)?;
            Some(Travel { axis: axis.axis.clone(), ends_mm })
        })
        .collect();
    if travels.is_empty() {
        return Ok(None);
    }
    let mut budget = Budget::of(&trace.better_machine(), &standard(&travels), SEED)?;
    budget.notes.extend(trace.axes().iter().flat_map(unexplained));
    Ok(Some(budget))
}

/// What remains of the positions of an axis behind its motor, as a sentence each: no simulation has it.
fn unexplained(axis: &AxisIdentification) -> impl Iterator<Item = String> {
    let stages = [Stage::Table, Stage::Tool];
    let left = axis.unexplained.iter().filter(move |left| stages.contains(&left.stage));
    left.map(|left| {
        format!(
            "{}, {}: {} µm rms are explained by nothing that was found, and are not in the budget.",
            axis.axis,
            stage_names(&[left.stage]),
            significant(left.rms, 2)
        )
    })
}

/// Ends of the travel of an axis in a log, mm: of its command, else of the position that was measured.
fn travelled_mm(log: &Signals, axis: usize) -> Option<[f64; 2]> {
    let axis = log.axes.get(axis)?;
    let values = axis.command.as_deref().or_else(|| axis.motor.as_ref().map(|motor| &motor.value[..]))?;
    let ends_m = values.iter().map(|value| [*value, *value]).reduce(joined)?;
    (ends_m[1] > ends_m[0]).then_some(ends_m.map(|m| 1e3 * m))
}

fn joined([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a.min(c), b.max(d)]
}
