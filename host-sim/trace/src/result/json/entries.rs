//! Faults of the data, declared values, what could not be evaluated, and what the logs do not distinguish.

use schemars::JsonSchema;
use serde::Serialize;

use super::figures::{Channel, number};
use crate::data_faults::fault;
use crate::fit::scope;
use crate::judge::declared_value::{self, DeclaredValue};
use crate::judge::not_testable::EffectNotTestable;
use crate::result::distinguishing_motion::Proposal;
use crate::result::identification::AxisIdentification;
use crate::search::ambiguity::Ambiguity;
use files::log;

/// A fault of the data.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct DataFault {
    axis: String,
    /// The channel; `all` if all are concerned.
    channel: &'static str,
    kind: &'static str,
    log: String,
    /// Time of the first occurrence on the clock of the session; `null` if the whole log is concerned.
    at_s: Option<f64>,
    /// In the unit of the kind.
    size: Option<f64>,
    frequency_hz: Option<f64>,
    /// Number of occurrences.
    count: usize,
    /// `corrected`, `removed` or `log_left_out`.
    treatment: &'static str,
}

impl DataFault {
    pub(super) fn of(fault: &fault::DataFault) -> Self {
        Self {
            axis: fault.axis.clone(),
            channel: fault.channel.map_or("all", log::Channel::word),
            kind: fault.kind.name(),
            log: fault.log.clone(),
            at_s: fault.at_s,
            size: fault.size,
            frequency_hz: fault.frequency_hz,
            count: fault.count,
            treatment: fault.treatment.name(),
        }
    }
}

/// A declared value with its fit.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FittedValue {
    axis: String,
    key: &'static str,
    declared: f64,
    fitted: f64,
    /// `null` at the end of the range of the search.
    ci95: Option<[Option<f64>; 2]>,
    beyond_tolerance: bool,
}

impl FittedValue {
    pub(super) fn of(axis: &AxisIdentification, value: &DeclaredValue) -> Self {
        let DeclaredValue { key, declared, fitted, half_width, .. } =
            value.as_written(axis.model.axis.settings.names);
        Self {
            axis: axis.axis.clone(),
            key,
            declared,
            fitted,
            ci95: (!value.is_at_bound).then_some([fitted - half_width, fitted + half_width].map(number)),
            beyond_tolerance: value.is_beyond_tolerance,
        }
    }
}

/// The factor by which all declared values of an axis deviate, if it may be that of the logged force.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CommonFactor {
    axis: String,
    factor: Option<f64>,
}

impl CommonFactor {
    pub(super) fn of(axis: &AxisIdentification) -> Option<Self> {
        let factor = number(declared_value::mean_factor(&axis.declared_values));
        axis.has_force_scale.then(|| Self { axis: axis.axis.clone(), factor })
    }
}

/// A channel or an effect that could not be evaluated.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct NotTestable {
    #[serde(skip_serializing_if = "Option::is_none")]
    channel: Option<Channel>,
    #[serde(skip_serializing_if = "Option::is_none")]
    effect: Option<&'static str>,
    axis: String,
    /// What is missing.
    needs: String,
}

impl NotTestable {
    pub(super) fn channel(axis: &AxisIdentification, missing: &scope::NotTestable) -> Self {
        let (axis, needs) = (axis.axis.clone(), missing.needs.clone());
        Self { channel: Some(missing.stage.into()), effect: None, axis, needs }
    }

    pub(super) fn effect(axis: &AxisIdentification, missing: &EffectNotTestable) -> Self {
        let (axis, needs) = (axis.axis.clone(), missing.needs.clone());
        Self { channel: None, effect: Some(missing.effect), axis, needs }
    }
}

/// Two effects that the logs do not distinguish.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AmbiguousPair {
    axis: String,
    effects: [&'static str; 2],
    /// A motion file that distinguishes them.
    motion: Option<String>,
}

impl AmbiguousPair {
    pub(super) fn of(
        axis: &AxisIdentification,
        (ambiguity, proposal): (&Ambiguity, Option<&Proposal>),
    ) -> Self {
        Self {
            axis: axis.axis.clone(),
            effects: [ambiguity.added.name(), ambiguity.rival.name()],
            motion: proposal.map(Proposal::to_toml),
        }
    }
}
