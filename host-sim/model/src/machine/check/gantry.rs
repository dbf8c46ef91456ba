//! An axis that is the second motor of a gantry, beside its first motor.

use files::document::Document;
use files::error::InputError;
use shared::config::GantrySettings;

use super::super::declared::Machine;
use super::super::rotary;
use crate::axis::{KeyNames, Settings};
use crate::servo;

/// Checks the gantries of a machine.
pub(super) fn gantries(machine: &Machine, document: &Document<'_>) -> Result<(), InputError> {
    for (name, axis) in &machine.axis {
        let gantry = &axis.settings.gantry;
        let refuse = |key: &str, what: &str| Err(document.refuse(&format!("axis.{name}.{key}"), what));
        let Some(first_name) = &gantry.gantry_with else {
            let others = [
                ("gantry_skew_limit_mm", gantry.gantry_skew_limit_mm),
                ("gantry_offset_mm", gantry.gantry_offset_mm),
            ];
            match others.into_iter().find(|(_, value)| value.is_some()) {
                Some((key, _)) => return refuse("gantry_with", &format!("the first motor, beside {key}")),
                None => continue,
            }
        };
        let is_other = |other: &str| {
            let axis = machine.axis.get(other).map(|axis| &axis.settings.gantry.gantry_with);
            other != name && axis.is_some_and(Option::is_none)
        };
        let is_taken = machine.axis.iter().any(|(other, axis)| {
            other != name && axis.settings.gantry.gantry_with.as_ref() == Some(first_name)
        });
        if !is_other(&first_name.0) || is_taken {
            return refuse("gantry_with", "the name of another axis, which is a motor of no other gantry");
        }
        if gantry.gantry_skew_limit_mm.is_none() {
            return refuse("gantry_skew_limit_mm", "a limit beside gantry_with");
        }
        let most_mm = 1e3 * GantrySettings::MOST_OFFSET_M;
        if gantry.gantry_offset_mm.is_some_and(|mm| mm.is_nan() || mm.abs() > most_mm) {
            return refuse("gantry_offset_mm", &format!("a number from -{most_mm} to {most_mm}"));
        }
        let Some(first) = machine.axis.get(&first_name.0) else { continue };
        if let Some(key) = other_than(&axis.settings, &first.settings) {
            let key = in_file(key, axis.settings.names);
            return refuse(key, &format!("what {} has, with which this axis is a gantry", first_name.0));
        }
    }
    Ok(())
}

/// The key of what both motors do together and have not declared alike.
fn other_than(second: &Settings, first: &Settings) -> Option<&'static str> {
    let (limits, of_first) = (&second.limits, &first.limits);
    let is_alike = [
        ("travel_mm", limits.travel_mm == of_first.travel_mm),
        ("fastest_mm_per_s", limits.fastest_mm_per_s == of_first.fastest_mm_per_s),
        ("smoothing_s", servo::smoothing(&second.filters) == servo::smoothing(&first.filters)),
    ];
    is_alike.into_iter().find(|(_, is_alike)| !is_alike).map(|(key, _)| key)
}

/// A key as the file of the axis has it.
fn in_file(key: &'static str, names: KeyNames) -> &'static str {
    rotary::written(key, 0.0, names).0
}
