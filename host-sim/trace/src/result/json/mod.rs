//! The result of a trace as JSON, for `trace --json`; described in `docs/files.md`, with the schema `docs/trace.schema.json`.
//!
//! [`Document`] is its type: lists of [`effect`]s, [`residual`]s, [`law`]s and other [`entries`], with [`figures`].

pub mod effect;
pub mod entries;
pub mod figures;
pub mod law;
pub mod residual;

use contour::log_error::LogError;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use super::identification::{AxisIdentification, Identification};
use super::verdict::{self, Verdict};
use effect::{DroppedEffect, Effect, Refused};
use entries::{AmbiguousPair, CommonFactor, DataFault, FittedValue, NotTestable};
use law::Law;
use residual::{EmpiricalTable, FreeRun, Repeatability, Residual, Unexplained};

/// Version of the schema: it changes where a key is removed, or its values mean something else.
const SCHEMA_VERSION: u32 = 1;

/// The JSON of `lost-motion trace --json`. A key with a unit ends in it: `_um`, `_n`, on rotary axes `_mdeg`, `_nm`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "Result of lost-motion trace")]
pub struct Document {
    /// Version of this schema: it changes where a key is removed, or its values mean something else.
    pub schema_version: u32,
    /// Name of the machine.
    pub machine: String,
    /// Whether the model explains the logs: the worst of the axes.
    pub verdict: Verdict,
    /// Faults of the data, found before any fit.
    pub data_faults: Vec<DataFault>,
    /// The residual of each axis and channel.
    pub residual: Vec<Residual>,
    /// The effects found.
    pub effects: Vec<Effect>,
    /// The declared mechanical values that were fitted.
    pub declared: Vec<FittedValue>,
    /// Axes on which the scale of the logged force may be wrong.
    pub common_factor: Vec<CommonFactor>,
    /// Effects that improved the fitted logs and that the validation logs contradict.
    pub refuted: Vec<Effect>,
    /// Effects that were not added because a parameter ended at a limit.
    pub refused: Vec<Refused>,
    /// Effects that the search added and that were dropped again.
    pub dropped: Vec<DroppedEffect>,
    /// What remains above the noise.
    pub unexplained: Vec<Unexplained>,
    /// What remains above the noise as equations, where held-out logs support one.
    pub laws: Vec<Law>,
    /// Channels and effects that could not be evaluated.
    pub not_testable: Vec<NotTestable>,
    /// Sentences about the logs.
    pub notes: Vec<String>,
    /// Pairs of effects that the logs do not distinguish.
    pub ambiguities: Vec<AmbiguousPair>,
    /// Repeatable and other parts of the residuals, of motions that repeat.
    pub repeatability: Vec<Repeatability>,
    /// Simulation from the force alone.
    pub free_run: Vec<FreeRun>,
    /// Contour error of the logs as they were logged.
    pub contour: Vec<contour::json::OfLog>,
    /// With `--empirical`: residuals as tables over the variables that explain most of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub empirical: Option<Vec<EmpiricalTable>>,
}

impl Document {
    /// The JSON of a trace, with the contour errors of its logs, and with the tables of `--empirical` if requested.
    #[must_use]
    pub fn of(trace: &Identification, contour_errors: &[LogError], with_tables: bool) -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            machine: trace.machine().name.clone(),
            verdict: verdict::of(trace),
            data_faults: of_axes(trace, |axis| axis.data_faults.iter().map(DataFault::of).collect()),
            residual: of_axes(trace, |axis| axis.residuals.iter().map(|of| Residual::of(axis, of)).collect()),
            effects: effects(trace),
            declared: of_axes(trace, |axis| {
                axis.written_values().map(|value| FittedValue::of(axis, &value)).collect()
            }),
            common_factor: of_axes(trace, |axis| CommonFactor::of(axis).into_iter().collect()),
            refuted: of_axes(trace, |axis| {
                axis.refuted.iter().map(|found| Effect::of(axis, found)).collect()
            }),
            refused: of_axes(trace, |axis| {
                axis.refused.iter().map(|limit| Refused::of(axis, limit)).collect()
            }),
            dropped: of_axes(trace, |axis| {
                axis.dropped.iter().map(|of| DroppedEffect::of(axis, of)).collect()
            }),
            unexplained: of_axes(trace, |axis| {
                axis.unexplained.iter().map(|left| Unexplained::of(axis, left)).collect()
            }),
            laws: of_axes(trace, |axis| axis.laws_with_motions().map(|law| Law::of(axis, law)).collect()),
            not_testable: not_testable(trace),
            notes: trace.notes().to_vec(),
            ambiguities: of_axes(trace, |axis| {
                axis.ambiguities_with_motions().map(|pair| AmbiguousPair::of(axis, pair)).collect()
            }),
            repeatability: of_axes(trace, |axis| {
                axis.repeats.iter().map(|split| Repeatability::of(axis, split)).collect()
            }),
            free_run: of_axes(trace, |axis| {
                axis.free_runs.iter().map(|run| FreeRun::of(axis, run)).collect()
            }),
            contour: contour::json::of_logs(contour_errors),
            empirical: with_tables
                .then(|| of_axes(trace, |axis| axis.tables.iter().map(EmpiricalTable::of).collect())),
        }
    }

    /// The document as a JSON value.
    #[must_use]
    pub fn value(&self) -> Value {
        // Nothing in it can fail: its keys are texts.
        serde_json::to_value(self).unwrap_or_default()
    }
}

/// The effects found on all axes.
#[must_use]
pub fn effects(trace: &Identification) -> Vec<Effect> {
    of_axes(trace, |axis| axis.found.iter().map(|found| Effect::of(axis, found)).collect())
}

/// The channels of all axes, then the effects.
fn not_testable(trace: &Identification) -> Vec<NotTestable> {
    let channels = of_axes(trace, |axis| {
        axis.not_testable.iter().map(|stage| NotTestable::channel(axis, stage)).collect()
    });
    let effects = of_axes(trace, |axis| {
        axis.effects_not_testable.iter().map(|effect| NotTestable::effect(axis, effect)).collect()
    });
    [channels, effects].concat()
}

fn of_axes<T>(trace: &Identification, of: impl Fn(&AxisIdentification) -> Vec<T>) -> Vec<T> {
    trace.axes().iter().flat_map(of).collect()
}
