//! Pages in headless Chromium: at 390, 768 and 1280 pixels nothing scrolls sideways and no script fails; the slider of a circle, its causes, and
//! the magnification of a chart change what is drawn, and the pointer shows the figures under it; pictures and tables are saved as files;
//! nothing hinders keyboards and screen readers. A page is printed.
//! `run.sh all` installs Chromium; without it, the test says so and passes.

mod acted;
mod axe;
mod printed;

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

const HARNESS: &str = include_str!("harness.html");

pub fn chromium() -> Option<&'static str> {
    let runs = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    ["chromium", "chromium-browser", "google-chrome"].into_iter().find(runs)
}

/// Lines of a row of a table: the parameters of an effect, with the spaces above and below them.
const MOST_LINES: f64 = 7.5;

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

/// What a page has to be seen on it.
#[derive(Clone, Copy, Default)]
struct Has {
    circle: bool,
    chart: bool,
    choices: bool,
}

/// What was seen of a page: at each width, and the files that it saves, by name and text.
struct Seen {
    widths: Vec<Value>,
    files: Vec<(String, String)>,
}

impl Seen {
    /// The figures of a picture, by the beginning of its name.
    fn csv(&self, name: &str) -> &str {
        let is_of = |file: &&(String, String)| file.0.starts_with(name) && has_suffix(&file.0, "csv");
        &self.files.iter().find(is_of).unwrap_or_else(|| panic!("no {name}")).1
    }
}

/// Checks a page.
fn check(browser: &str, page: &Path, has: Has) -> Seen {
    let has_axe = axe::put_beside(page);
    let mut files = Vec::new();
    let mut widths = seen(browser, page);
    for seen in &mut widths {
        let saved = seen["saved"].take();
        let width = seen["width"].as_f64().unwrap();
        assert_eq!(seen["errors"], serde_json::json!([]), "{seen}");
        assert!(seen["scroll"].as_f64().unwrap() <= width, "{}: {seen}", page.display());
        check_crowded(seen);
        for (key, is_there) in [("before", has.circle), ("chart", has.chart), ("choices", has.choices)] {
            assert_eq!(seen.get(key).is_some(), is_there, "{key}: {seen}");
        }
        if has.circle {
            check_magnified(seen);
        }
        if !saved.is_null() {
            files = check_saved(seen, saved.as_array().unwrap());
            assert_eq!(seen["unnamed"], 0, "each picture has a title: {seen}");
            let expected = if has_axe { serde_json::json!([]) } else { Value::Null };
            assert_eq!(seen["hindrances"], expected, "{}", page.display());
        }
    }
    assert!(!files.is_empty(), "{}", page.display());
    assert!(fs::metadata(page).unwrap().len() < 1_000_000, "{}", page.display());
    let seen = Seen { widths, files };
    if has.chart {
        for at_width in &seen.widths {
            acted::check_chart(at_width, seen.csv(at_width["chart"]["file"].as_str().unwrap()));
        }
    }
    seen
}

/// What is cut at the edge of a narrow page shows it, and no column is so narrow that the rows of a table are mostly blank.
fn check_crowded(seen: &Value) {
    assert_eq!(seen["cut"], seen["faded"], "{seen}");
    assert!(seen["highest_row"].as_f64().unwrap() <= MOST_LINES, "{seen}");
}

