//! Runs that do not reach their end: rejected, ended by a fault with reason and time, or interrupted. They leave no log.

use super::work_folder::{MACHINE, MOTION, SIMULATE, WorkFolder};

/// The machine with keys changed on all axes, or added to the first one.
fn machine(changes: &[(&str, &str)]) -> String {
    let mut text: Vec<String> = MACHINE.lines().map(str::to_owned).collect();
    for (key, value) in changes {
        let is_key = |line: &String| line.split('=').next().is_some_and(|name| name.trim() == *key);
        let changed = format!("{key} = {value}");
        if text.iter().any(is_key) {
            text.iter_mut().filter(|line| is_key(line)).for_each(|line| line.clone_from(&changed));
        } else {
            let axis = text.iter().position(|line| line.starts_with("[axis.")).unwrap();
            text.insert(axis + 1, changed);
        }
    }
    text.join("\n")
}

fn assert_fails(machine: &str, motion: &str, code: i32, expected: &[&str]) {
    for out in ["out.csv", "out.csv.gz"] {
        let folder = WorkFolder::with(&[("machine.toml", machine), ("motion.toml", motion)]);
        let before = folder.contents();
        let message = folder.fails(&SIMULATE.replace("out.csv", out), code);
        for part in expected {
            assert!(message.contains(part), "{part} in {message}");
        }
        assert!(folder.contents() == before, "{message}");
    }
}

/// A minute of circles, within which an unstable loop faults.
fn long() -> String {
    MOTION.replace("turns = 0.25", "turns = 50.0")
}

#[test]
fn unstable_gains_fault_with_the_time() {
    // Above the resonance of the screw the velocity loop drives the mass of the motor alone and is unstable beyond
    // Kv·Δt/m = 2: 1e6 · 0.25 ms / 90 kg is 2.8.
    let saturated = [
        "axis.x: force at its limit of 20000 N for 1 s in total: stopped after ",
        " s: is the loop unstable",
    ];
    assert_fails(&machine(&[("velocity_gain_n_s_per_m", "1e6")]), &long(), 1, &saturated);
    // With a long saturation time the following error faults.
    let patient = [
        ("velocity_gain_n_s_per_m", "1e6"),
        ("saturation_time_s", "1e4"),
        ("following_error_limit_mm", "0.5"),
    ];
    let following =
        ["following error beyond its limit of 0.5 mm: stopped after ", " s: is the loop unstable"];
    assert_fails(&machine(&patient), &long(), 1, &following);
}

#[test]
fn an_axis_that_needs_too_short_steps_is_rejected_with_its_key() {
    let stiff = [
        "machine.toml: axis.x.presliding_stiffness_n_per_um: expected an axis that steps of 1 µs can resolve",
    ];
    assert_fails(&machine(&[("presliding_stiffness_n_per_um", "1e12")]), MOTION, 2, &stiff);
    let light = ["machine.toml: axis.x.motor_coulomb_n: expected an axis that steps of 1 µs can resolve"];
    assert_fails(&machine(&[("motor_mass_kg", "1e-9")]), MOTION, 2, &light);
    for key in ["motor_mass_kg", "table_mass_kg"] {
        let none = ["machine.toml: line ", key, "expected a mass above 0"];
        assert_fails(&machine(&[(key, "0.0")]), MOTION, 2, &none);
        let negative = ["machine.toml: line ", key];
        assert_fails(&machine(&[(key, "-1.0")]), MOTION, 2, &negative);
        assert_fails(&machine(&[(key, "nan")]), MOTION, 2, &negative);
        assert_fails(&machine(&[(key, "inf")]), MOTION, 2, &negative);
    }
}

#[test]
fn numbers_out_of_range_are_rejected() {
    for (key, value, expected) in [
        (
            "stiffness_n_per_um",
            "1e300",
            "stiffness_n_per_um: expected a number above 0, at most 1e12, found 1e300",
        ),
        ("damping_n_s_per_m", "1e80", "damping_n_s_per_m: expected a number not below 0, at most 1e12"),
        (
            "following_error_limit_mm",
            "1e11",
            "axis.x.following_error_limit_mm: expected a number from 0 to 132.9",
        ),
    ] {
        assert_fails(&machine(&[(key, value)]), MOTION, 2, &["machine.toml: ", expected]);
    }
    let effect = |text: &str| format!("{MACHINE}\n[[axis.x.effect]]\nname = {text}\n");
    for (text, expected) in [
        (
            "\"windup\"\nstiffness_n_per_um = 1e300",
            "effect[0].stiffness_n_per_um: expected a number above 0, at most 1e12",
        ),
        ("\"latency\"\nchannel = \"tool\"\nms = 1e5", "effect[0].ms: expected a number within ±1000"),
        ("\"velocity_lag\"\nms = 50.0", "effect[0].ms: expected a number within ±0.25, found 50"),
        (
            "\"resonance\"\nchannel = \"table\"\nfrequency_hz = 40.0\ndamping_ratio = 0.1",
            "effect[0].channel: expected \"tool\"",
        ),
        (
            "\"resonance\"\nfrequency_hz = 40.0\ndamping_ratio = 0.1\ndamped_against = \"motor\"",
            "axis.x.effect[0].damped_against: expected ground or table, found \"motor\"",
        ),
        (
            "\"servo_mismatch\"\npercent = 1.0\n[[axis.x.effect]]\nname = \"servo_mismatch\"\npercent = 2.0",
            "effect[1]: expected at most one effect of this name",
        ),
    ] {
        assert_fails(&effect(text), MOTION, 2, &["machine.toml: ", expected]);
    }
}

