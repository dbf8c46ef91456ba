//! The result of a trace as JSON, for `trace --json`; described in `docs/files.md`.

use serde_json::{Map, Value, json};

use super::distinguishing_motion::Proposal;
use super::identification::{AxisIdentification, Identification};
use crate::analysis::free_run::FreeRun;
use crate::analysis::repeatability::Repeatability;
use crate::analysis::residual_analysis::UnexplainedResidual;
use crate::fit::limits::ParameterAtLimit;
use crate::fit::scope::NotTestable;
use crate::judge::axis_findings::StageResidual;
use crate::judge::declared_value::{self, DeclaredValue};
use crate::judge::found_effect::FoundEffect;
use crate::judge::not_testable::EffectNotTestable;
use crate::repair::DataFault;
use crate::result::certainty::is_certain;
use crate::result::verdict;
use crate::search::ambiguity::Ambiguity;
use crate::stages::residual_unit;
use files::log::{Channel, Unit};
use model::effects::{Effect, Stage};

/// The JSON of `trace --json`, with the tables of `--empirical` if requested.
#[must_use]
pub fn of(trace: &Identification, with_tables: bool) -> Value {
    let residual: Vec<Value> =
        trace.axes().iter().flat_map(|axis| axis.residuals.iter().map(move |e| residual(axis, e))).collect();
    let of_axis = |axis| move |residual| unexplained(axis, residual);
    let unexplained: Vec<Value> =
        trace.axes().iter().flat_map(|axis| axis.unexplained.iter().map(of_axis(axis))).collect();
    let mut not_testable: Vec<Value> = trace
        .axes
        .iter()
        .flat_map(|axis| {
            let one = |n: &NotTestable| json!({"channel": n.stage, "axis": axis.axis, "needs": n.needs});
            axis.not_testable.iter().map(one).collect::<Vec<_>>()
        })
        .collect();
    for axis in trace.axes() {
        let one = |n: &EffectNotTestable| json!({"effect": n.effect, "axis": axis.axis, "needs": n.needs});
        not_testable.extend(axis.effects_not_testable.iter().map(one));
    }
    let repeats: Vec<Value> = trace
        .axes
        .iter()
        .flat_map(|axis| axis.repeats.iter().map(move |split| repeatability(axis, split)))
        .collect();
    let free_runs = of_axes(trace, |axis| axis.free_runs.iter().map(|run| free_run(axis, run)).collect());
    let mut all = json!({
        "verdict": verdict::of(trace),
        "data_faults": of_axes(trace, |axis| axis.data_faults.iter().map(data_fault).collect()),
        "residual": residual,
        "effects": effects(trace),
        "declared": of_axes(trace, |axis| axis.declared_values.iter().map(|value| declared(axis, value)).collect()),
        "common_factor": of_axes(trace, |axis| common_factor(axis).into_iter().collect()),
        "refuted": of_axes(trace, |axis| axis.refuted.iter().map(|found| effect(axis, found)).collect()),
        "refused": of_axes(trace, |axis| axis.refused.iter().map(|limit| refused(axis, limit)).collect()),
        "unexplained": unexplained,
        "not_testable": not_testable,
        "notes": trace.notes(),
        "look_alikes": ambiguities(trace),
        "repeatability": repeats,
        "free_run": free_runs,
    });
    if let (true, Value::Object(all)) = (with_tables, &mut all) {
        let tables: Vec<_> = trace.axes().iter().flat_map(|axis| &axis.tables).collect();
        all.insert("empirical".to_owned(), json!(tables));
    }
    all
}

fn data_fault(fault: &DataFault) -> Value {
    json!({
        "axis": fault.axis,
        "channel": fault.channel.map_or("all", Channel::word),
        "kind": fault.kind.name(),
        "log": fault.log,
        "at_s": fault.at_s,
        "size": fault.size,
        "frequency_hz": fault.frequency_hz,
        "count": fault.count,
        "treatment": fault.treatment.name(),
    })
}

/// Pairs of effects that the logs do not distinguish, with the motion file that does.
fn ambiguities(trace: &Identification) -> Vec<Value> {
    let of_axis = |axis: &AxisIdentification| {
        let one = |(ambiguity, proposal): (&Ambiguity, Option<&Proposal>)| {
            json!({
                "axis": axis.axis,
                "effects": [ambiguity.added.name(), ambiguity.rival.name()],
                "motion": proposal.map(|proposal| &proposal.motion),
            })
        };
        axis.ambiguities_with_motions().map(one).collect::<Vec<_>>()
    };
    trace.axes().iter().flat_map(of_axis).collect()
}

/// The effects found on all axes.
#[must_use]
pub fn effects(trace: &Identification) -> Vec<Value> {
    of_axes(trace, |axis| axis.found.iter().map(|found| effect(axis, found)).collect())
}

fn of_axes(trace: &Identification, of: impl Fn(&AxisIdentification) -> Vec<Value>) -> Vec<Value> {
    trace.axes().iter().flat_map(of).collect()
}

/// The factor by which all declared values of an axis deviate, if it may be that of the logged force.
fn common_factor(axis: &AxisIdentification) -> Option<Value> {
    let factor = declared_value::mean_factor(&axis.declared_values);
    axis.has_force_scale.then(|| json!({"axis": axis.axis, "factor": factor}))
}

/// A declared value with its fit.
fn declared(axis: &AxisIdentification, value: &DeclaredValue) -> Value {
    let DeclaredValue { key, declared, fitted, half_width, .. } = *value;
    json!({
        "axis": axis.axis,
        "key": key,
        "declared": declared,
        "fitted": fitted,
        "ci95": (!value.is_at_bound).then_some([fitted - half_width, fitted + half_width]),
        "beyond_tolerance": value.is_beyond_tolerance,
    })
}

