//! Valid input: the outputs, and jobs that fail with exit code 1.

use std::fs;

use files::format::significant;
use serde_json::Value;

use super::work_folder::{MACHINE, MOTION, SIMULATE, TRACE, WorkFolder, log};

fn folder() -> WorkFolder {
    WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION), ("fit.csv", log())])
}

/// The value at a JSON pointer, which must exist.
fn at<'a>(json: &'a Value, pointer: &str) -> &'a Value {
    json.pointer(pointer).unwrap_or_else(|| panic!("no {pointer} in {json}"))
}

#[test]
fn every_command_has_help() {
    let folder = folder();
    assert!(folder.succeeds("--version").starts_with("lost-motion "));
    let overview = folder.succeeds("--help");
    for command in
        ["demo", "simulate", "record", "compare", "reproduce", "self-test", "trace", "verify", "import"]
    {
        assert!(overview.contains(command), "{overview}");
        assert!(folder.succeeds(&format!("{command} --help")).contains("Usage: lost-motion"));
    }
}

#[test]
fn invalid_arguments_end_with_exit_code_2() {
    for arguments in [
        "",
        "frobnicate",
        "trace",
        "verify --machine machine.toml --before fit.csv",
        "simulate --machine",
        "demo --seed minus-one",
        "compare --hours soon",
        "self-test --cases 0",
        "self-test --no-trace",
        "self-test --kind cursory",
        "self-test --kind shape,slip,shape",
        "self-test --detection --kind shape",
    ] {
        let output = folder().run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{arguments}");
    }
}

#[test]
fn a_log_is_determined_by_its_seed() {
    let folder = folder();
    let run = |seed: u32| {
        folder.succeeds(&format!("{SIMULATE} --seed {seed}"));
        folder.read("out.csv")
    };
    let (first, again, other) = (run(5), run(5), run(6));
    assert!(first == again, "two runs of seed 5 differ");
    assert!(first != other, "seeds 5 and 6 give the same log");
    assert_eq!(first.lines().count(), other.lines().count());
}

#[test]
fn every_number_format_closes_the_loop() {
    let folder = folder();
    let run = |scalar: &str| {
        let stdout = folder.succeeds(&format!("{SIMULATE} --scalar {scalar}"));
        assert!(stdout.contains("out.csv") && stdout.contains("following error"), "{stdout}");
        folder.read("out.csv")
    };
    let [fixed, f32, f64] = ["fixed", "f32", "f64"].map(run);
    assert!(fixed == log(), "fixed is the default");
    assert!(fixed != f64 && f32 != f64, "the formats round differently");
    let last_command = |log: &str| {
        let last = log.lines().last().unwrap();
        last.split(',').nth(1).unwrap().parse::<f64>().unwrap()
    };
    for log in [&fixed, &f32, &f64] {
        assert!((last_command(log) - 10.0).abs() < 1e-3, "the motion ends at its start");
    }
}

#[test]
fn a_compressed_log_gives_the_same_trace() {
    let folder = folder();
    folder.succeeds(&SIMULATE.replace("out.csv", "fit.csv.gz"));
    assert!(fs::read(folder.path().join("fit.csv.gz")).unwrap().starts_with(&[0x1f, 0x8b]));
    let plain = folder.succeeds("trace --machine machine.toml --fit fit.csv");
    assert_eq!(folder.succeeds("trace --machine machine.toml --fit fit.csv.gz"), plain);
}

#[test]
fn no_effect_is_found_without_undeclared_effects() {
    let folder = folder();
    let circle = include_str!("../../../../host-sim/motions/demo_circle.toml");
    fs::write(folder.path().join("motion.toml"), circle).unwrap();
    folder.succeeds(&SIMULATE.replace("out.csv", "fit.csv"));
    let stdout = folder.succeeds(TRACE);
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    assert_eq!(at(&json, "/effects"), &serde_json::json!([]), "{stdout}");
    for residual in at(&json, "/residual").as_array().unwrap() {
        let unit = if at(residual, "/channel") == "force" { "n" } else { "um" };
        for when in ["before", "after"] {
            for part in ["fit", "validate"] {
                assert!(at(residual, &format!("/{when}_{unit}/{part}")).as_f64().unwrap() >= 0.0);
            }
        }
        assert!(at(residual, &format!("/noise_{unit}")).as_f64().unwrap() > 0.0);
    }
    // The contour error of the log: both laps of the circle are full.
    assert_eq!(at(&json, "/contour/0/log"), "fit");
    assert_eq!(at(&json, "/contour/0/channel"), "tool");
    let [rms, max] =
        ["rms_um", "max_um"].map(|key| at(&json, &format!("/contour/0/{key}")).as_f64().unwrap());
    assert!(rms > 0.0 && rms < max, "{rms} {max}");
    for lap in 0..2 {
        let key = format!("/contour/0/circles/0/laps/{lap}/circular_deviation_um");
        assert!(at(&json, &key).as_f64().unwrap() > 0.0);
    }
    assert!(
        stdout.contains("contour error, µm") && folder.read("report/report.html").contains("Contour error")
    );
    assert_contour_table(&stdout, &json);
    assert!(at(&json, "/unexplained").is_array());
    // The model that was written is a complete machine file.
    folder.succeeds(&SIMULATE.replace("machine.toml", "out.toml"));
    assert!(folder.read("report/report.html").starts_with("<!DOCTYPE html>"));
}

