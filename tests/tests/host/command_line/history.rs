//! `history`: what changed on a machine over its traces, when a limit is reached, its files, and what it refuses.

use serde_json::{Value, json};

use super::work_folder::{MACHINE, MOTION, WorkFolder, log};

/// Weeks in the history of a machine.
const WEEKS: u32 = 60;

/// The week from which the backlash grows, and by how much a week, µm.
const GROWS_FROM: u32 = 30;
const UM_A_WEEK: f64 = 0.2;

/// A number from −1 to 1 that nothing else depends on, in place of scatter.
fn scatter(week: u32, of: u32) -> f64 {
    f64::from((week * 7919 + of * 104_729 + 31) % 1009) / 504.0 - 1.0
}

/// Date of the trace of a week: 2025-01-06 and every seven days.
fn date(week: u32) -> String {
    let day = jiff::civil::date(2025, 1, 6).checked_add(jiff::Span::new().weeks(i64::from(week))).unwrap();
    day.to_string()
}

fn fitted(value: f64, half: f64) -> Value {
    json!({ "value": value, "ci95": [value - half, value + half] })
}

/// The JSON of a trace, as far as a history reads it: backlash of 3 µm that grows, a steady motor mass, a steady residual.
fn trace(week: u32) -> Value {
    let grown = UM_A_WEEK * f64::from(week.saturating_sub(GROWS_FROM));
    let width_um = 3.0 + grown + 0.3 * scatter(week, 1);
    let mass_kg = 120.0 + 0.5 * scatter(week, 2);
    let sizes = |rms: f64| json!({ "rms": rms, "max": 3.0 * rms, "G": 2.0 * rms, "corner": null });
    json!({
        "schema_version": 1,
        "machine": "mill",
        "verdict": "unexplained",
        "circumstances": { "serial": "4711", "operator": null, "date": date(week), "temperature_c": 20.0 },
        "effects": [{
            "name": "backlash", "axis": "x", "certainty": "certain", "rivals": [], "channel": "table",
            "parameters": { "width_um": fitted(width_um, 0.1) },
        }],
        "declared": [
            { "axis": "x", "key": "motor_mass_kg", "declared": 120.0, "fitted": mass_kg, "ci95": [mass_kg - 0.2, mass_kg + 0.2] },
        ],
        "residual": [{
            "axis": "x", "channel": "table", "unit": "um",
            "after_um": { "fit": 0.5, "validate": 0.5 + 0.02 * scatter(week, 3) },
        }],
        "not_testable": [],
        "budget": { "motions": [{
            "name": "circle", "whole_um": sizes(1.0 + width_um),
            "causes": [{ "cause": "backlash", "axis": "x", "um": sizes(0.5 * width_um) }],
        }] },
    })
}

fn folder(weeks: std::ops::Range<u32>) -> WorkFolder {
    let files: Vec<(String, String)> =
        weeks.map(|week| (format!("{}.json", date(week)), trace(week).to_string())).collect();
    let named: Vec<(&str, &String)> = files.iter().map(|(name, text)| (name.as_str(), text)).collect();
    WorkFolder::with(&named)
}

#[test]
fn a_growing_backlash_is_announced_with_its_cost_and_its_date() {
    let folder = folder(0..WEEKS);
    let stdout = folder.succeeds(
        "history . --json history.out --report page --parquet all.parquet --limit x.backlash.width_um=12 --limit x.residual.table_um=1",
    );
    assert!(
        stdout.starts_with("mill (4711): 60 traces from 2025-01-06 to 2026-02-23; one value changed.\n"),
        "{stdout}"
    );
    assert!(stdout.contains("x.backlash.width_um rose"), "{stdout}");
    let json: Value = serde_json::from_str(&folder.read("history.out")).unwrap();
    let of = |name: &str| json["series"].as_array().unwrap().iter().find(|one| one["name"] == name).unwrap();
    let backlash = of("x.backlash.width_um");
    let changes = backlash["changes"].as_array().unwrap();
    // It grows by a scatter's deviation (0.3/√3 µm) in a week: announced within two months, dated to within six weeks.
    let is_between = |date_: &Value, from: u32, to: u32| {
        let day = date_.as_str().unwrap();
        (date(from).as_str()..=date(to).as_str()).contains(&day)
    };
    assert!(is_between(&changes[0]["announced"], GROWS_FROM + 1, GROWS_FROM + 8), "{backlash}");
    assert!(is_between(&changes[0]["since"], GROWS_FROM - 3, GROWS_FROM + 6), "{backlash}");
    assert!((backlash["first"]["value"].as_f64().unwrap() - 3.0).abs() < 0.3, "{backlash}");
    let last_um = 3.0 + UM_A_WEEK * f64::from(WEEKS - 1 - GROWS_FROM);
    assert!((backlash["now"]["value"].as_f64().unwrap() - last_um).abs() < 0.3, "{backlash}");
    let a_month = UM_A_WEEK * 30.4375 / 7.0;
    assert!((backlash["per_month"]["value"].as_f64().unwrap() / a_month - 1.0).abs() < 0.1, "{backlash}");
    // The budget shares half of the width.
    let at_tool = |when: &str| backlash["at_tool_um_rms"][when].as_f64().unwrap();
    assert!(
        (at_tool("first") - 1.5).abs() < 0.15 && (at_tool("now") - 0.5 * last_um).abs() < 0.2,
        "{backlash}"
    );
    for steady in ["x.motor_mass_kg", "x.residual.table_um"] {
        assert_eq!(of(steady)["changes"], json!([]), "{steady}");
    }
    assert_eq!(of("tool.circle.rms_um")["is_watched"], false);
    // 12 µm are reached (12 − 3)/0.2 = 45 weeks after it began to grow.
    let limits = json["limits"].as_array().unwrap();
    assert_eq!(limits[0]["reached"], "on");
    assert!(is_between(&limits[0]["date"], GROWS_FROM + 43, GROWS_FROM + 47), "{}", limits[0]);
    let true_day = date(GROWS_FROM + 45);
    let [earliest, latest] = ["earliest", "latest"].map(|end| limits[0][end].as_str().unwrap().to_owned());
    assert!(earliest < true_day && true_day < latest, "{earliest} {latest}");
    assert_eq!(limits[1]["reached"], "not_in_sight");
    let page = folder.read("page/report.html");
    assert!(page.contains("What changed") && page.contains("x.backlash.width_um"));
    // Three values that are watched, and the two of the tool.
    assert_eq!(page.matches("<svg class=\"chart").count(), 5);
    let bytes = std::fs::read(folder.path().join("all.parquet")).unwrap();
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
}