/// An effect that was not added because a parameter ended at a limit of its range.
fn refused(axis: &AxisIdentification, limit: &ParameterAtLimit) -> Value {
    let mut entry = json!({
        "name": limit.effect.name(),
        "axis": axis.axis,
        "parameter": limit.parameter.key_on(axis.unit == Unit::Degree),
        "value": limit.value,
        "limit": limit.limit,
        "why": "at the limit of its search: the value lies beyond, or it is another effect",
    });
    if let (Value::Object(entry), Some(source)) = (&mut entry, limit.effect.distinction().source()) {
        entry.insert("source".to_owned(), json!(source));
    }
    entry
}

fn residual(axis: &AxisIdentification, error: &StageResidual) -> Value {
    let (_, unit) = residual_unit(axis.unit, error.stage);
    let mut entry = Map::new();
    entry.insert("channel".to_owned(), json!(error.stage));
    entry.insert("axis".to_owned(), json!(axis.axis));
    entry.insert("unit".to_owned(), json!(unit));
    entry.insert(format!("before_{unit}"), json!(error.before));
    entry.insert(format!("after_{unit}"), json!(error.after));
    entry.insert(format!("noise_{unit}"), json!(error.noise));
    Value::Object(entry)
}

fn free_run(axis: &AxisIdentification, run: &FreeRun) -> Value {
    let mut entry = json!(run);
    if let Value::Object(entry) = &mut entry {
        let (_, unit) = residual_unit(axis.unit, Stage::Motor);
        entry.insert(format!("declared_{unit}"), json!(run.declared));
        entry.insert(format!("after_{unit}"), json!(run.after));
    }
    entry
}

fn repeatability(axis: &AxisIdentification, split: &Repeatability) -> Value {
    let mut entry = json!(split);
    if let Value::Object(entry) = &mut entry {
        let (_, unit) = residual_unit(axis.unit, split.stage);
        entry.insert(format!("repeatable_{unit}"), json!(split.repeatable));
        entry.insert(format!("non_repeatable_{unit}"), json!(split.non_repeatable));
    }
    entry
}

fn unexplained(axis: &AxisIdentification, residual: &UnexplainedResidual) -> Value {
    let mut entry = json!(residual);
    if let Value::Object(entry) = &mut entry {
        let (_, unit) = residual_unit(axis.unit, residual.stage);
        entry.insert(format!("rms_{unit}"), json!(residual.rms));
        if axis.unit == Unit::Degree
            && let Some(centre) = entry.remove("centre_mm")
        {
            entry.insert("centre_deg".to_owned(), centre);
        }
    }
    entry
}

fn effect(axis: &AxisIdentification, found: &FoundEffect) -> Value {
    let parameters = parameters(&found.effect, &found.half_widths, axis.unit == Unit::Degree);
    let mut entry = json!({
        "name": found.effect.name(),
        "axis": axis.axis,
        "parameters": parameters,
        "certainty": if is_certain(axis, found) { "certain" } else { "ambiguous" },
        "rivals": found.rival_names(),
        "channel": found.stage,
        "validate_reduction_percent": found.validate_reduction_percent(),
    });
    if let Value::Object(entry) = &mut entry {
        let (_, unit) = residual_unit(axis.unit, found.stage);
        entry.insert(format!("before_{unit}"), json!(found.before));
        entry.insert(format!("after_{unit}"), json!(found.after));
        if let Some(source) = found.effect.distinction().source() {
            entry.insert("source".to_owned(), json!(source));
        }
        let named = json!(found.effect);
        for (key, _) in found.effect.kind().named_keys {
            entry.entry(*key).or_insert_with(|| named[key].clone());
        }
        if let Some(remaining) = found.remaining {
            entry.insert("remaining_to_noise".to_owned(), json!(remaining.to_noise));
        }
    }
    entry
}

/// Values of an effect's parameters with their intervals. Of a list, both are lists; a list that is not fitted, such as
/// the positions of knots, has no intervals.
fn parameters(effect: &Effect, half_widths: &[f64], is_rotary: bool) -> Map<String, Value> {
    let declared = effect.declared_parameters();
    let values: Vec<(f64, f64)> = effect.values().into_iter().zip(half_widths.iter().copied()).collect();
    let mut result = Map::new();
    for same in declared[..values.len()].chunk_by(|a, b| a.is_list && a.key == b.key) {
        let start = declared.iter().position(|parameter| parameter.key == same[0].key).unwrap_or(0);
        let of_key = &values[start..start + same.len()];
        let interval = |(value, half): &(f64, f64)| [value - half, value + half];
        let entry = if !same[0].is_list {
            json!({"value": of_key[0].0, "ci95": interval(&of_key[0])})
        } else if of_key.iter().all(|(_, half)| *half == 0.0) {
            json!({"value": of_key.iter().map(|(value, _)| *value).collect::<Vec<_>>()})
        } else {
            let intervals: Vec<[f64; 2]> = of_key.iter().map(interval).collect();
            json!({"value": of_key.iter().map(|(value, _)| *value).collect::<Vec<_>>(), "ci95": intervals})
        };
        result.insert(same[0].key_on(is_rotary), entry);
    }
    result
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
        let effect: Effect = toml::from_str("name = 'position_load'\nslope_n_per_m = 3").unwrap();
        let expected = json!({
            "slope_n_per_m": {"value": 3.0, "ci95": [2.0, 4.0]},
            "centre_mm": {"value": 0.0, "ci95": [0.0, 0.0]},
        });
        assert_eq!(json!(parameters(&effect, &[1.0, 0.0], false)), expected);
    }
}
