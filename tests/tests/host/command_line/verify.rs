//! `verify`: the same motions before and after a change, and the contour error that `simulate` prints.

use std::fs;
use std::sync::OnceLock;

use serde_json::Value;

use super::work_folder::{MACHINE, MOTION, WorkFolder};

/// A circle of 30 mm radius in both directions.
const CIRCLE: &str = include_str!("../../../../host-sim/motions/demo_ballbar.toml");

/// The difference between "before" and "after": 40 µm, so that it is well above the machine's friction peaks.
const BACKLASH: &str = "\n[[axis.x.effect]]\nname = \"backlash\"\nwidth_um = 40.0\n";

const VERIFY: &str = "verify --machine machine.toml --json out.json";

/// Logs of both motions on a machine with backlash and without, and what `simulate` printed for the circle with backlash.
struct Logs {
    circle: [String; 2],
    short: [String; 2],
    summary: String,
}

fn logs() -> &'static Logs {
    static LOGS: OnceLock<Logs> = OnceLock::new();
    LOGS.get_or_init(|| {
        let folder = WorkFolder::with(&[
            ("with.toml", format!("{MACHINE}{BACKLASH}")),
            ("without.toml", MACHINE.to_owned()),
            ("circle.toml", CIRCLE.to_owned()),
            ("short.toml", MOTION.to_owned()),
        ]);
        let simulate = |machine: &str, motion: &str| {
            let arguments = format!("simulate --machine {machine}.toml --motion {motion}.toml --out out.csv");
            let stdout = folder.succeeds(&arguments);
            (folder.read("out.csv"), stdout)
        };
        let (circle_with, summary) = simulate("with", "circle");
        let of = |motion: &str| [simulate("with", motion).0, simulate("without", motion).0];
        let circle = [circle_with, simulate("without", "circle").0];
        Logs { circle, short: of("short"), summary }
    })
}

/// A folder with the logs before and after, `with` and `without` backlash.
fn folder() -> WorkFolder {
    let Logs { circle, short, .. } = logs();
    WorkFolder::with(&[
        ("machine.toml", MACHINE),
        ("circle_with.csv", &circle[0]),
        ("circle_without.csv", &circle[1]),
        ("short_with.csv", &short[0]),
        ("short_without.csv", &short[1]),
    ])
}

fn json(folder: &WorkFolder) -> Value {
    serde_json::from_str(&folder.read("out.json")).unwrap()
}

fn number(json: &Value, pointer: &str) -> f64 {
    json.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer} in {json}"))
}

/// The number after a word in a line that starts with another one.
fn printed(text: &str, line: &str, number: usize) -> f64 {
    let line =
        text.lines().find(|found| found.starts_with(line)).unwrap_or_else(|| panic!("no {line} in {text}"));
    line.split_whitespace().filter_map(|word| word.parse().ok()).nth(number).unwrap()
}

#[test]
fn a_better_machine_is_confirmed_on_every_motion() {
    let folder = folder();
    // The order of the logs after is another one: they are paired by their commands.
    let stdout = folder.succeeds(&format!(
        "{VERIFY} --before circle_with.csv --before short_with.csv --after short_without.csv \
         --after circle_without.csv --report report"
    ));
    assert!(stdout.contains("smaller in 2, larger in 0, not distinguishable in 0"), "{stdout}");
    let json = json(&folder);
    let motions = json["motions"].as_array().unwrap();
    assert_eq!(
        motions.iter().map(|motion| &motion["name"]).collect::<Vec<_>>(),
        ["circle_with", "short_with"]
    );
    for motion in motions {
        assert_eq!(motion["change"], "better");
        assert!(motion["contour_error_um"]["predicted"].is_null());
    }
    // On the circle, half of the backlash is on either side of x: it adds (w/2)²/2 = 200 µm² to the mean square, less or more
    // where friction peaks and loop deviate, too, together 6 µm rms: (14.1 ± 6)² µm².
    let rms = |side: &str| number(&motions[0], &format!("/contour_error_um/{side}/rms"));
    let added = (rms("before").powi(2) - rms("after").powi(2)).sqrt();
    assert!((8.0..=20.0).contains(&added), "{added}");
    // A backlash of width w alone has a circular deviation of w; the deviation is a range, so that the two differ by at
    // most w, and by at least w less what the friction peaks (35 µm outwards) cover of the backlash's w/2 outwards.
    let [before, after] =
        ["before", "after"].map(|side| number(&motions[0], &format!("/circular_deviation_um/{side}")));
    assert!((20.0..=41.0).contains(&(before - after)), "{before} {after}");
    assert!(motions[1].get("circular_deviation_um").is_none(), "no full circle");
    let page = fs::read_to_string(folder.path().join("report/report.html")).unwrap();
    assert!(page.contains("Radial deviation of circle_with") && page.contains("Measured at the tool."));
    assert!(page.contains("Radial deviation from the programmed circle"));
    // Before and after on one scale, and after alone, each in picture and caption.
    assert_eq!(page.matches("magnified").count(), 3 * 2);
    assert!(page.contains("After, as large as it can be: "));
    let left_um = numerics::max(motions.iter().map(|motion| number(motion, "/contour_error_um/after/rms")));
    let left = files::format::significant(left_um, 3);
    let verdict = format!(
        "class=\"verdict\">The contour error became smaller in 2 of 2 motions; at most {left}\u{a0}µm rms are left, in "
    );
    assert!(page.contains(&verdict), "{verdict}");
    assert!(
        page.contains(
            "<th class=\"n\" scope=\"col\">before, µm</th><th class=\"n\" scope=\"col\">after</th>"
        ),
        "no prediction"
    );
}

