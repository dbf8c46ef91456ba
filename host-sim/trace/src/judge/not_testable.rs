//! Effects that could not be searched for, with the missing channels or keys.

use crate::fit::scope::NotTestable;
use model::axis::Settings;
use model::effects::{KINDS, Kind, Neighbours, Prerequisite, Stage};

/// An effect that could not be searched for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EffectNotTestable {
    /// Name of the effect.
    pub effect: &'static str,
    /// What is missing.
    pub needs: String,
}

/// The effects that no round tried because no stage in which they are shown could be evaluated (`missing` contains the
/// reasons), or because the machine file lacks a key.
#[must_use]
pub fn effects_not_testable(
    axis: &Settings,
    neighbours: Neighbours,
    testable: &[Stage],
    missing: &[NotTestable],
    tried: &[&str],
) -> Vec<EffectNotTestable> {
    let needs = |kind: &Kind| {
        let prerequisite = (kind.prerequisite)(axis, neighbours);
        if prerequisite == Prerequisite::NotApplicable || !kind.drives.contains(&axis.controller.drive) {
            return None;
        }
        if !kind.shown_in.iter().any(|stage| testable.contains(stage)) {
            let first = missing.iter().find(|missing| kind.shown_in.first() == Some(&missing.stage));
            return first.map(|missing| missing.needs.clone());
        }
        match prerequisite {
            Prerequisite::Needs(what) => Some(what.to_owned()),
            Prerequisite::Met | Prerequisite::NotApplicable => None,
        }
    };
    let untried = KINDS.iter().filter(|kind| !tried.contains(&kind.name));
    untried
        .filter_map(|kind| needs(kind).map(|needs| EffectNotTestable { effect: kind.name, needs }))
        .collect()
}
