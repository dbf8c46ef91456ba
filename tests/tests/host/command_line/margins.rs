//! `margins`, and compensation files whose drive settings leave a loop too little margin.

use serde_json::Value;

use super::work_folder::{MACHINE, MOTION, WorkFolder};

/// A compensation of the machine that only changes Kp of axis x.
fn compensation(gain_per_s: f64) -> String {
    format!("machine = \"demo\"\n[axis.x.controller]\nposition_gain_per_s = {gain_per_s:.1}\n")
}

fn folder(gain_per_s: f64) -> WorkFolder {
    WorkFolder::with(&[
        ("machine.toml", MACHINE.to_owned()),
        ("motion.toml", MOTION.to_owned()),
        ("compensation.toml", compensation(gain_per_s)),
    ])
}

/// Highest Kp of axis x and the gain margin of its position loop.
fn margins(folder: &WorkFolder, arguments: &str) -> (f64, f64) {
    folder.succeeds(&format!("margins --machine machine.toml --json out.json {arguments}"));
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    let axis = &json["axes"][0];
    let gain_db = axis["position_loop"]["gain_margin_db"]["value"].as_f64().unwrap();
    (axis["highest_position_gain_per_s"].as_f64().unwrap(), gain_db)
}

/// With P control the loop gain is proportional to Kp: twice the gain costs 20·log10(2) = 6.02 dB, and changes no other loop.
#[test]
fn twice_the_gain_costs_6_db() {
    let folder = folder(100.0);
    let (highest, declared_db) = margins(&folder, "");
    let (same_highest, doubled_db) = margins(&folder, "--compensation compensation.toml");
    assert!((declared_db - doubled_db - 20.0 * 2f64.log10()).abs() < 1e-6, "{declared_db} {doubled_db}");
    assert!((highest / same_highest - 1.0).abs() < 1e-12 && highest > 100.0);
}

#[test]
fn a_compensation_with_too_little_margin_is_refused_by_name_and_one_with_enough_is_not() {
    let (highest, _) = margins(&folder(100.0), "");
    let run =
        "simulate --machine machine.toml --motion motion.toml --out out.csv --compensation compensation.toml";
    folder(0.9 * highest).succeeds(run);
    let refused = folder(1.1 * highest);
    let message = refused.fails(run, 2);
    assert!(
        message.contains("compensation.toml: axis.x.controller") && message.contains("position loop"),
        "{message}"
    );
    assert!(!refused.path().join("out.csv").exists());
}
