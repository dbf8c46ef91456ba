//! The budget of what a trace has found, and the JSON of a trace with it.

use commissioning::compensate::motions_within::{Travel, standard};
use commissioning::compensate::prediction::PredictionError;
use contour::log_error::LogError;
use contour::logged::log_name;
use files::format::significant;
use files::log::{Channel, Unit};
use model::effects::Stage;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::Serialize;
use serde_json::Value;
use trace::data_faults::DataFault;
use trace::input::signals::Signals;
use trace::stages::stage_names;
use trace::verdict::{self, Verdict};
use trace::{AxisIdentification, Identification};

use crate::Budget;
use crate::cause;
use crate::json;
use crate::limits::{Judged, Judgement, Limit, Trust, judged};

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
    /// The limits that were asked for, with pass, fail or unknown.
    limits: Vec<Judgement>,
    /// When and where it was traced, as far as it was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    circumstances: Option<Circumstances>,
}

/// When and where a machine was traced.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Circumstances {
    /// Serial number of the machine.
    pub serial: Option<String>,
    /// Who traced it.
    pub operator: Option<String>,
    /// The date, as 2026-11-27.
    pub date: Option<String>,
    /// Temperature of the machine while it was logged.
    pub temperature_c: Option<f64>,
}

impl Document {
    /// The result of a trace with the budget of its model, and what became of limits.
    #[must_use]
    pub fn of(trace: trace::json::Document, budget: Option<&Budget>, limits: &[Judgement]) -> Self {
        Self { trace, budget: budget.map(json::Document::of), limits: limits.to_vec(), circumstances: None }
    }

    /// The document with its circumstances.
    #[must_use]
    pub fn under(self, circumstances: Circumstances) -> Self {
        let is_given = circumstances != Circumstances::default();
        Self { circumstances: is_given.then_some(circumstances), ..self }
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

/// Limits judged by the logs of a trace, else by the budget of its model.
#[must_use]
pub fn limits(
    trace: &Identification,
    logs: &[LogError],
    budget: Option<&Budget>,
    limits: &[Limit],
) -> Vec<Judgement> {
    let is_of_contour =
        |fault: &&DataFault| matches!(fault.channel, None | Some(Channel::Command | Channel::Tool));
    let faults = trace.axes().iter().flat_map(|axis| axis.data_faults.iter().filter(is_of_contour));
    let faulty: Vec<String> = faults.map(|fault| log_name(&fault.log)).collect();
    let (motions, trust) = match budget {
        Some(budget) => (&budget.motions[..], trust(trace, budget)),
        None => (&[][..], Trust::None("there is no error budget".to_owned())),
    };
    judged(limits, &Judged { logs, faulty: &faulty, motions, trust })
}

/// How far the budget of a trace counts where nothing was measured.
fn trust(trace: &Identification, budget: &Budget) -> Trust {
    let linear = || trace.axes().iter().filter(|axis| axis.unit == Unit::Millimetre);
    let named = |is: &dyn Fn(&AxisIdentification) -> bool| {
        linear().filter(|axis| is(axis)).map(|axis| axis.axis.as_str()).collect::<Vec<_>>().join(", ")
    };
    let not_described = named(&|axis| verdict::of_axis(axis) == Verdict::ModelDoesNotFit);
    if !not_described.is_empty() {
        return Trust::None(format!("the model does not describe the logs of {not_described}"));
    }
    if !budget.assumed.is_empty() {
        return Trust::None("loops or masses of the simulation are assumed".to_owned());
    }
    let without_tool = named(&|axis| axis.residual(Stage::Tool).is_none());
    if !without_tool.is_empty() {
        return Trust::AtLeast(format!(
            "errors between {without_tool} and the tool were not measured and come on top"
        ));
    }
    let unexplained = named(&|axis| verdict::of_axis(axis) == Verdict::Unexplained);
    if !unexplained.is_empty() {
        return Trust::AtLeast(format!("the residual of {unexplained} is not explained and comes on top"));
    }
    if cause::simulated(&trace.better_machine()).1.is_empty() {
        Trust::Whole
    } else {
        Trust::AtLeast("effects that are not in the budget come on top".to_owned())
    }
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