/// At a magnification of 4, the line goes farther out.
fn check_magnified(seen: &Value) {
    assert!(seen["after"].as_f64().unwrap() > 1.02 * seen["before"].as_f64().unwrap(), "{seen}");
    assert!(seen["division"].as_str().unwrap().starts_with("division "), "{seen}");
    let hover = seen["hover"].as_str().unwrap();
    assert!(hover.starts_with("0.0°") || hover.starts_with("360.0°"), "{seen}");
    assert!(hover.contains("wise") && hover.contains(" µm"), "{seen}");
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
fn check_circle(csv: &str, json: &Value) {
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

/// A program run whose outputs the pages are compared with.
fn run(arguments: &[&str]) {
    let done = Command::new(tests::program::lost_motion()).args(arguments).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

fn path(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

fn json(file: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// The machine of the demo, and a motion once round in each direction.
fn machine_and_circle() -> [String; 2] {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join("host-sim");
    ["machines/demo.toml", "motions/circle.toml"].map(|name| path(&root.join(name)))
}

#[test]
fn pages_are_read_at_every_width_by_keyboard_and_as_files() {
    let Some(browser) = chromium() else {
        eprintln!("no Chromium: the pages were not looked at");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |name: &str| path(&folder.path().join(name));
    let page = |name: &str| folder.path().join(name).join("report.html");
    let [machine, motion] = machine_and_circle();
    let [log, of_circle, of_budget] = ["circle.csv", "circle.json", "budget.json"].map(in_folder);
    run(&["demo", "--seed", "2", "--report", &in_folder("demo")]);
    run(&["simulate", "--machine", &machine, "--motion", &motion, "--out", &log]);
    run(&["circle", &log, "--report", &in_folder("circle"), "--json", &of_circle]);
    run(&["budget", "--model", &machine, "--report", &in_folder("budget"), "--json", &of_budget]);
    let limits = ["--limit", "G=8", "--limit", "corner=100", "--serial", "1", "--date", "2026-11-27"];
    let of_trace = in_folder("trace");
    let trace = ["trace", "--machine", &machine, "--fit", &log, "--report", &of_trace];
    run(&[&trace[..], &limits[..]].concat());

    let all = Has { circle: true, chart: true, choices: true };
    check(browser, &page("demo"), all);
    let circle = check(browser, &page("circle"), Has { circle: true, ..Has::default() });
    check_circle(circle.csv("as-measured"), &json(&of_circle));
    for seen in &circle.widths {
        acted::check_circle_reading(seen["hover"].as_str().unwrap(), circle.csv("as-measured"));
    }
    for seen in &check(browser, &page("budget"), Has { chart: false, ..all }).widths {
        acted::check_choices(seen, &json(&of_budget));
    }
    let traced = check(browser, &page("trace"), all);
    printed::check(browser, &page("trace"), traced.widths[0]["sheet"].as_f64().unwrap());
}

/// A positioning test of three runs: runs are whole, and what its lines are is said.
#[test]
fn the_page_of_a_positioning_test_is_read_at_every_width() {
    let Some(browser) = chromium() else {
        eprintln!("no Chromium: the page was not looked at");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |name: &str| path(&folder.path().join(name));
    let reading = |run: u32, sign: &str, i: u32| {
        // A known ripple in place of noise, a gap, a slope, a wave and a drift.
        let ripple = f64::from((7919 * (i + 31 * run)) % 101) / 300.0;
        let gap = if sign == "+" { -3.0 } else { 3.0 };
        let um = ripple + gap + 0.6 * f64::from(i) + 2.0 * f64::from(i).sin() + 0.8 * f64::from(run);
        format!("{run},{sign},{},{um:.3}\n", 30 * i)
    };
    let runs = (1..=3).flat_map(|run| {
        let there = (0..11).map(move |i| reading(run, "+", i));
        there.chain((0..11).rev().map(move |i| reading(run, "-", i)))
    });
    let table = "run,approach,target_mm,deviation_um\n".to_owned() + &runs.collect::<String>();
    fs::write(folder.path().join("x.csv"), table).unwrap();
    run(&["positions", "--fit", &in_folder("x.csv"), "--report", &in_folder("page")]);
    let page = folder.path().join("page/report.html");
    for seen in seen(browser, &page) {
        assert_eq!(seen["errors"], serde_json::json!([]), "{seen}");
        assert!(seen["scroll"].as_f64().unwrap() <= seen["width"].as_f64().unwrap(), "{seen}");
        check_crowded(&seen);
    }
    let html = fs::read_to_string(page).unwrap();
    let runs = html.split_once("From run to run").unwrap().1;
    let labels = runs.split_once("class=\"ticks\"").unwrap().1.split_once("</g>").unwrap().0;
    for label in ["1", "2", "3"] {
        assert!(labels.contains(&format!(">{label}</text>")), "{labels}");
    }
    assert_eq!(labels.matches("</text>").count(), 3, "{labels}");
    for way in ["approached in +\u{a0}direction", "in −\u{a0}direction"] {
        assert!(runs.contains(way), "{way}");
    }
}

/// The circle after a change is drawn once more, with a magnification and a slider of its own.
#[test]
fn the_page_of_verify_says_first_what_became_of_the_motion() {
    let Some(browser) = chromium() else {
        eprintln!("no Chromium: the page was not looked at");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |name: &str| path(&folder.path().join(name));
    let [machine, motion] = machine_and_circle();
    let [worse, before, after, to_json] =
        ["worse.toml", "before.csv", "after.csv", "verify.json"].map(in_folder);
    let backlash = "\n[[axis.x.effect]]\nname = 'backlash'\nwidth_um = 60.0\n";
    fs::write(&worse, fs::read_to_string(&machine).unwrap() + backlash).unwrap();
    run(&["simulate", "--machine", &worse, "--motion", &motion, "--out", &before]);
    run(&["simulate", "--machine", &machine, "--motion", &motion, "--out", &after]);
    let of_verify = in_folder("verify");
    let logs = ["verify", "--machine", &machine, "--before", &before, "--after", &after, "--json", &to_json];
    run(&[&logs[..], &["--report", &of_verify, "--limit", "rms=1000", "--limit", "G=0.001"]].concat());
    let page = folder.path().join("verify/report.html");
    let seen = check(browser, &page, Has { circle: true, ..Has::default() });
    let json = &json(&to_json)["motions"][0];
    let [from, to] = ["before", "after"]
        .map(|side| files::format::significant(json["contour_error_um"][side]["rms"].as_f64().unwrap(), 3));
    let html = fs::read_to_string(&page).unwrap();
    let verdict = format!(
        "class=\"verdict\">The contour error of before became smaller, from {from} to {to}\u{a0}µm rms, and G from "
    );
    assert!(html.contains(&verdict), "{verdict}");
    assert!(html.contains("; beyond the limit: G; within the limit: rms.</p>"));
    for cells in [
        "<td>rms</td>",
        "<td class=\"n\">1000</td><td class=\"result\">pass</td>",
        "<td class=\"n\">0.00100</td><td class=\"result\">fail</td>",
    ] {
        assert!(html.contains(cells), "{cells}");
    }
    let pictures = seen.widths[2]["pictures"].as_u64().unwrap();
    assert_eq!(
        (pictures, html.matches("<svg viewBox=\"0 0 310 310\"").count()),
        (3, 3),
        "before, after, after alone"
    );
}