/// A resonance far above the sample rate does not make the simulation unstable.
#[test]
fn a_fast_resonance_stays_in_bounds() {
    for (frequency_hz, damping_ratio) in [(1250.0, 0.02), (400.0, 0.001), (60.0, 30.0)] {
        let effect = format!(
            "[[axis.x.effect]]\nname = \"resonance\"\nfrequency_hz = {frequency_hz:?}\ndamping_ratio = {damping_ratio:?}\n"
        );
        let folder = WorkFolder::with(&[
            ("machine.toml", format!("{MACHINE}\n{effect}").as_str()),
            ("motion.toml", MOTION),
        ]);
        folder.succeeds(SIMULATE);
        let log = folder.read("out.csv");
        let column = log.lines().next().unwrap().split(',').position(|name| name == "x_tool_mm").unwrap();
        let tool =
            log.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse::<f64>().unwrap());
        // From −10 to 20 mm, and a lag of 2ζ/ω = 0.16 s at 50 mm/s.
        assert!(tool.map(f64::abs).fold(0.0, f64::max) < 21.0, "{frequency_hz} Hz, {damping_ratio}");
    }
}

#[test]
fn motions_beyond_the_travel_are_rejected() {
    // The motion reaches x = 20 mm.
    let beyond_travel = ["motion.toml: ", "block[", "axis.x.travel_mm, -5 to 15 mm, of ", "machine.toml"];
    assert_fails(&machine(&[("travel_mm", "[-5.0, 15.0]")]), MOTION, 2, &beyond_travel);
    let beyond = ["motion.toml: ", "block[0]"];
    assert_fails(MACHINE, &MOTION.replace("x = 20.0", "x = 200e3"), 2, &beyond);
}

#[test]
fn impossible_structures_are_rejected() {
    let bodies = include_str!("../../../../host-sim/machines/bodies.toml");
    let with = |old: &str, new: &str| {
        assert!(bodies.contains(old), "{old}");
        bodies.replacen(old, new, 1)
    };
    for (text, expected) in [
        (with("mass_kg = 5000.0", "mass_kg = 0.0"), "body.bed.mass_kg"),
        (with("kind = \"foot\"", "kind = \"balloon\""), "balloon"),
        (with("[structure.axis.z]", "[structure.axis.w]"), "the axes of the machine: x, y, z"),
        (with("to = \"table\"\ndirection", "to = \"pallet\"\ndirection"), "pallet"),
        (
            with("stiffness_n_per_um = [100.0, 300.0, 100.0]", "stiffness_n_per_um = [0.0, 0.0, 0.0]"),
            "can move freely",
        ),
        (
            with("[100.0, 300.0, 100.0]", "[1e300, 300.0, 100.0]"),
            "structure.joint[0].stiffness_n_per_um: expected",
        ),
        (
            with("direction = [-1.0, 0.0, 0.0]", "direction = [0.0, 1.0, 0.0]"),
            "structure: an axis drives in a direction",
        ),
        (
            with("from = \"bed\"\nto = \"table\"\ndirection", "from = \"table\"\nto = \"table\"\ndirection"),
            "structure.axis.x.to: ",
        ),
        (with("body = \"table\"", "body = \"ground\""), "structure.axis.x: does not move the tool"),
    ] {
        assert_fails(&text, MOTION, 2, &["machine.toml: ", expected]);
    }
}

/// A signal while the program writes its log: no incomplete file remains, and the exit code is 130.
#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_no_file() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let dwell = "name = \"long\"\nfeed_mm_per_min = 1.0\nacceleration_m_per_s2 = 1.0\nstart_mm = { x = 0.0, y = 0.0 }\n\
                 [[block]]\ndwell_s = 3500.0\n";
    for signal in ["INT", "TERM"] {
        let folder = WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", dwell)]);
        let before = folder.contents();
        let mut child = Command::new(tests::program::lost_motion())
            .args(SIMULATE.split_whitespace())
            .current_dir(folder.path())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while folder.contents().len() == before.len() && start.elapsed() < Duration::from_secs(30) {
            std::thread::sleep(Duration::from_millis(20));
        }
        assert!(folder.contents().len() > before.len(), "expected the program to have started to write");
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &id]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert!(folder.contents() == before, "{signal}");
    }
}

