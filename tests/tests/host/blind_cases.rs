//! Blind cases: logs of machines that another program simulated, which shares no code with this one.

use std::collections::BTreeSet;

use crate::traces;
use tests::cases;

type Effects = BTreeSet<(String, String)>;

/// The effects of a case's `truth.json` that are in the catalogue, with their axes.
fn truth(folder: &std::path::Path) -> Effects {
    let json = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&json).unwrap();
    let text = |effect: &serde_json::Value, key: &str| effect[key].as_str().unwrap().to_owned();
    let effects = truth["effects"].as_array().unwrap().iter();
    effects
        .map(|effect| (text(effect, "axis"), text(effect, "name")))
        .filter(|(_, name)| model::effects::names().contains(&name.as_str()))
        .collect()
}

#[test]
fn the_effects_found_in_every_case_are_exactly_the_true_ones() {
    let Some(folders) = cases::folders() else { return };
    for folder in folders {
        let traced = traces::of_case(&folder);
        let found: Effects = traced
            .trace
            .axes()
            .iter()
            .flat_map(|axis| axis.found.iter().map(|f| (axis.axis.clone(), f.effect.name().to_owned())))
            .collect();
        assert_eq!(found, truth(&folder), "{}", folder.display());
    }
}
