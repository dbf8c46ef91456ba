//! The travel that a compensation is made for, and motions that leave it.
//!
//! Errors over the position are known where they were measured: between the first and the last knot of a model's map, and, of a
//! slope, on the travel of the motions for which the compensation is planned. Beyond its ends a table of the controller holds its
//! last value.

use shared::compensate::CompensationSettings;
use shared::compensate::settings::Points;

use crate::compensate::file::CompensationFile;
use crate::compensate::prediction::TestMotion;
use contour::NominalPath;
use files::error::InputError;
use model::effects::Effect;
use model::machine::{Axis, Machine};

/// Part of the travel of the motions that the tables cover beyond it, on both sides.
const BEYOND_TRAVEL: f64 = 0.02;

/// Part of the mapped travel by which a motion may leave it without being named: knots are rounded, and a table covers a little
/// more than its motions.
const TOLERANCE: f64 = 0.01;

/// Part of the mapped travel by which a motion may leave it and the maps are still used: then they hold for most of the motion.
const FAR: f64 = 0.1;

/// Shortest travel of a table, m.
const SHORTEST_M: f64 = 2e-3;

/// The travel that the tables of an axis cover, m: its soft limits, or that of the motions and a little more.
///
/// # Errors
/// If a motion does not fit the machine.
pub fn travel_m(machine: &Machine, tests: &[TestMotion], axis: usize) -> Result<[f64; 2], InputError> {
    if let Some([from, to]) = machine.axis[axis].settings.limits.travel_mm {
        return Ok([1e-3 * from, 1e-3 * to]);
    }
    let mut travel_m = [f64::INFINITY, f64::NEG_INFINITY];
    for test in tests {
        let [from, to] = test.nominal_path(machine)?.extent_m(axis);
        travel_m = [travel_m[0].min(from), travel_m[1].max(to)];
    }
    // An axis that does not move still has tables, of 2 mm.
    let beyond_m = (BEYOND_TRAVEL * (travel_m[1] - travel_m[0])).max(1e-3);
    Ok([travel_m[0] - beyond_m, travel_m[1] + beyond_m])
}

/// The travel in which the maps of an axis are known, m; `None` if it has none.
#[must_use]
pub fn maps_m(axis: &Axis) -> Option<[f64; 2]> {
    let knots = axis.effect.iter().filter_map(Effect::over_position);
    let ends = knots.filter_map(|knots| Some([1e-3 * knots.first()?, 1e-3 * knots.last()?]));
    ends.reduce(common).filter(|ends| length(*ends) >= SHORTEST_M)
}

/// The part of a travel, m, in which the maps of an axis are known; that of the maps if the travel is elsewhere.
#[must_use]
pub fn known_m(axis: &Axis, travel_m: [f64; 2]) -> [f64; 2] {
    let Some(maps_m) = maps_m(axis) else { return travel_m };
    let known_m = common(travel_m, maps_m);
    if length(known_m) >= SHORTEST_M { known_m } else { maps_m }
}

/// Whether one of the motions leaves the maps of an axis so far that what they say of it is of no use.
///
/// # Errors
/// If a motion does not fit the machine.
pub fn is_far_beyond(machine: &Machine, tests: &[TestMotion], axis: usize) -> Result<bool, InputError> {
    let Some(maps_m) = maps_m(&machine.axis[axis]) else { return Ok(false) };
    let mut is_far = false;
    for test in tests {
        is_far |= leaves(test.nominal_path(machine)?.extent_m(axis), maps_m, FAR);
    }
    Ok(is_far)
}

fn common(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

fn length([from, to]: [f64; 2]) -> f64 {
    to - from
}

/// Whether positions are outside a travel by more than a part of it.
fn leaves(reached: [f64; 2], travel: [f64; 2], part: f64) -> bool {
    let tolerance = part * length(travel);
    reached[0] < travel[0] - tolerance || reached[1] > travel[1] + tolerance
}

/// What of a compensation is a table over the position of its axis.
#[must_use]
pub fn over_position(settings: &CompensationSettings) -> Vec<&'static str> {
    let varies = |points: &Points| {
        let [least, greatest] = numerics::min_max(points.values.iter().copied());
        greatest - least > f64::EPSILON * greatest.abs().max(least.abs())
    };
    let force = settings.force.as_ref();
    let has = [
        ("pitch error", settings.pitch.is_some()),
        ("friction", force.and_then(|force| force.friction.map.as_ref()).is_some_and(varies)),
        ("load", force.and_then(|force| force.load.as_ref()).is_some_and(varies)),
    ];
    has.into_iter().filter(|(_, has)| *has).map(|(what, _)| what).collect()
}

/// An axis on which a motion leaves the mapped travel.
#[derive(Clone, Debug, PartialEq)]
pub struct Beyond {
    /// Name of the axis.
    pub axis: String,
    /// The mapped travel, mm.
    pub mapped_mm: [f64; 2],
    /// Least and greatest position of the motion, mm.
    pub reached_mm: [f64; 2],
    /// What is compensated by tables over the position; may be empty.
    pub what: Vec<&'static str>,
}

impl Beyond {
    /// The sentence for a user.
    #[must_use]
    pub fn sentence(&self) -> String {
        let [from, to] = self.mapped_mm;
        let [least, greatest] = self.reached_mm;
        let tables = if self.what.is_empty() {
            String::new()
        } else {
            format!(
                " There the tables of {} hold their last values, and the error may be larger than without the compensation.",
                self.what.join(" and ")
            )
        };
        format!(
            "{}: the motion covers {least:.1} to {greatest:.1} mm and leaves the mapped travel, {from:.1} to {to:.1} mm, beyond \
             which the errors over the position are not known.{tables}",
            self.axis
        )
    }
}

/// The axes on which a motion leaves the mapped travel of a compensation. `reached_m` gives least and greatest position of an axis by
/// its name, m; `None`: the motion lacks the axis.
pub fn beyond(file: &CompensationFile, reached_m: impl Fn(&str) -> Option<[f64; 2]>) -> Vec<Beyond> {
    let of_axis = |(name, axis): (&String, &crate::compensate::file::AxisCompensation)| {
        let mapped_mm = axis.mapped_mm?;
        let reached_mm = reached_m(name)?.map(|m| 1e3 * m);
        let what = over_position(&axis.compensation);
        leaves(reached_mm, mapped_mm, TOLERANCE).then(|| Beyond {
            axis: name.clone(),
            mapped_mm,
            reached_mm,
            what,
        })
    };
    file.axis.iter().filter_map(of_axis).collect()
}

/// What of the path of a motion on a machine is beyond the mapped travel.
#[must_use]
pub fn beyond_on_path(file: &CompensationFile, machine: &Machine, path: &NominalPath) -> Vec<Beyond> {
    beyond(file, |name| Some(path.extent_m(machine.axis.get_index_of(name)?)))
}
