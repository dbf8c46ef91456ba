//! Effects found, refuted and refused.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};

use super::figures::{Channel, InUnit, Rms, number};
use crate::dropped::{Dropped, Reason};
use crate::fit::limits::ParameterAtLimit;
use crate::judge::found_effect::FoundEffect;
use crate::result::certainty::is_certain;
use crate::result::identification::AxisIdentification;
use files::log::Unit;
use model::effects;

/// An effect that was found, or refuted.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Effect {
    name: &'static str,
    axis: String,
    /// Each parameter under its key.
    parameters: BTreeMap<String, Parameter>,
    certainty: Certainty,
    /// What explains the logs as well, or what the logged channels do not tell apart.
    rivals: Vec<&'static str>,
    /// Where the residual is reduced most.
    channel: Channel,
    /// `null` if no validation log has the channel.
    validate_reduction_percent: Option<f64>,
    #[serde(flatten)]
    rms: InUnit<EffectFigures>,
    /// The axis that causes it, if it is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<String>,
    /// Keys of an effect that are words.
    #[serde(flatten)]
    named: BTreeMap<&'static str, Value>,
    /// The residual in its stages as a multiple of the noise, if it stands out.
    #[serde(skip_serializing_if = "Option::is_none")]
    remaining_to_noise: Option<f64>,
}

/// Without and with the effect.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
struct EffectFigures {
    before: Rms,
    after: Rms,
}

#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Certainty {
    /// Nothing speaks against it.
    Certain,
    /// Something else may be the cause.
    Ambiguous,
}

/// A value with its 95 % confidence interval. Of a list, both are lists; a list that is not fitted, such as the positions of knots, has
/// no intervals.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
enum Parameter {
    One { value: f64, ci95: Interval },
    Fitted { value: Vec<f64>, ci95: Vec<Interval> },
    Fixed { value: Vec<f64> },
}

type Interval = [Option<f64>; 2];

impl Effect {
    pub(super) fn of(axis: &AxisIdentification, found: &FoundEffect) -> Self {
        let (before, after) = (found.before.into(), found.after.into());
        let source = found.effect.distinction().source().map(str::to_owned);
        let certainty = if is_certain(axis, found) { Certainty::Certain } else { Certainty::Ambiguous };
        Self {
            name: found.effect.name(),
            axis: axis.axis.clone(),
            parameters: parameters(&found.effect, &found.half_widths, axis.unit == Unit::Degree),
            certainty,
            rivals: found.rival_names(),
            channel: found.stage.into(),
            validate_reduction_percent: number(found.validate_reduction_percent()),
            rms: InUnit::of(axis.unit, found.stage, EffectFigures { before, after }),
            named: named(&found.effect, source.is_some()),
            source,
            remaining_to_noise: found.remaining.map(|remaining| remaining.to_noise),
        }
    }
}

/// The words of an effect whose keys are not those of every effect: its own `channel` is not that of the residual.
fn named(effect: &effects::Effect, has_source: bool) -> BTreeMap<&'static str, Value> {
    let is_own = |key: &&str| *key != "channel" && !(*key == "source" && has_source);
    let written = json!(effect);
    let kind = effect.kind();
    let optional = kind.optional_named_keys.iter().filter(|(key, _)| written.get(key).is_some());
    let keys = kind.named_keys.iter().chain(optional).map(|(key, _)| *key).filter(is_own);
    keys.map(|key| (key, written[key].clone())).collect()
}

fn parameters(effect: &effects::Effect, half_widths: &[f64], is_rotary: bool) -> BTreeMap<String, Parameter> {
    let declared = effect.declared_parameters();
    let values: Vec<(f64, f64)> = effect.values().into_iter().zip(half_widths.iter().copied()).collect();
    let mut result = BTreeMap::new();
    for same in declared[..values.len()].chunk_by(|a, b| a.is_list && a.key == b.key) {
        let start = declared.iter().position(|parameter| parameter.key == same[0].key).unwrap_or(0);
        let of_key = &values[start..start + same.len()];
        let interval = |(value, half): &(f64, f64)| [value - half, value + half].map(number);
        let value = || of_key.iter().map(|(value, _)| *value).collect();
        let parameter = if !same[0].is_list {
            Parameter::One { value: of_key[0].0, ci95: interval(&of_key[0]) }
        } else if of_key.iter().all(|(_, half)| *half == 0.0) {
            Parameter::Fixed { value: value() }
        } else {
            Parameter::Fitted { value: value(), ci95: of_key.iter().map(interval).collect() }
        };
        result.insert(same[0].key_on(is_rotary), parameter);
    }
    result
}

/// An effect that was not added because a parameter ended at a limit of its range.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Refused {
    name: &'static str,
    axis: String,
    parameter: String,
    value: f64,
    limit: f64,
    why: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<String>,
}

impl Refused {
    pub(super) fn of(axis: &AxisIdentification, limit: &ParameterAtLimit) -> Self {
        Self {
            name: limit.effect.name(),
            axis: axis.axis.clone(),
            parameter: limit.parameter.key_on(axis.unit == Unit::Degree),
            value: limit.value,
            limit: limit.limit,
            why: "at the limit of its search: the value lies beyond, or it is another effect",
            source: limit.effect.distinction().source().map(str::to_owned),
        }
    }
}

/// An effect that the search added and that was dropped again.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct DroppedEffect {
    name: &'static str,
    axis: String,
    reason: Reason,
}

impl DroppedEffect {
    pub(super) fn of(axis: &AxisIdentification, dropped: &Dropped) -> Self {
        Self { name: dropped.effect().name(), axis: axis.axis.clone(), reason: dropped.reason() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_has_lists_of_values_and_intervals() {
        let map =
            "name = 'pitch_map'\npositions_mm = [0, 50]\nerror_um = [1, -2]\nerror_negative_um = [3, 4]";
        let parameters = parameters(&toml::from_str(map).unwrap(), &[0.0, 0.0, 0.5, 0.5, 1.0, 2.0], true);
        let expected = json!({
            "positions_deg": {"value": [0.0, 50.0]},
            "error_mdeg": {"value": [1.0, -2.0], "ci95": [[0.5, 1.5], [-2.5, -1.5]]},
            "error_negative_mdeg": {"value": [3.0, 4.0], "ci95": [[2.0, 4.0], [2.0, 6.0]]},
        });
        assert_eq!(json!(parameters), expected);
    }

    #[test]
    fn a_number_has_one_interval() {
        let effect: effects::Effect = toml::from_str("name = 'position_load'\nslope_n_per_m = 3").unwrap();
        let expected = json!({
            "slope_n_per_m": {"value": 3.0, "ci95": [2.0, 4.0]},
            "centre_mm": {"value": 0.0, "ci95": [0.0, 0.0]},
        });
        assert_eq!(json!(parameters(&effect, &[1.0, 0.0], false)), expected);
    }
}
