//! `circle`: the keys of its JSON, its page, and what it refuses.

use std::f64::consts::TAU;

use serde_json::Value;

use super::work_folder::{MACHINE, WorkFolder};

const CIRCLE: &str = include_str!("../../../../host-sim/motions/circle.toml");

/// A table with an oval of 6 µm and a step of 2 µm at the reversals of x, in both directions.
fn table() -> String {
    let mut csv = "angle_deg,radius_um,direction\n".to_owned();
    for (word, direction) in [("ccw", 1.0), ("cw", -1.0)] {
        for i in 0..3600_u32 {
            let angle = TAU * (f64::from(i) + 0.5) / 3600.0;
            let step = direction * angle.sin().signum() * angle.cos();
            // A ripple in place of noise.
            let ripple = 0.02 * f64::from(i * 7919 % 101) / 101.0;
            csv +=
                &format!("{},{:.5},{word}\n", angle.to_degrees(), 3.0 * (2.0 * angle).sin() + step + ripple);
        }
    }
    csv
}

#[test]
fn the_json_has_its_keys_and_the_parts_are_in_order() {
    let folder = WorkFolder::with(&[("table.csv", table())]);
    let stdout = folder.succeeds("circle table.csv --radius 100 --json out.json --report page");
    assert!(stdout.contains("mostly made of squareness of xy (6.0"), "{stdout}");
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    let figures = &json["iso_230_4_um"];
    for key in ["G", "F_min", "F_max", "H", "G_b"] {
        assert!(figures[key].is_f64(), "{key}: {json}");
    }
    let parts = json["parts"].as_array().unwrap();
    let um: Vec<f64> = parts.iter().map(|part| part["um"].as_f64().unwrap()).collect();
    assert!(um.len() >= 2 && um.is_sorted_by(|a, b| a >= b), "{json}");
    for part in parts {
        let [low, high] = [0, 1].map(|i| part["ci95"][i].as_f64().unwrap());
        assert!(low <= part["um"].as_f64().unwrap() && part["um"].as_f64().unwrap() <= high, "{part}");
        let is_certain = part["certainty"] == "certain";
        assert!(is_certain == part["rivals"].as_array().unwrap().is_empty(), "{part}");
        assert!(part["name"].is_string() && part["axis"].is_string(), "{part}");
    }
    let named = |name: &str| parts.iter().find(|part| part["name"] == name).unwrap();
    assert!((named("squareness")["um"].as_f64().unwrap() - 6.0).abs() < 0.1, "{json}");
    assert!(
        (named("backlash")["um"].as_f64().unwrap() - 2.0).abs() < 0.1 && named("backlash")["axis"] == "x"
    );
    let page = folder.read("page/report.html");
    assert!(page.contains("What it is made of") && page.contains("squareness"));
}

/// `simulate` writes a log of both directions; the circle of the motion has a radius of 50 mm. One direction has neither H nor G(b).
#[test]
fn a_simulated_log_and_one_direction_alone() {
    let folder = WorkFolder::with(&[("machine.toml", MACHINE), ("circle.toml", CIRCLE)]);
    folder.succeeds("simulate --machine machine.toml --motion circle.toml --out log.csv");
    folder.succeeds("circle log.csv --json out.json");
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    assert!((json["radius_mm"].as_f64().unwrap() - 50.0).abs() < 1e-3 && json["channel"] == "tool", "{json}");
    assert!(json["iso_230_4_um"]["H"].is_f64(), "{json}");
    let one = table().lines().filter(|line| !line.ends_with(",cw")).collect::<Vec<_>>().join("\n");
    let folder = WorkFolder::with(&[("one.csv", one)]);
    folder.succeeds("circle one.csv --radius 100 --json out.json");
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    assert!(json["iso_230_4_um"]["H"].is_null() && json["iso_230_4_um"]["G_b"].is_null(), "{json}");
}

/// G of the table is a figure of its JSON; its residual, of which eight times may be noise, is far below half of it.
#[test]
fn a_limit_is_judged_by_the_circular_deviation() {
    let folder = WorkFolder::with(&[("table.csv", table())]);
    let circle = "circle table.csv --radius 100 --json out.json --report page";
    folder.succeeds(circle);
    let json = |folder: &WorkFolder| -> Value { serde_json::from_str(&folder.read("out.json")).unwrap() };
    let g_um = json(&folder)["iso_230_4_um"]["G"].as_f64().unwrap();
    assert_eq!(json(&folder)["limits"], serde_json::json!([]));
    let stdout =
        folder.succeeds(&format!("{circle} --limit G={} --limit G={} --limit rms=9", 2.0 * g_um, 0.5 * g_um));
    let results: Vec<Value> =
        json(&folder)["limits"].as_array().unwrap().iter().map(|limit| limit["result"].clone()).collect();
    assert_eq!(results, ["pass", "fail", "unknown"]);
    assert_eq!(stdout.lines().filter(|line| line.starts_with("Limit ")).count(), 3, "{stdout}");
    assert_eq!(folder.read("page/report.html").matches("<td class=\"result\">").count(), 3);
    folder.succeeds(&format!("{circle} --limit G={} --check", 2.0 * g_um));
    let message = folder.fails(&format!("{circle} --limit G={} --check", 0.5 * g_um), 1);
    assert!(message.contains("G (fail)"), "{message}");
    // 289° have no G, which is not a pass.
    let most = table()
        .lines()
        .filter(|line| !line.contains(",cw") && !line.starts_with('3'))
        .collect::<Vec<_>>()
        .join("\n");
    let folder = WorkFolder::with(&[("most.csv", most)]);
    let message = folder.fails("circle most.csv --radius 100 --limit G=1000 --check", 1);
    assert!(message.contains("G (unknown)"), "{message}");
}

#[test]
fn what_is_no_circle_is_refused_in_one_line() {
    let log = super::work_folder::log();
    let folder = WorkFolder::with(&[("table.csv", table().as_str()), ("quarter.csv", log)]);
    for (arguments, expected) in [
        ("circle table.csv --json o.json", "table.csv: expected --radius MM beside radius_um, found none"),
        ("circle table.csv --radius -1 --json o.json", "--radius: expected a positive number"),
        ("circle quarter.csv --json o.json", "quarter.csv: expected"),
        (
            "circle quarter.csv table.csv --json o.json",
            "quarter.csv: expected a table with radius_mm or radius_um, as table.csv",
        ),
        ("circle quarter.csv --radius 10 --json o.json", "quarter.csv: expected a table with radius_mm"),
        ("circle table.csv --radius 100 --json table.csv", "neither an input nor another output"),
    ] {
        let error = folder.fails(arguments, 2);
        assert!(error.contains(expected), "{arguments}: {error}");
        assert!(!folder.path().join("o.json").exists());
    }
}
