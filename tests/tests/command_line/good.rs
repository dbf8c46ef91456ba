//! What comes out when all is well, and what when the job itself fails.

use std::fs;

use serde_json::Value;

use super::desk::{Desk, MACHINE, MOTION, SIMULATE, TRACE, log};

fn desk() -> Desk {
    Desk::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION), ("fit.csv", log())])
}

/// The value at a path of keys and indices, which has to be there.
fn at<'a>(json: &'a Value, pointer: &str) -> &'a Value {
    json.pointer(pointer).unwrap_or_else(|| panic!("no {pointer} in {json}"))
}

#[test]
fn every_command_has_help() {
    let desk = desk();
    assert!(desk.done("--version").starts_with("lost-motion "));
    let overview = desk.done("--help");
    for command in ["demo", "simulate", "record", "compare", "reproduce", "self-test", "trace"] {
        assert!(overview.contains(command), "{overview}");
        assert!(desk.done(&format!("{command} --help")).contains("Usage: lost-motion"));
    }
}

#[test]
fn unusable_arguments_are_exit_2() {
    for arguments in [
        "",
        "frobnicate",
        "trace",
        "simulate --machine",
        "demo --seed minus-one",
        "compare --hours soon",
        "self-test --cases 0",
        "self-test --no-trace",
    ] {
        let output = desk().run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{arguments}");
    }
}

#[test]
fn a_seed_gives_the_same_log_every_time() {
    let desk = desk();
    let run = |seed: u32| {
        desk.done(&format!("{SIMULATE} --seed {seed}"));
        desk.read("out.csv")
    };
    let (first, again, other) = (run(5), run(5), run(6));
    assert!(first == again, "two runs of seed 5 differ");
    assert!(first != other, "seeds 5 and 6 give the same");
    assert_eq!(first.lines().count(), other.lines().count());
}

#[test]
fn every_number_format_closes_the_loop() {
    let desk = desk();
    let run = |scalar: &str| {
        let said = desk.done(&format!("{SIMULATE} --scalar {scalar}"));
        assert!(said.contains("out.csv") && said.contains("following error"), "{said}");
        desk.read("out.csv")
    };
    let [fixed, f32, f64] = ["fixed", "f32", "f64"].map(run);
    assert!(fixed == log(), "fixed is what is taken without --scalar");
    assert!(fixed != f64 && f32 != f64, "the formats round differently");
    let last_command = |log: &str| {
        let last = log.lines().last().unwrap();
        last.split(',').nth(1).unwrap().parse::<f64>().unwrap()
    };
    for log in [&fixed, &f32, &f64] {
        assert!((last_command(log) - 10.0).abs() < 1e-3, "the motion ends where it began");
    }
}

#[test]
fn a_compressed_log_is_the_same_log() {
    let desk = desk();
    desk.done(&SIMULATE.replace("out.csv", "fit.csv.gz"));
    assert!(fs::read(desk.path().join("fit.csv.gz")).unwrap().starts_with(&[0x1f, 0x8b]));
    let plain = desk.done("trace --machine machine.toml --fit fit.csv");
    assert_eq!(desk.done("trace --machine machine.toml --fit fit.csv.gz"), plain);
}

#[test]
fn nothing_is_found_where_nothing_is_undeclared() {
    let desk = desk();
    let circle = include_str!("../../../host-sim/motions/demo_circle.toml");
    fs::write(desk.path().join("motion.toml"), circle).unwrap();
    desk.done(&SIMULATE.replace("out.csv", "fit.csv"));
    let said = desk.done(TRACE);
    let json: Value = serde_json::from_str(&desk.read("out.json")).unwrap();
    assert_eq!(at(&json, "/effects"), &serde_json::json!([]), "{said}");
    for residual in at(&json, "/residual").as_array().unwrap() {
        let unit = if at(residual, "/channel") == "force" { "n" } else { "um" };
        for when in ["before", "after"] {
            for part in ["fit", "validate"] {
                assert!(at(residual, &format!("/{when}_{unit}/{part}")).as_f64().unwrap() >= 0.0);
            }
        }
        assert!(at(residual, &format!("/noise_{unit}")).as_f64().unwrap() > 0.0);
    }
    assert!(at(&json, "/unexplained").is_array());
    // The better model is a machine file as good as the declared one.
    desk.done(&SIMULATE.replace("machine.toml", "out.toml"));
    assert!(desk.read("report/report.html").starts_with("<!DOCTYPE html>"));
}

#[test]
fn a_log_may_come_from_standard_input() {
    let desk = desk();
    let from_file = desk.done("trace --machine machine.toml --fit fit.csv --json file.json");
    let output = desk.run_on("trace --machine machine.toml --fit - --json stdin.json", log().as_bytes());
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), from_file);
    assert_eq!(desk.read("stdin.json"), desk.read("file.json"));

    let output = desk.run_on("trace --machine machine.toml --fit -", b"no log\n");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        String::from_utf8(output.stderr).unwrap().starts_with("lost-motion: -: line 1: no log: expected")
    );
}

#[test]
fn an_output_that_cannot_be_written_is_named() {
    let desk = desk();
    let before = desk.content();
    for (command, output) in [(SIMULATE, "out.csv"), (TRACE, "out.json")] {
        let command = command.replace(output, &format!("nowhere/{output}"));
        let said = desk.fails(&command, 1);
        assert!(said.contains(&format!("nowhere/{output}: not written: there is no folder")), "{said}");
        assert!(desk.content() == before, "{command}");
    }
    // A folder cannot stand where a file does.
    let said = desk.fails("trace --machine machine.toml --fit fit.csv --report motion.toml", 1);
    assert!(said.contains("motion.toml"), "{said}");
    assert!(desk.content() == before);
}

#[test]
fn a_loop_that_does_not_hold_is_a_failed_job() {
    let desk = desk();
    // Too weak for its own friction, and told to go farther than the following error may grow.
    fs::write(desk.path().join("motion.toml"), MOTION.replace("x = 20.0", "x = 600.0")).unwrap();
    for (patience_s, reason) in
        [(0.2, "the force stands at its limit"), (60.0, "following error beyond its limit")]
    {
        let weak = format!("force_limit_n = 10.0\nsaturation_time_s = {patience_s}");
        fs::write(desk.path().join("machine.toml"), MACHINE.replace("force_limit_n = 20000.0", &weak))
            .unwrap();
        let said = desk.fails(SIMULATE, 1);
        assert!(said.contains(reason), "{said}");
        assert!(!desk.path().join("out.csv").exists());
    }
}

#[test]
fn a_link_that_breaks_is_a_failed_job() {
    let desk = desk();
    // No program for any chip: the emulator, if there is one, ends at once.
    let said = desk.fails("record --port emulated:motion.toml --motion motion.toml --out out.csv", 1);
    assert!(said.contains("link: "), "{said}");
    assert!(!desk.path().join("out.csv").exists());
}

#[test]
fn the_demo_gives_the_same_every_time() {
    let run = || {
        let desk = Desk::with(&[("other.txt", "")]);
        let said = desk.done("demo --seed 3 --json out.json --report .");
        (said, desk.read("out.json"), desk.read("report.html"))
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
    assert!(report.ends_with("</html>\n") && !report.contains("http://") && !report.contains("<script"));
}