/// `simulate` evaluates the path of the motion file, `verify` that of the logged command, which differ by rounding only.
#[test]
fn simulate_prints_the_same_contour_error() {
    /// Half of the last digit that is printed of 10 to 100 µm, and 1 nm: the logged command is rounded to a tenth of it.
    const TOLERANCE_UM: f64 = 0.05 + 0.001;
    let folder = folder();
    folder.succeeds(&format!("{VERIFY} --before circle_with.csv --after circle_without.csv"));
    let json = json(&folder);
    for (index, key) in [(0, "rms"), (1, "max")] {
        let verified = number(&json, &format!("/motions/0/contour_error_um/before/{key}"));
        let simulated = printed(&logs().summary, "whole path", index);
        assert!((verified - simulated).abs() < TOLERANCE_UM, "{key}: {verified} and {simulated}");
    }
    assert!(logs().summary.contains("both directions: circular deviation G(b)"), "{}", logs().summary);
}

#[test]
fn a_worse_machine_fails() {
    let folder = folder();
    let arguments = format!("{VERIFY} --before circle_without.csv --after circle_with.csv");
    let error = folder.fails(&arguments, 1);
    assert_eq!(error, "lost-motion: the contour error became larger: circle_without\n");
    assert_eq!(json(&folder)["motions"][0]["change"], "worse", "the result is written nevertheless");
    // Another run of the same machine: neither better nor worse.
    let machine = format!("{MACHINE}{BACKLASH}");
    fs::write(folder.path().join("with.toml"), machine).unwrap();
    fs::write(folder.path().join("circle.toml"), CIRCLE).unwrap();
    folder.succeeds("simulate --machine with.toml --motion circle.toml --seed 2 --out again.csv");
    let stdout = folder.succeeds(&format!("{VERIFY} --before circle_with.csv --after again.csv"));
    assert!(stdout.contains("not distinguishable in 1"), "{stdout}");
    let error = folder.fails(&format!("{VERIFY} --before circle_with.csv --after circle_with.csv"), 2);
    assert!(error.contains("circle_with.csv: expected another run of the motion"), "{error}");
}

#[test]
fn a_prediction_is_checked_within_its_bound() {
    let folder = folder();
    let arguments = format!("{VERIFY} --before circle_with.csv --after circle_without.csv");
    folder.succeeds(&arguments);
    let measured = json(&folder);
    let [before, after] =
        ["before", "after"].map(|side| number(&measured, &format!("/motions/0/contour_error_um/{side}/rms")));
    let predict = |after_um: f64, motion: &str| {
        let text = format!(
            "machine = \"demo\"\n\n[[predicted]]\nmotion = \"{motion}\"\nbefore_um = {before}\nafter_um = {after_um}\n\
             bound_percent = 10.0\n"
        );
        fs::write(folder.path().join("c.toml"), text).unwrap();
    };
    let arguments = format!("{arguments} --predicted c.toml");
    // Within ±10 % of the prediction; the sensors' noise adds far less than 1 %.
    for factor in [0.92, 1.08] {
        predict(after / factor, "circle");
        folder.succeeds(&arguments);
        let json = json(&folder);
        assert_eq!(json["motions"][0]["name"], "circle");
        assert_eq!(json["motions"][0]["as_predicted"], true);
        assert!((number(&json, "/motions/0/contour_error_um/predicted/rms") - after / factor).abs() < 1e-9);
    }
    for factor in [0.88, 1.12] {
        predict(after / factor, "circle");
        let error = folder.fails(&arguments, 1);
        assert_eq!(error, "lost-motion: the contour error is not as predicted: circle\n");
    }
    predict(after / 2.0, "small_circle");
    let error = folder.fails(&arguments, 2);
    assert!(
        error.contains("expected a prediction of circle_with (a path of 376.991 mm), found small_circle"),
        "{error}"
    );
    let text = fs::read_to_string(folder.path().join("c.toml")).unwrap();
    fs::write(folder.path().join("c.toml"), text.replace("\"demo\"", "\"another\"")).unwrap();
    let error = folder.fails(&arguments, 2);
    assert!(
        error.contains("c.toml: line 1: machine: expected a compensation of machine demo, found"),
        "{error}"
    );
}

