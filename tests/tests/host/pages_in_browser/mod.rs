//! Pages in headless Chromium: at 390, 768 and 1280 pixels nothing scrolls sideways and no script fails; the slider of a circle changes what is
//! drawn, and the pointer shows the deviation under it; pictures and tables are saved as files; nothing hinders keyboards and screen readers.
//! `run.sh all` installs Chromium; without it, the test says so and passes.

mod axe;

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

const HARNESS: &str = include_str!("harness.html");

pub fn chromium() -> Option<&'static str> {
    let runs = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    ["chromium", "chromium-browser", "google-chrome"].into_iter().find(runs)
}

/// What was seen of a page at each width.
fn seen(browser: &str, page: &Path) -> Vec<Value> {
    let folder = page.parent().unwrap();
    let harness = folder.join("harness.html");
    fs::write(&harness, HARNESS.replace("PAGE", page.file_name().unwrap().to_str().unwrap())).unwrap();
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files", "--dump-dom"])
        .args(["--virtual-time-budget=60000", "--window-size=1400,1000"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", harness.display()))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let result = dom.split_once("<pre id=\"result\">").and_then(|(_, rest)| rest.split_once("</pre>"));
    let (json, _) = result.unwrap_or_else(|| panic!("{dom}\n{}", String::from_utf8_lossy(&output.stderr)));
    let json =
        json.replace("&lt;", "<").replace("&gt;", ">").replace("&nbsp;", "\u{a0}").replace("&amp;", "&");
    serde_json::from_str(&json).unwrap()
}

/// Checks a page, and gives the files that it saves, by name and text.
fn check(browser: &str, page: &Path, has_circle: bool) -> Vec<(String, String)> {
    let has_axe = axe::put_beside(page);
    let mut files = Vec::new();
    for mut seen in seen(browser, page) {
        let saved = seen["saved"].take();
        let width = seen["width"].as_f64().unwrap();
        assert_eq!(seen["errors"], serde_json::json!([]), "{seen}");
        assert!(seen["scroll"].as_f64().unwrap() <= width, "{}: {seen}", page.display());
        assert_eq!(seen.get("before").is_some(), has_circle, "{seen}");
        if has_circle {
            // A magnification of 4: the line goes farther out.
            assert!(seen["after"].as_f64().unwrap() > 1.02 * seen["before"].as_f64().unwrap(), "{seen}");
            assert!(seen["division"].as_str().unwrap().starts_with("division "), "{seen}");
            let hover = seen["hover"].as_str().unwrap();
            assert!(hover.starts_with("0.0°") || hover.starts_with("360.0°"), "{seen}");
            assert!(hover.contains("wise") && hover.contains(" µm"), "{seen}");
        }
        if !saved.is_null() {
            files = check_saved(&seen, saved.as_array().unwrap());
            assert_eq!(seen["unnamed"], 0, "each picture has a title: {seen}");
            let expected = if has_axe { serde_json::json!([]) } else { Value::Null };
            assert_eq!(seen["hindrances"], expected, "{}", page.display());
        }
    }
    assert!(!files.is_empty(), "{}", page.display());
    assert!(fs::metadata(page).unwrap().len() < 1_000_000, "{}", page.display());
    files
}

fn has_suffix(name: &str, suffix: &str) -> bool {
    Path::new(name).extension().is_some_and(|found| found == suffix)
}

/// Checks that there is a file for each picture and table, complete by itself.
fn check_saved(seen: &Value, saved: &[Value]) -> Vec<(String, String)> {
    let text = |file: &Value, key: &str| file[key].as_str().unwrap().to_owned();
    let count = |end: &str| saved.iter().filter(|file| text(file, "name").ends_with(end)).count() as u64;
    let [pictures, tables] = ["pictures", "tables"].map(|key| seen[key].as_u64().unwrap());
    assert_eq!((count(".svg"), count(".csv")), (pictures, pictures + tables), "{seen}");
    for file in saved {
        let (name, content) = (text(file, "name"), text(file, "text"));
        if has_suffix(&name, "svg") {
            assert!(content.starts_with("<svg ") && content.ends_with("</svg>"), "{name}");
            // A viewer of its own knows neither the namespace nor the stylesheet of the page.
            assert!(
                content.contains("xmlns=\"http://www.w3.org/2000/svg\"") && content.contains("stroke:rgb("),
                "{name}"
            );
        } else {
            let mut reader = csv::ReaderBuilder::new().from_reader(content.as_bytes());
            let headings = reader.headers().unwrap().len();
            let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
            assert!(headings > 1 && !rows.is_empty(), "{name}: {content}");
        }
    }
    saved.iter().map(|file| (text(file, "name"), text(file, "text"))).collect()
}

/// The saved deviation of the measured circle goes from the least to the greatest one of the JSON.
fn check_circle(files: &[(String, String)], json: &Value) {
    let (_, csv) =
        files.iter().find(|(name, _)| name.starts_with("as-measured") && has_suffix(name, "csv")).unwrap();
    let mut reader = csv::ReaderBuilder::new().from_reader(csv.as_bytes());
    assert_eq!(reader.headers().unwrap(), vec!["curve", "angle, degrees", "radial deviation, µm"]);
    let rows: Vec<(String, f64, f64)> = reader.deserialize().map(Result::unwrap).collect();
    for direction in ["clockwise", "counter-clockwise"] {
        assert!(rows.iter().any(|(curve, ..)| curve == direction), "{direction}");
    }
    let um = |key: &str| json["iso_230_4_um"][key].as_f64().unwrap();
    let [least, greatest] = numerics::min_max(rows.iter().map(|row| row.2));
    let rounding = 1e-3 * numerics::max_abs(rows.iter().map(|row| row.2));
    assert!(
        (least - um("F_min")).abs() < rounding && (greatest - um("F_max")).abs() < rounding,
        "{least} {greatest} {json}"
    );
}

#[test]
fn pages_are_read_at_every_width_by_keyboard_and_as_files() {
    let Some(browser) = chromium() else {
        eprintln!("no Chromium: the pages were not looked at");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let [of_demo, of_circle, of_budget, of_trace] =
        ["demo", "circle", "budget", "trace"].map(|name| folder.path().join(name));
    let run = |arguments: &[&str]| {
        let done = Command::new(tests::program::lost_motion()).args(arguments).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join("host-sim");
    let [log, json] = ["circle.csv", "circle.json"].map(|name| folder.path().join(name));
    let text = |path: &Path| path.to_str().unwrap().to_owned();
    let machine = text(&root.join("machines/demo.toml"));
    run(&["demo", "--seed", "2", "--report", &text(&of_demo)]);
    let motion = text(&root.join("motions/circle.toml"));
    run(&["simulate", "--machine", &machine, "--motion", &motion, "--out", &text(&log)]);
    run(&["circle", &text(&log), "--report", &text(&of_circle), "--json", &text(&json)]);
    run(&["budget", "--model", &machine, "--report", &text(&of_budget)]);
    let limits = ["--limit", "G=8", "--limit", "corner=100", "--serial", "1", "--date", "2026-11-27"];
    let (log, of_trace_folder) = (text(&log), text(&of_trace));
    let trace = ["trace", "--machine", &machine, "--fit", &log, "--report", &of_trace_folder];
    run(&[&trace[..], &limits[..]].concat());
    check(browser, &of_demo.join("report.html"), true);
    let files = check(browser, &of_circle.join("report.html"), true);
    check_circle(&files, &serde_json::from_str(&fs::read_to_string(json).unwrap()).unwrap());
    check(browser, &of_budget.join("report.html"), false);
    // The held-out end of the log is no full circle.
    check(browser, &of_trace.join("report.html"), false);
}
