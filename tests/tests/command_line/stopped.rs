//! Machines and motions that cannot be run to the end: refused, or stopped with the reason and the time, and no log.

use super::desk::{Desk, MACHINE, MOTION, SIMULATE};

/// The machine with other values of some keys, on all axes; with new keys on the first.
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

fn says(machine: &str, motion: &str, code: i32, expected: &[&str]) {
    for out in ["out.csv", "out.csv.gz"] {
        let desk = Desk::with(&[("machine.toml", machine), ("motion.toml", motion)]);
        let before = desk.content();
        let said = desk.fails(&SIMULATE.replace("out.csv", out), code);
        for part in expected {
            assert!(said.contains(part), "{part} in {said}");
        }
        assert!(desk.content() == before, "{said}");
    }
}

/// A minute of circles, which a loop that cannot hold does not outlive.
fn long() -> String {
    MOTION.replace("turns = 0.25", "turns = 50.0")
}

#[test]
fn unstable_gains_are_stopped_with_the_time() {
    // A velocity loop at its rate has the motor's mass alone above the screw's resonance: beyond Kv·Δt/m = 2 a
    // difference of positions turns over and grows. 1e6 · 0.25 ms / 90 kg is 2.8.
    let stands = [
        "axis.x: the force stands at its limit of 20000 N, for 1 s in all: stopped after ",
        " s: is the loop unstable",
    ];
    says(&machine(&[("velocity_gain_n_s_per_m", "1e6")]), &long(), 1, &stands);
    // With patience for its force it still may not leave its path.
    let strong = [
        ("velocity_gain_n_s_per_m", "1e6"),
        ("saturation_time_s", "1e4"),
        ("following_error_limit_mm", "0.5"),
    ];
    let leaves = ["following error beyond its limit of 0.5 mm: stopped after ", " s: is the loop unstable"];
    says(&machine(&strong), &long(), 1, &leaves);
}

#[test]
fn what_no_step_can_follow_is_refused_by_its_key() {
    let stiff =
        ["machine.toml: axis.x.presliding_stiffness_n_per_um: expected an axis that steps of a millionth"];
    says(&machine(&[("presliding_stiffness_n_per_um", "1e12")]), MOTION, 2, &stiff);
    let light = ["machine.toml: axis.x.motor_coulomb_n: expected an axis that steps of a millionth"];
    says(&machine(&[("motor_mass_kg", "1e-9")]), MOTION, 2, &light);
    for key in ["motor_mass_kg", "table_mass_kg"] {
        let none = ["machine.toml: line ", key, "expected a mass above 0"];
        says(&machine(&[(key, "0.0")]), MOTION, 2, &none);
        let negative = ["machine.toml: line ", key];
        says(&machine(&[(key, "-1.0")]), MOTION, 2, &negative);
        says(&machine(&[(key, "nan")]), MOTION, 2, &negative);
        says(&machine(&[(key, "inf")]), MOTION, 2, &negative);
    }
}

#[test]
fn numbers_that_no_machine_has_are_refused() {
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
            "axis.x.following_error_limit_mm: expected a number from 0 to 134",
        ),
    ] {
        says(&machine(&[(key, value)]), MOTION, 2, &["machine.toml: ", expected]);
    }
    let effect = |text: &str| format!("{MACHINE}\n[[axis.x.effect]]\nname = {text}\n");
    for (text, expected) in [
        (
            "\"windup\"\nstiffness_n_per_um = 1e300",
            "effect[0].stiffness_n_per_um: expected a number above 0, at most 1e12",
        ),
        ("\"latency\"\nchannel = \"tool\"\nms = 1e5", "effect[0].ms: expected a number within ±1000"),
        ("\"velocity_lag\"\nms = 50.0", "effect[0].ms: expected a number from 0 to 0.25, found 50"),
        (
            "\"resonance\"\nchannel = \"table\"\nfrequency_hz = 40.0\ndamping_ratio = 0.1",
            "effect[0].channel: expected \"tool\"",
        ),
        (
            "\"thermal_drift\"\namplitude_um = 1.0\ntime_constant_s = 5.0\n[[axis.x.effect]]\nname = \"thermal_drift\"\n\
             amplitude_um = 1.0\ntime_constant_s = 9.0",
            "effect[1]: expected this effect once",
        ),
    ] {
        says(&effect(text), MOTION, 2, &["machine.toml: ", expected]);
    }
}