/// A signal between two cases: the finished cases are written, and the exit code is 130.
#[cfg(unix)]
#[test]
fn an_interrupted_self_test_keeps_its_finished_cases() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let folder = WorkFolder::with(&[("machine.toml", MACHINE)]);
    let child = Command::new(tests::program::lost_motion())
        .args("self-test --cases 1000 --seed 3 --keep . --no-trace".split_whitespace())
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let start = Instant::now();
    // The second case starts when the first one is finished.
    while !folder.path().join("case-2").exists() && start.elapsed() < Duration::from_mins(1) {
        std::thread::sleep(Duration::from_millis(20));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", "INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(stdout.contains("cases drawn."), "{stdout}");
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("interrupted after") && message.contains("of 1000 cases"), "{message}");
    let truth = std::fs::read_to_string(folder.path().join("case-1/truth.json")).unwrap();
    assert!(truth.contains("\"effects\""), "{truth}");
}

/// A line there and back with 20 s of standstill.
const LONG: &str = "name = \"long\"\nfeed_mm_per_min = 6000.0\nacceleration_m_per_s2 = 1.0\nstart_mm = { x = 0.0, y = 0.0 }\n\
                    [[block]]\ndwell_s = 1.0\n[[block]]\nline_to_mm = { x = 90.0, y = 60.0 }\n[[block]]\ndwell_s = 20.0\n\
                    [[block]]\nline_to_mm = { x = 0.0, y = 0.0 }\n";

/// Blocks of 100 circles, 126 s each; a block holds a limited number of turns.
fn circles(blocks: usize) -> String {
    let block =
        "[[block]]\narc = { plane = [\"x\", \"y\"], centre_mm = { x = 0.0, y = 0.0 }, turns = 100.0 }\n";
    "name = \"circles\"\nfeed_mm_per_min = 6000.0\nacceleration_m_per_s2 = 1.0\nstart_mm = { x = 20.0, y = 0.0 }\n".to_owned()
        + &block.repeat(blocks)
}

/// The machine with a calibration table of axis x: a wave of 1 µm at 1000 points.
fn with_calibration_table() -> String {
    let list = |value: fn(f64) -> f64| {
        let at = |i: u32| value(-100.0 + 200.0 * f64::from(i) / 999.0);
        (0..1000).map(|i| format!("{:.6}", at(i))).collect::<Vec<_>>().join(", ")
    };
    let (positions, errors) = (list(|mm| mm), list(|mm| (0.05 * mm).sin()));
    format!(
        "{MACHINE}\n[[axis.x.effect]]\nname = \"pitch_map\"\npositions_mm = [{positions}]\nerror_um = [{errors}]\n"
    )
}

/// Starts a command, interrupts it after 0.3 s, and asserts that it ends within a second, without an output. A second is what a person
/// waits before the second attempt; the polls take 50 ms, and the rest is for a busy computer.
#[cfg(unix)]
fn assert_ends_within_a_second(folder: &WorkFolder, arguments: &str) {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let before = folder.contents();
    let mut command = Command::new(tests::program::lost_motion());
    command.args(arguments.split_whitespace()).current_dir(folder.path());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "{arguments}: expected seconds of work");
    let start = Instant::now();
    assert!(Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130), "{arguments}");
    assert!(start.elapsed() < Duration::from_secs(1), "{arguments}: {:?}", start.elapsed());
    assert!(folder.contents() == before, "{arguments}");
}

/// The commands that search, in a log or among settings, each for more than a second: `margins` ends within 0.3 s by itself.
#[cfg(unix)]
#[test]
fn long_computations_end_within_a_second() {
    let folder = WorkFolder::with(&[
        ("machine.toml", MACHINE),
        ("table.toml", with_calibration_table().as_str()),
        ("motion.toml", LONG),
    ]);
    folder.succeeds("simulate --machine machine.toml --motion motion.toml --out log.csv");
    for arguments in [
        "trace --machine machine.toml --fit log.csv --json out.json --model out.toml --report report",
        "trace --machine table.toml --fit log.csv --json out.json --model out.toml --report report",
        "compare --json out.json",
        "reproduce --json out.json",
        "sensors --json out.json",
        "demo --json out.json --report report",
        "self-test --cases 1000 --seed 3",
        "tune --machine machine.toml --out out.toml",
    ] {
        assert_ends_within_a_second(&folder, arguments);
    }
}

/// The commands that run or evaluate motions: 52 minutes of circles, and logs of two minutes.
#[cfg(unix)]
#[test]
fn commands_that_run_long_motions_end_within_a_second() {
    let folder = WorkFolder::with(&[
        ("machine.toml", MACHINE),
        ("fit.toml", include_str!("../../../../host-sim/motions/demo_circle.toml")),
        ("circles.toml", circles(1).as_str()),
        ("hour.toml", circles(25).as_str()),
    ]);
    folder.succeeds("simulate --machine machine.toml --motion circles.toml --out before.csv");
    folder.succeeds("simulate --machine machine.toml --motion circles.toml --out after.csv --seed 2");
    for arguments in [
        "simulate --machine machine.toml --motion hour.toml --out out.csv",
        "simulate --machine machine.toml --motion hour.toml --out out.csv.gz",
        "compensate --model machine.toml --motion hour.toml --out c.toml --json out.json",
        "verify --machine machine.toml --before before.csv --after after.csv --json out.json --report report",
        "improve --machine machine.toml --plant machine.toml --fit fit.toml --motion hour.toml --out out",
    ] {
        assert_ends_within_a_second(&folder, arguments);
    }
}
