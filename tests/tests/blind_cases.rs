//! Simulated machines made by a program that shares no code with this one, traced blind.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;

use files::log::Log;
use model::machine::Machine;
use tests::cases;
use trace::trace;

type Named = BTreeSet<(String, String)>;

/// Effects of a case's `truth.json` that the catalogue has.
fn truth(folder: &std::path::Path) -> Named {
    let text = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    let word = |effect: &serde_json::Value, key: &str| effect[key].as_str().unwrap().to_owned();
    let effects = truth["effects"].as_array().unwrap().iter();
    effects
        .map(|effect| (word(effect, "axis"), word(effect, "name")))
        .filter(|(_, name)| model::effects::names().contains(&name.as_str()))
        .collect()
}

fn logs(folder: &std::path::Path, kind: &str) -> Vec<Log> {
    cases::logs(folder, kind).iter().map(|path| Log::read(path).unwrap()).collect()
}

#[test]
fn every_case_comes_out_as_it_was_made() {
    let Some(folders) = cases::folders() else { return };
    for folder in folders {
        let machine = Machine::read(&folder.join("machine.toml")).unwrap();
        let trace = trace(&machine, &logs(&folder, "fit_"), &logs(&folder, "validate_"), &|_| {}).unwrap();
        let found: Named = trace
            .axes
            .iter()
            .flat_map(|axis| axis.found.iter().map(|f| (axis.axis.clone(), f.effect.name().to_owned())))
            .collect();
        assert_eq!(found, truth(&folder), "{}", folder.display());
    }
}
