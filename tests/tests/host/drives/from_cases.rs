//! The sparse cases: another program simulated them, with drives and machine files of little knowledge.

use std::path::Path;

use serde_json::Value;
use tests::cases;

use crate::traces;

/// Names that little knowledge may give to a part of what is true.
const FREE: [&str; 4] = ["lost_motion", "microstep_error", "load_angle", "windup"];

fn truth(folder: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap()
}

/// Every true effect is named, as such or among the rivals; no other name is certain; lost motion has its size: within 8 % and 0.3 µm.
#[test]
fn the_sparse_cases_are_explained_without_a_sure_false_name() {
    let Some(folders) = cases::sparse_folders() else { return };
    for folder in folders {
        let (traced, truth) = (traces::of_case(&folder), truth(&folder));
        let case = folder.display();
        let effects = truth["effects"].as_array().unwrap();
        let is_true = |axis: &str, name: &str| effects.iter().any(|e| e["axis"] == axis && e["name"] == name);
        let named = |axis: &str, name: &str| {
            traced
                .trace
                .axes()
                .iter()
                .filter(|one| one.axis == axis)
                .flat_map(|one| &one.found)
                .any(|found| found.effect.name() == name || found.rival_names().contains(&name))
        };
        for effect in effects {
            let [axis, name] = ["axis", "name"].map(|key| effect[key].as_str().unwrap());
            assert!(named(axis, name), "{case}: {name} on {axis}");
        }
        for (axis, lost_um) in traced.trace.axes().iter().zip(truth["lost_motion_um"].as_array().unwrap()) {
            for found in &axis.found {
                let mut names = found.rival_names();
                names.push(found.effect.name());
                let is_named = names.iter().any(|name| is_true(&axis.axis, name) || FREE.contains(name));
                assert!(is_named || !trace::certainty::is_certain(axis, found), "{case}: {names:?}");
            }
            if truth["kind"] == "toolonly" {
                continue;
            }
            let widths =
                axis.found.iter().filter(|found| ["backlash", "lost_motion"].contains(&found.effect.name()));
            let (sum_um, lost_um) =
                (widths.map(|found| found.effect.values()[0]).sum::<f64>(), lost_um.as_f64().unwrap());
            assert!(
                (sum_um - lost_um).abs() <= 0.08 * lost_um + 0.3,
                "{case} {}: {sum_um} of {lost_um} µm",
                axis.axis
            );
        }
    }
}