#[test]
fn unusable_logs_are_refused() {
    let Logs { circle, .. } = logs();
    let folder = folder();
    let renamed = |from: &str, to: &str| circle[0].replacen(from, to, 1);
    let without = |word: &str| {
        let columns: Vec<bool> =
            circle[0].lines().next().unwrap().split(',').map(|c| !c.contains(word)).collect();
        let kept = |line: &str| {
            let cells = line.split(',').zip(&columns).filter(|(_, keep)| **keep).map(|(cell, _)| cell);
            cells.collect::<Vec<_>>().join(",") + "\n"
        };
        circle[0].lines().map(kept).collect::<String>()
    };
    for (content, message) in [
        (logs().short[1].clone(), "circle_with.csv: expected a log of the same motion"),
        (without("command"), "bad.csv: expected the command of each axis (NAME_command_mm), found none"),
        (without("_tool").replace("_motor", "_force").replace("_table", "_added_force"), "bad.csv: line 1"),
        (
            renamed(
                "y_command_mm,y_motor_mm,y_table_mm,y_tool_mm,y_force_n",
                "z_command_mm,z_motor_mm,z_table_mm,z_tool_mm,z_force_n",
            ),
            "bad.csv: expected axes of the machine file (x, y), found axis z",
        ),
    ] {
        fs::write(folder.path().join("bad.csv"), content).unwrap();
        let error = folder.fails(&format!("{VERIFY} --before circle_with.csv --after bad.csv"), 2);
        assert!(error.contains(message), "{error}");
        if message.contains("same motion") {
            assert!(error.contains("bad.csv"), "both files are named: {error}");
        }
    }
    let error = folder.fails(
        &format!("{VERIFY} --before circle_with.csv --after circle_without.csv --after short_without.csv"),
        2,
    );
    assert!(error.contains("short_without.csv: expected a log of the same motion"), "{error}");
    fs::write(folder.path().join("c.toml"), "[[predicted]]\nmotion = \"circle\"\nbefore_um = 1.0\n").unwrap();
    let arguments =
        format!("{VERIFY} --before circle_with.csv --after circle_without.csv --predicted c.toml");
    let error = folder.fails(&arguments, 2);
    assert!(error.starts_with("lost-motion: c.toml: "), "{error}");
    assert!(!folder.path().join("out.json").exists());
}

/// The log of a motion on the machine without backlash, with another seed of the noise, with the machine file changed.
fn another_run(machine: &str) -> String {
    let folder = WorkFolder::with(&[("machine.toml", machine), ("circle.toml", CIRCLE)]);
    folder.succeeds("simulate --machine machine.toml --motion circle.toml --seed 5 --out out.csv");
    folder.read("out.csv")
}

/// A column of a log changed, row by row; the header is row 0.
fn with_column(log: &str, name: &str, change: impl Fn(usize, f64) -> f64) -> String {
    let index = log.lines().next().unwrap().split(',').position(|column| column == name).unwrap();
    let row = |(row, line): (usize, &str)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if let (true, Ok(value)) = (row > 0, cells[index].parse::<f64>()) {
            cells[index] = change(row, value).to_string();
        }
        cells.join(",") + "\n"
    };
    log.lines().enumerate().map(row).collect()
}

/// One reading of 12,000 is 5 mm off before: of it alone, the rms would be 5000/√12000 = 46 µm. It is left out and named, so that the
/// machine, which is the same, is unchanged: 6.3 µm rms before and after.
#[test]
fn a_spike_is_a_fault_of_the_data_and_no_gain() {
    let folder = folder();
    let spiked =
        with_column(&logs().circle[1], "x_tool_mm", |row, mm| if row == 3000 { mm + 5.0 } else { mm });
    fs::write(folder.path().join("spiked.csv"), spiked).unwrap();
    fs::write(folder.path().join("again.csv"), another_run(MACHINE)).unwrap();
    let stdout = folder.succeeds(&format!("{VERIFY} --before spiked.csv --after again.csv"));
    assert!(
        stdout.contains("spiked.csv: x tool: a spike of up to 5000 µm at 2.999 s, left out."),
        "{stdout}"
    );
    let json = json(&folder);
    assert_eq!(json["motions"][0]["change"], "unchanged");
    let [before, after] =
        ["before", "after"].map(|side| number(&json, &format!("/motions/0/contour_error_um/{side}/rms")));
    assert!((5.0..8.0).contains(&before) && (before / after - 1.0).abs() < 0.01, "{before} {after}");
}