/// The summary shows circular deviation G, hysteresis H and the largest reversal peak of the JSON, with three digits.
fn assert_contour_table(stdout: &str, json: &Value) {
    let mut lines = stdout.lines().skip_while(|line| !line.starts_with("contour error, µm"));
    let heading: Vec<&str> = lines.next().unwrap().split_whitespace().skip(3).collect();
    assert_eq!(heading, ["channel", "rms", "greatest", "G", "H", "peak", "overshoot"]);
    let row: Vec<&str> = lines.next().unwrap().split_whitespace().collect();
    assert_eq!((row.len(), row[0], row[1]), (1 + heading.len(), "fit", "tool"), "{row:?}");
    let circle = at(json, "/contour/0/circles/0");
    let laps = at(circle, "/laps").as_array().unwrap();
    let peaks = laps.iter().flat_map(|lap| at(lap, "/reversal_spikes_um").as_array().unwrap());
    let peak = peaks.map(|um| um.as_f64().unwrap()).max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap();
    let um = |key: &str| at(circle, key).as_f64().unwrap();
    let expected = [um("/circular_deviation_um"), um("/circular_hysteresis_um"), peak];
    assert_eq!(row[4..7], expected.map(|um| significant(um, 3)), "{row:?}");
    // The lines of the demo's friction: a figure that is not evaluated would be exactly 0.
    assert!(expected.iter().all(|um| um.abs() > 0.01), "{expected:?}");
}

/// A log of one axis has no direction across its path: its error is named for what it is.
#[test]
fn the_error_of_a_single_axis_is_called_its_following_error() {
    let y = MACHINE.find("[axis.y]").unwrap();
    let motion = "name = \"line\"\nfeed_mm_per_min = 3000.0\nacceleration_m_per_s2 = 2.0\nstart_mm = { x = 0.0 }\n\
                  [[block]]\nline_to_mm = { x = 30.0 }\n[[block]]\nline_to_mm = { x = 0.0 }\n";
    let folder = WorkFolder::with(&[("machine.toml", &MACHINE[..y]), ("motion.toml", motion)]);
    let simulated = folder.succeeds(&SIMULATE.replace("out.csv", "fit.csv"));
    let stdout = folder.succeeds(TRACE);
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    assert_eq!(at(&json, "/contour/0/is_along_axis"), true);
    assert!(simulated.contains("error along the axis at the tool, µm"), "{simulated}");
    assert!(!simulated.contains("contour error"), "{simulated}");
    let row = stdout.lines().find(|line| line.starts_with("fit ")).unwrap();
    assert!(row.ends_with("  (one axis: following error)"), "{stdout}");
    let page = folder.read("report/report.html");
    assert!(page.contains("tool (one axis: following error)"));
    for text in [&simulated, &stdout, &page] {
        assert!(!text.to_lowercase().contains("distance from the path"), "{text}");
    }
}

/// The circle of the examples: to its start, once round each way with the dwells, feed and exact stops of the motion.
#[test]
fn a_motion_becomes_a_program() {
    let motion = include_str!("../../../../host-sim/motions/circle.toml");
    let rotary = motion.replace("y = ", "c = ").replace("\"y\"", "\"c\"");
    let folder = WorkFolder::with(&[("circle.toml", motion), ("rotary.toml", rotary.as_str())]);
    assert_eq!(
        folder.succeeds("gcode --motion circle.toml --format linuxcnc --out a.ngc"),
        "Program: a.ngc\n"
    );
    let expected = "(circle)\n(Check travel and clearance. The zero of the program is the zero of the motion.)\nG21 G90 G94 G40\n\
                    G1 X50.00000 Y0.00000 F2000.0\nG4 P0.200\n(acceleration 1 m/s2, constant while it lasts)\nG61\nF2000.0\nG17\n\
                    G3 X50.00000 Y0.00000 I-50.00000 J0.00000\nG4 P0.300\nG2 X50.00000 Y0.00000 I-50.00000 J0.00000\nG4 P0.200\nM2\n";
    assert_eq!(folder.read("a.ngc"), expected);
    let error = folder.fails("gcode --motion rotary.toml --format fanuc --out b.nc", 2);
    assert_eq!(error, "lost-motion: rotary.toml: expected axes x, y, z, u, v or w, found c\n");
    assert!(!folder.path().join("b.nc").exists());
}

