//! Residuals, and what is known of them.

use schemars::JsonSchema;
use serde::Serialize;

use super::figures::{Channel, InUnit, Rms, number};
use crate::analysis::variable::Variable;
use crate::analysis::{empirical, free_run, repeatability, residual_analysis};
use crate::judge::axis_findings::StageResidual;
use crate::result::identification::AxisIdentification;
use files::log::Unit;
use model::effects::Stage;

/// The residual of an axis and channel.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Residual {
    channel: Channel,
    axis: String,
    /// Suffix of the keys of the figures.
    unit: &'static str,
    #[serde(flatten)]
    figures: InUnit<ResidualFigures>,
}

/// Without and with the effects found, and the noise of the sensors.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
struct ResidualFigures {
    before: Rms,
    after: Rms,
    noise: Option<f64>,
}

impl Residual {
    pub(super) fn of(axis: &AxisIdentification, residual: &StageResidual) -> Self {
        let StageResidual { stage, before, after, noise, .. } = *residual;
        let figures = ResidualFigures { before: before.into(), after: after.into(), noise: number(noise) };
        let figures = InUnit::of(axis.unit, stage, figures);
        Self { channel: stage.into(), axis: axis.axis.clone(), unit: figures.unit(), figures }
    }
}

/// What remains above the noise.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Unexplained {
    channel: Channel,
    axis: String,
    #[serde(flatten)]
    rms: InUnit<RmsOfFit>,
    /// Part of the mean square that the variable explains.
    share_percent: f64,
    /// The variable on which it depends most.
    variable: Variable,
    #[serde(skip_serializing_if = "Option::is_none")]
    frequency_hz: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    centre_mm: Option<f64>,
    /// On a rotary axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    centre_deg: Option<f64>,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
struct RmsOfFit {
    rms: f64,
}

impl Unexplained {
    pub(super) fn of(axis: &AxisIdentification, left: &residual_analysis::UnexplainedResidual) -> Self {
        let is_rotary = axis.unit == Unit::Degree;
        Self {
            channel: left.stage.into(),
            axis: left.axis.clone(),
            rms: InUnit::of(axis.unit, left.stage, RmsOfFit { rms: left.rms }),
            share_percent: left.share_percent,
            variable: left.variable,
            frequency_hz: left.frequency_hz,
            centre_mm: left.centre_mm.filter(|_| !is_rotary),
            centre_deg: left.centre_mm.filter(|_| is_rotary),
        }
    }
}

/// The repeatable part of a residual.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Repeatability {
    channel: Channel,
    axis: String,
    period_s: f64,
    #[serde(flatten)]
    rms: InUnit<RepeatabilityFigures>,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
struct RepeatabilityFigures {
    repeatable: f64,
    non_repeatable: f64,
}

impl Repeatability {
    pub(super) fn of(axis: &AxisIdentification, split: &repeatability::Repeatability) -> Self {
        let repeatability::Repeatability { repeatable, non_repeatable, .. } = *split;
        Self {
            channel: split.stage.into(),
            axis: split.axis.clone(),
            period_s: split.period_s,
            rms: InUnit::of(axis.unit, split.stage, RepeatabilityFigures { repeatable, non_repeatable }),
        }
    }
}

/// Rms error of the simulation from the force alone.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FreeRun {
    axis: String,
    /// Duration of a run.
    seconds: f64,
    /// Number of runs.
    runs: usize,
    #[serde(flatten)]
    rms: InUnit<FreeRunFigures>,
    /// The constant error of the force that alone would make the error after.
    #[serde(flatten)]
    force: InUnit<ForceFigures>,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
struct ForceFigures {
    force_error: f64,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
struct FreeRunFigures {
    declared: f64,
    after: f64,
}

impl FreeRun {
    pub(super) fn of(axis: &AxisIdentification, run: &free_run::FreeRun) -> Self {
        let free_run::FreeRun { declared, after, .. } = *run;
        Self {
            axis: run.axis.clone(),
            seconds: run.seconds,
            runs: run.runs,
            rms: InUnit::of(axis.unit, Stage::Motor, FreeRunFigures { declared, after }),
            force: InUnit::of(axis.unit, Stage::Force, ForceFigures { force_error: run.force_error }),
        }
    }
}

/// A residual as a table over a variable.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct EmpiricalTable {
    channel: Channel,
    axis: String,
    variable: Variable,
    /// Variable and residual.
    table: Vec<[f64; 2]>,
    before: Rms,
    after: Rms,
}

impl EmpiricalTable {
    pub(super) fn of(table: &empirical::Empirical) -> Self {
        Self {
            channel: table.stage.into(),
            axis: table.axis.clone(),
            variable: table.variable,
            table: table.table.clone(),
            before: table.before.into(),
            after: table.after.into(),
        }
    }
}