/// A probe with 10 µm of noise before: 6.3 µm of error and 10 µm of noise are 11.8 µm together. Two standard errors of 40 µm²
/// at 12,000 samples are 2·√((4·40·100 + 2.62·10⁴)/12000) = 3.8 µm², 0.3 µm of 6.3 µm.
#[test]
fn a_probe_with_more_noise_before_is_no_gain() {
    let folder = folder();
    let loud = MACHINE.replacen("[axis.x]", "[instruments]\ntool_noise_um = 10.0\n\n[axis.x]", 1);
    fs::write(folder.path().join("loud.csv"), another_run(&loud)).unwrap();
    let stdout = folder.succeeds(&format!("{VERIFY} --before loud.csv --after circle_without.csv"));
    assert!(stdout.contains("noise of 10.0 µm before and 0.08"), "{stdout}");
    let json = json(&folder);
    assert_eq!(json["motions"][0]["change"], "unchanged");
    let figure = |key: &str| number(&json, &format!("/motions/0/{key}"));
    let (before, after) = (figure("contour_error_um/before/rms"), figure("contour_error_um/after/rms"));
    assert!((before - after).abs() < 0.5 && figure("rms_with_noise_um/before") > 11.0, "{before} {after}");
}

/// The probe's cables are exchanged: on a full circle, the tool is on the circle nevertheless.
#[test]
fn exchanged_axes_of_the_tool_are_refused() {
    let folder = folder();
    let exchanged = |log: &str| {
        log.replacen("x_tool", "q_tool", 1).replacen("y_tool", "x_tool", 1).replacen("q_tool", "y_tool", 1)
    };
    fs::write(folder.path().join("exchanged.csv"), exchanged(&another_run(MACHINE))).unwrap();
    let error = folder.fails(&format!("{VERIFY} --before circle_with.csv --after exchanged.csv"), 2);
    assert_eq!(
        error,
        "lost-motion: exchanged.csv: expected commands and measured positions that belong to their axes, found x tool: exchanged\n"
    );
}

/// A prediction of the circle at its feed, compared with logs at half of it, and with logs of the motor.
#[test]
fn a_prediction_of_another_feed_or_channel_is_refused() {
    let folder = folder();
    fs::write(folder.path().join("circle.toml"), CIRCLE).unwrap();
    fs::write(
        folder.path().join("slow.toml"),
        CIRCLE.replace("feed_mm_per_min = 2000.0", "feed_mm_per_min = 1000.0"),
    )
    .unwrap();
    folder.succeeds("compensate --model machine.toml --motion circle.toml --out c.toml");
    for (side, seed) in [("before", 1), ("after", 2)] {
        let name = format!("demo_ballbar_{side}.csv");
        folder.succeeds(&format!(
            "simulate --machine machine.toml --motion slow.toml --seed {seed} --out {name}"
        ));
        let log = if side == "before" { logs().circle[1].clone() } else { another_run(MACHINE) };
        fs::write(folder.path().join(format!("motor_{name}")), motor_alone(&log)).unwrap();
    }
    let verify = format!(
        "{VERIFY} --before demo_ballbar_before.csv --after demo_ballbar_after.csv --predicted c.toml"
    );
    let error = folder.fails(&verify, 2);
    assert!(
        error.contains("found one that is not comparable: it is of a path of 376.991 mm in 11.5"),
        "{error}"
    );
    assert!(error.contains(" s, and the logs are of a path of 376.991 mm in 22.8"), "{error}");
    for side in ["before", "after"] {
        let name = format!("demo_ballbar_{side}.csv");
        fs::rename(folder.path().join(format!("motor_{name}")), folder.path().join(&name)).unwrap();
    }
    let error = folder.fails(&verify, 2);
    assert!(error.contains("it is of the tool, and the logs have the motor"), "{error}");
}

/// A log without the columns of table, tool and force.
fn motor_alone(log: &str) -> String {
    let header: Vec<&str> = log.lines().next().unwrap().split(',').collect();
    let is_kept = |index: usize| !["table", "tool", "force"].iter().any(|word| header[index].contains(word));
    let kept = |line: &str| {
        let cells = line.split(',').enumerate().filter(|(index, _)| is_kept(*index)).map(|(_, cell)| cell);
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    log.lines().map(kept).collect()
}