#[test]
fn a_log_may_come_from_standard_input() {
    let folder = folder();
    let from_file = folder.succeeds("trace --machine machine.toml --fit fit.csv --json file.json");
    let output = folder.run_on("trace --machine machine.toml --fit - --json stdin.json", log().as_bytes());
    assert_eq!(output.status.code(), Some(0));
    // Only the name of the log differs, in the table of contour errors.
    assert_eq!(String::from_utf8(output.stdout).unwrap(), from_file.replace("\nfit  ", "\n-    "));
    let of_file = folder.read("file.json").replace("\"log\": \"fit\"", "\"log\": \"-\"");
    assert_eq!(folder.read("stdin.json"), of_file);

    let output = folder.run_on("trace --machine machine.toml --fit -", b"no log\n");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        String::from_utf8(output.stderr).unwrap().starts_with("lost-motion: -: line 1: no log: expected")
    );
}

#[test]
fn an_output_that_cannot_be_written_is_named() {
    let folder = folder();
    let before = folder.contents();
    for (command, output) in [(SIMULATE, "out.csv"), (TRACE, "out.json")] {
        let command = command.replace(output, &format!("nowhere/{output}"));
        let message = folder.fails(&command, 1);
        assert!(message.contains(&format!("nowhere/{output}: not written: there is no folder")), "{message}");
        assert!(folder.contents() == before, "{command}");
    }
    // The folder for the page is the path of an existing file.
    let message = folder.fails("trace --machine machine.toml --fit fit.csv --report motion.toml", 1);
    assert!(message.contains("expected a folder, found a file: motion.toml"), "{message}");
    assert!(folder.contents() == before);
}

#[test]
fn a_fault_of_the_loop_is_a_failed_job() {
    let folder = folder();
    // Its force limit is below its friction, and the motion is longer than the limit of the following error.
    fs::write(folder.path().join("motion.toml"), MOTION.replace("x = 20.0", "x = 600.0")).unwrap();
    for (saturation_time_s, reason) in
        [(0.2, "force at its limit of 10 N for 0.2 s in total"), (60.0, "following error beyond its limit")]
    {
        let weak = format!("force_limit_n = 10.0\nsaturation_time_s = {saturation_time_s}");
        fs::write(folder.path().join("machine.toml"), MACHINE.replace("force_limit_n = 20000.0", &weak))
            .unwrap();
        let message = folder.fails(SIMULATE, 1);
        assert!(message.contains(reason), "{message}");
        assert!(!folder.path().join("out.csv").exists());
    }
}

#[test]
fn a_broken_link_is_a_failed_job() {
    let folder = folder();
    // Not a program: the emulator, if it is installed, ends at once.
    let message = folder.fails("record --port emulated:motion.toml --motion motion.toml --out out.csv", 1);
    assert!(message.contains("link: "), "{message}");
    assert!(!folder.path().join("out.csv").exists());
}

#[test]
fn the_demo_is_determined_by_its_seed() {
    let run = || {
        let folder = WorkFolder::with(&[("other.txt", "")]);
        let stdout = folder.succeeds("demo --seed 3 --json out.json --report .");
        (stdout, folder.read("out.json"), folder.read("report.html"))
    };
    let (first, again) = (run(), run());
    assert!(first == again, "two runs of seed 3 differ");

    let (_, json, report) = first;
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(at(&json, "/seed"), 3);
    for effects in ["/undeclared", "/found"] {
        for effect in at(&json, effects).as_array().unwrap() {
            assert!(at(effect, "/name").is_string() && at(effect, "/axis").is_string());
            let parameters = at(effect, "/parameters").as_object().unwrap();
            assert!(parameters.values().all(|parameter| at(parameter, "/value").is_number()));
        }
    }
    assert_eq!(at(&json, "/undeclared").as_array().unwrap().len(), 1);
    let [before, after, noise] =
        ["before", "after", "noise"].map(|key| at(&json, &format!("/residual_um/{key}")).as_f64().unwrap());
    assert!(before > after && after > 0.5 * noise && noise > 0.0, "{json}");
    assert!(
        report.ends_with("</html>\n")
            && !report.contains("http://")
            && report.matches("<script").count() <= 1
    );
}
