//! Which effects could not be looked for, and what it would take.

use crate::fit::scope::NotTestable;
use model::effects::{NAMES, Stage};
use model::machine::Axis;

/// An effect that could not be looked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Untested {
    /// Its name.
    pub effect: &'static str,
    /// What is missing.
    pub needs: String,
}

/// Where an effect shows, and what its machine file has to have besides.
fn conditions(
    effect: &str,
    axis: &Axis,
    first_of_two: bool,
    others: bool,
) -> (&'static [Stage], Option<&'static str>) {
    use Stage::{Force, Motor, Table, Tool};

    let unless = |there: bool, what| (!there).then_some(what);
    let masses = unless(axis.has_mass(), "masses in the machine file");
    let lead = unless(axis.lead_mm.is_some(), "lead_mm in the machine file");
    match effect {
        "backlash" | "pitch_progressive" => (&[Table], None),
        "pitch_cyclic" => (&[Table], lead),
        "resolver_dividing" => (
            &[Table],
            lead.or(unless(axis.resolver_pole_pairs.is_some(), "resolver_pole_pairs in the machine file")),
        ),
        "windup" if axis.has_mass() => {
            let what = "stiffness_n_per_um in the machine file";
            (&[Table, Force], unless(!axis.is_rigid(), what))
        }
        "windup" => (&[Table], Some("a force channel in every log that is fitted")),
        "stribeck" | "friction_asymmetry" | "constant_load" => (&[Force, Table], masses),
        "torque_ripple" => (&[Force], lead.or(masses)),
        "servo_mismatch" | "velocity_lag" => (&[Motor], None),
        "crosstalk" | "straightness" => (&[Tool], unless(others, "another axis")),
        "squareness" => (&[Tool], unless(first_of_two, "the first of two axes")),
        "latency" => (&[Table, Tool], None),
        "presliding" if axis.presliding_stiffness_n_per_um.is_some() => {
            (&[Force], Some("a machine file that declares no presliding"))
        }
        "presliding" | "shear_thinning" | "friction_memory" | "preload_variation" | "friction_ripple" => {
            (&[Force], Some("logs without a table channel"))
        }
        _ => (&[Tool], None),
    }
}

/// The effects that no round tried: those whose stages could not be formed, or for which the machine file lacks a
/// key.
#[must_use]
pub fn untested(
    axis: &Axis,
    index: usize,
    count: usize,
    formed: &[Stage],
    missing: &[NotTestable],
    tried: &[&str],
) -> Vec<Untested> {
    let needs = |effect: &'static str| {
        let (stages, key) = conditions(effect, axis, index == 0 && count == 2, count > 1);
        if !stages.iter().any(|stage| formed.contains(stage)) {
            let first = missing.iter().find(|missing| stages.first() == Some(&missing.stage));
            return first.map(|missing| missing.needs.clone());
        }
        key.map(str::to_owned)
    };
    let untried = NAMES.iter().filter(|name| !tried.contains(name));
    untried.filter_map(|&effect| needs(effect).map(|needs| Untested { effect, needs })).collect()
}