/// A swing far above the rate of the log is as stable as a slow one.
#[test]
fn a_fast_resonance_stays_in_bounds() {
    for (frequency_hz, damping_ratio) in [(1250.0, 0.02), (400.0, 0.001), (60.0, 30.0)] {
        let effect = format!(
            "[[axis.x.effect]]\nname = \"resonance\"\nfrequency_hz = {frequency_hz:?}\ndamping_ratio = {damping_ratio:?}\n"
        );
        let desk =
            Desk::with(&[("machine.toml", format!("{MACHINE}\n{effect}").as_str()), ("motion.toml", MOTION)]);
        desk.done(SIMULATE);
        let log = desk.read("out.csv");
        let column = log.lines().next().unwrap().split(',').position(|name| name == "x_tool_mm").unwrap();
        let tool =
            log.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse::<f64>().unwrap());
        // From −10 to 20 mm, and what 2ζ/ω = 0.16 s at 50 mm/s leaves it behind.
        assert!(tool.map(f64::abs).fold(0.0, f64::max) < 21.0, "{frequency_hz} Hz, {damping_ratio}");
    }
}

#[test]
fn motions_outside_the_stroke_are_refused() {
    // The motion goes out to x = 20 mm.
    let leaves = ["motion.toml: ", "block[", "axis.x.travel_mm, -5 to 15 mm, of ", "machine.toml"];
    says(&machine(&[("travel_mm", "[-5.0, 15.0]")]), MOTION, 2, &leaves);
    let beyond = ["motion.toml: ", "block[0]"];
    says(MACHINE, &MOTION.replace("x = 20.0", "x = 200e3"), 2, &beyond);
}

#[test]
fn bodies_that_cannot_stand_are_refused() {
    let bodies = include_str!("../../../host-sim/machines/bodies.toml");
    let with = |old: &str, new: &str| {
        assert!(bodies.contains(old), "{old}");
        bodies.replacen(old, new, 1)
    };
    for (text, expected) in [
        (with("mass_kg = 5000.0", "mass_kg = 0.0"), "body.bed.mass_kg"),
        (with("kind = \"foot\"", "kind = \"balloon\""), "balloon"),
        (with("[structure.axis.z]", "[structure.axis.w]"), "the axes of the machine: x, y, z"),
        (with("to = \"table\"\ndirection", "to = \"desk\"\ndirection"), "desk"),
        (with("stiffness_n_per_um = [100.0, 300.0, 100.0]", "stiffness_n_per_um = [0.0, 0.0, 0.0]"), "loose"),
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
        says(&text, MOTION, 2, &["machine.toml: ", expected]);
    }
}

/// Broken off while it writes: nothing half-written stays, and the exit code is a shell's for that.
#[cfg(unix)]
#[test]
fn a_run_that_is_broken_off_leaves_nothing() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let dwell = "name = \"long\"\nfeed_mm_per_min = 1.0\nacceleration_m_per_s2 = 1.0\nstart_mm = { x = 0.0, y = 0.0 }\n\
                 [[block]]\ndwell_s = 3500.0\n";
    for signal in ["INT", "TERM"] {
        let desk = Desk::with(&[("machine.toml", MACHINE), ("motion.toml", dwell)]);
        let before = desk.content();
        let mut child = Command::new(tests::program::lost_motion())
            .args(SIMULATE.split_whitespace())
            .current_dir(desk.path())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let began = Instant::now();
        while desk.content().len() == before.len() && began.elapsed() < Duration::from_secs(30) {
            std::thread::sleep(Duration::from_millis(20));
        }
        assert!(desk.content().len() > before.len(), "it has begun to write");
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &id]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert!(desk.content() == before, "{signal}");
    }
}

/// Broken off between two cases: what is done is written, and the exit code still says that it was broken off.
#[cfg(unix)]
#[test]
fn a_self_test_that_is_broken_off_keeps_what_is_done() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let desk = Desk::with(&[("machine.toml", MACHINE)]);
    let child = Command::new(tests::program::lost_motion())
        .args("self-test --cases 1000 --seed 3 --keep . --no-trace".split_whitespace())
        .current_dir(desk.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let began = Instant::now();
    // The second case is begun when the first is done.
    while !desk.path().join("case-2").exists() && began.elapsed() < Duration::from_mins(1) {
        std::thread::sleep(Duration::from_millis(20));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", "INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("cases drawn."), "{said}");
    let problem = String::from_utf8(output.stderr).unwrap();
    assert!(problem.contains("broken off after") && problem.contains("of 1000 cases"), "{problem}");
    let truth = std::fs::read_to_string(desk.path().join("case-1/truth.json")).unwrap();
    assert!(truth.contains("\"effects\""), "{truth}");
}