#[test]
fn a_check_fails_at_the_trace_that_announces_a_change() {
    let failing = (GROWS_FROM..GROWS_FROM + 10).find(|last| {
        let output = folder(0..last + 1).run("history . --check");
        output.status.code() == Some(1)
    });
    let first = failing.unwrap();
    assert!((GROWS_FROM + 1..=GROWS_FROM + 8).contains(&first), "{first}");
    let before = folder(0..first);
    before.succeeds("history . --check --limit x.backlash.width_um=12");
    let message = before.fails("history . --check --limit x.backlash.width_um=1", 1);
    assert!(message.contains("x.backlash.width_um is exceeded"), "{message}");
}

#[test]
fn traces_are_read_as_they_are_written() {
    let traced = WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION), ("fit.csv", log())]);
    std::fs::create_dir(traced.path().join("traces")).unwrap();
    for day in ["2026-10-01", "2026-11-02"] {
        traced.succeeds(&format!(
            "trace --machine machine.toml --fit fit.csv --json traces/{day}.json --model traces/{day}.toml --date {day} --serial 7 --temperature-c 21.5"
        ));
    }
    // A trace without circumstances has its date in the name of the file; a model has its own.
    traced.succeeds("trace --machine machine.toml --fit fit.csv --json traces/20261201.json --model traces/m_2026-12-02.toml");
    let stdout = traced.succeeds("history traces --json out.json");
    assert!(stdout.contains(" 4 traces from 2026-10-01 to 2026-12-02; too few to tell"), "{stdout}");
    let json: Value = serde_json::from_str(&traced.read("out.json")).unwrap();
    let watched: Vec<&Value> =
        json["series"].as_array().unwrap().iter().filter(|one| one["is_watched"] == true).collect();
    assert_eq!(json["watched"], watched.len());
    // The residuals of motor, table, tool and force of each axis at least, three times the same.
    assert!(watched.len() >= 6, "{stdout}");
    for series in watched.iter().filter(|one| one["group"] == "residual") {
        let values: Vec<&Value> =
            series["points"].as_array().unwrap().iter().map(|point| &point["value"]).collect();
        assert!(values.len() == 3 && values.iter().all(|value| *value == values[0]), "{series}");
    }
}

#[test]
fn what_is_no_history_is_refused_in_one_line() {
    let mut other = trace(1);
    other["machine"] = json!("lathe");
    let mut undated = trace(2);
    undated["circumstances"] = Value::Null;
    let mut later = trace(2);
    later["schema_version"] = json!(9);
    let first = ("2025-01-06.json", trace(0).to_string());
    for (file, expected) in [
        (("b.json", other.to_string()), "b.json: expected traces of one machine (machine mill, as in "),
        (("b.json", undated.to_string()), "b.json: expected a date in the file or in its name, found none"),
        (("b.json", later.to_string()), "b.json: schema_version: expected schema_version 1, found 9"),
        (("b.json", "{".to_owned()), "b.json: expected JSON, found "),
    ] {
        let folder = WorkFolder::with(&[(first.0, first.1.clone()), file]);
        let message = folder.fails("history . --json out.txt", 2);
        assert!(message.contains(expected) && message.lines().count() == 1, "{message}");
    }
    let folder = WorkFolder::with(&[(first.0, first.1.clone()), ("other.json", "{\"rows\": []}".to_owned())]);
    for (arguments, expected) in [
        ("--limit x.backlash=3", "--limit: expected a name of the history (x.backlash.width_um, "),
        ("--limit x.backlash.width_um", "expected NAME=VALUE"),
        ("--json 2025-01-06.json", "2025-01-06.json"),
    ] {
        let message = folder.fails(&format!("history . {arguments}"), 2);
        assert!(message.contains(expected) && message.lines().count() == 1, "{message}");
    }
    let stdout = folder.succeeds("history .");
    assert!(stdout.contains("1 other files (.json, .toml) are no traces and were left out."), "{stdout}");
    let empty = WorkFolder::with(&[("a.txt", "")]);
    let message = empty.fails("history .", 2);
    assert!(
        message.contains("expected the JSON of `lost-motion trace --json`, or its models, in it, found none"),
        "{message}"
    );
}
