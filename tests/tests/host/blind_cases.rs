//! Blind cases: logs of machines that another program simulated, which shares no code with this one.

use std::collections::BTreeSet;

use files::log::Log;
use model::machine::Machine;
use tests::cases;
use trace::trace;

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

fn logs(folder: &std::path::Path, kind: &str) -> Vec<Log> {
    cases::logs(folder, kind).iter().map(|path| Log::read(path).unwrap()).collect()
}

#[test]
fn the_effects_found_in_every_case_are_exactly_the_true_ones() {
    let Some(folders) = cases::folders() else { return };
    for folder in folders {
        let machine = Machine::read(&folder.join("machine.toml")).unwrap();
        let trace = trace(&machine, &logs(&folder, "fit_"), &logs(&folder, "validate_"), &|_| {}).unwrap();
        let found: Effects = trace
            .axes
            .iter()
            .flat_map(|axis| axis.found.iter().map(|f| (axis.axis.clone(), f.effect.name().to_owned())))
            .collect();
        assert_eq!(found, truth(&folder), "{}", folder.display());
    }
}
