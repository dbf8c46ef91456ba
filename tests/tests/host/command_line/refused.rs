//! Invalid input: exit code 2, one line with the location and the expected value, no output.

use super::work_folder::{MACHINE, MOTION, SIMULATE, TRACE, WorkFolder, log};

const RECORD: &str = "record --port emulated --machine machine.toml --motion motion.toml --out out.csv";

/// A command with an invalid file, and parts of its one-line message.
struct BadInput {
    command: String,
    file: &'static str,
    content: Vec<u8>,
    message: &'static [&'static str],
}

/// A command with one invalid file.
fn bad(
    command: &str,
    file: &'static str,
    content: impl Into<Vec<u8>>,
    message: &'static [&'static str],
) -> BadInput {
    BadInput { command: command.to_owned(), file, content: content.into(), message }
}

fn bad_log(content: impl Into<Vec<u8>>, message: &'static [&'static str]) -> BadInput {
    bad(TRACE, "fit.csv", content, message)
}

/// A text with its first occurrence of `old`, which must exist, replaced.
fn with(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

/// The log with its lines (from 1, as in messages) changed; `None` removes a line.
fn lines(change: impl Fn(usize, &str) -> Option<String>) -> String {
    let changed = log().lines().enumerate().filter_map(|(index, line)| change(index + 1, line));
    changed.map(|line| line + "\n").collect()
}

/// The log with one line changed.
fn line(number: usize, change: impl Fn(&str) -> String) -> String {
    lines(|at, line| Some(if at == number { change(line) } else { line.to_owned() }))
}

/// The log with other times from a line on.
fn times(from: usize, change: impl Fn(f64) -> f64) -> String {
    lines(|at, line| {
        let (time, values) = line.split_once(',').unwrap();
        let changed = || format!("{:.6},{values}", change(time.parse().unwrap()));
        Some(if at < from { line.to_owned() } else { changed() })
    })
}

/// The log without its first column, `time_s`.
fn without_time() -> String {
    lines(|_, line| Some(line.split_once(',').unwrap().1.to_owned()))
}

fn refuse(cases: impl IntoIterator<Item = BadInput>) {
    for BadInput { command, file, content, message } in cases {
        let mut files: Vec<(&str, &[u8])> =
            vec![("machine.toml", MACHINE.as_bytes()), ("motion.toml", MOTION.as_bytes())];
        files.push(("fit.csv", log().as_bytes()));
        files.retain(|(name, _)| *name != file);
        files.push((file, &content));
        let folder = WorkFolder::with(&files);
        let before = folder.contents();
        let output = folder.run(&command);
        let error = String::from_utf8(output.stderr).unwrap();
        let context = format!("{command}, {message:?}:\n{error}");
        assert_eq!(output.status.code(), Some(2), "{context}");
        assert!(error.lines().count() == 1 && error.ends_with('\n'), "{context}");
        assert!(message.iter().all(|part| error.contains(part)), "{context}");
        assert!(error.contains("expected"), "{context}");
        assert!(output.stdout.is_empty(), "{context}");
        assert!(folder.contents() == before, "outputs were written: {context}");
    }
}

#[test]
fn logs_without_a_table_of_the_known_columns() {
    refuse([
        bad_log(without_time(), &["fit.csv: line 1: time_s: expected this column"]),
        bad_log(
            with(log(), "x_motor_mm", "x_moter_mm"),
            &["fit.csv: line 1: x_moter_mm: expected a column time_s, or, of an axis x: x_command_mm"],
        ),
        bad_log(
            with(log(), "x_table_mm", "x_table_deg"),
            &["fit.csv: line 1: x_table_deg: expected unit mm as in x_command_mm"],
        ),
        bad_log("Dear all,\nthe log is attached.\n", &["fit.csv: line 1: Dear all: expected a column"]),
        bad_log((0..=255).collect::<Vec<u8>>(), &["fit.csv: line 1: expected a CSV text in UTF-8"]),
        bad_log(b"\x1f\x8b\x08\x00 no gzip", &["fit.csv: expected a complete gzip file"]),
        bad_log("", &["fit.csv: expected a header line, found an empty file"]),
        bad_log(log().lines().next().unwrap(), &["fit.csv: expected two samples or more, found none"]),
    ]);
}

#[test]
fn logs_with_a_bad_line() {
    let last_value = |line: &str| line.rsplit_once(',').unwrap().0.to_owned();
    refuse([
        bad_log(
            line(50, |line| last_value(line) + ",NaN"),
            &["fit.csv: line 50: y_force_n: expected a finite number, found \"NaN\""],
        ),
        bad_log(
            line(51, |line| last_value(line) + ","),
            &["fit.csv: line 51: y_force_n: expected a finite number, found nothing"],
        ),
        bad_log(line(52, last_value), &["fit.csv: line 52: expected 11 values as in the header, found 10"]),
        bad_log(
            times(300, |time_s| time_s - 0.1),
            &["fit.csv: line 300: time_s: expected a time after 0.297, found 0.198"],
        ),
    ]);
}

#[test]
fn logs_of_another_machine() {
    let renamed = |line: &str| line.replace("y_", "z_");
    let slower = lines(|at, line| (at == 1 || at % 2 == 0).then(|| line.to_owned()));
    let short: String = log().lines().take(100).map(|line| line.to_owned() + "\n").collect();
    refuse([
        bad_log(slower, &["fit.csv: expected samples at the machine's sample_rate_hz of 1000", "found 500"]),
        bad_log(line(1, renamed), &["fit.csv: expected axes of the machine file (x, y), found axis z"]),
        bad_log(short, &["fit.csv: expected at least 200 samples, found 99"]),
    ]);
}

#[test]
fn a_bad_log_for_validation() {
    let command = format!("{TRACE} --validate held_out.csv");
    refuse([bad(&command, "held_out.csv", without_time(), &["held_out.csv: line 1: time_s"])]);
}

/// A log cannot validate a fit to itself: not under another name, nor with fewer rows.
#[test]
fn a_copy_of_a_fitted_log() {
    let command = format!("{TRACE} --validate held_out.csv");
    let message: &[&str] = &["held_out.csv: expected a different recording, found", "shared with", "fit.csv"];
    let shorter = lines(|at, line| (at == 1 || at > 40).then(|| line.to_owned()));
    refuse([bad(&command, "held_out.csv", log(), message), bad(&command, "held_out.csv", shorter, message)]);
    let itself = format!("{TRACE} --validate fit.csv");
    refuse([bad(&itself, "other.csv", "", &["fit.csv: expected a different recording, found 100 %"])]);
}

#[test]
fn missing_files() {
    let missing =
        |command: &str, given: &str, message| bad(&with(command, given, "nowhere"), "other.txt", "", message);
    let file: &[&str] = &["nowhere: expected a readable file"];
    refuse([
        missing(TRACE, "machine.toml", file),
        missing(TRACE, "fit.csv", file),
        missing(SIMULATE, "machine.toml", file),
        missing(SIMULATE, "motion.toml", file),
        missing(RECORD, "motion.toml", file),
    ]);
}

#[test]
fn machine_files() {
    let effect = |text: &str| format!("{MACHINE}\n[[axis.y.effect]]\n{text}\n");
    let of_both = |content: String, message: &'static [&'static str]| {
        [SIMULATE, TRACE].map(|command| bad(command, "machine.toml", content.clone(), message))
    };
    let line_of = |key: &str| MACHINE.lines().position(|line| line.starts_with(key)).unwrap() + 1;
    assert_eq!(
        (line_of("lead_mm"), line_of("table_mass_kg")),
        (23, 14),
        "the line numbers in the messages below"
    );
    let cases = [
        of_both(
            with(MACHINE, "lead_mm", "leed_mm"),
            &["machine.toml: line 23: axis.x.leed_mm: unknown key, expected one of"],
        ),
        of_both(
            with(MACHINE, "table_mass_kg = 160.0", "table_mass_kg = -160.0"),
            &["machine.toml: line 14: axis.x.table_mass_kg: expected a number", "found -160.0"],
        ),
        of_both(
            with(MACHINE, "lead_mm = 10.0", "lead_mm = \"10 mm\""),
            &["machine.toml: line 23: axis.x.lead_mm: expected a number, found \"10 mm\""],
        ),
        of_both(
            with(MACHINE, "lead_mm = 10.0", "lead_mm = "),
            &["machine.toml: line 23: expected valid TOML"],
        ),
        of_both(
            effect("name = \"gremlin\""),
            &["machine.toml: line ", "axis.y.effect[0].name: expected one of backlash,", "found \"gremlin\""],
        ),
        of_both(
            effect("name = \"backlash\"\nwidth_mm = 0.01"),
            &["machine.toml: line ", "axis.y.effect[0].width_mm: unknown key, expected"],
        ),
    ];
    refuse(cases.into_iter().flatten());
}

#[test]
fn machines_that_cannot_be_controlled() {
    let without = |keys: &[&str]| -> String {
        let kept = MACHINE.lines().filter(|line| !keys.iter().any(|key| line.starts_with(key)));
        kept.map(|line| line.to_owned() + "\n").collect()
    };
    let no_controller =
        without(&["controller", "position_gain", "feedforward", "velocity_gain", "velocity_int", "force_"]);
    let no_mass = without(&["motor_mass", "table_mass", "stiffness", "damping"]);
    let huge = with(MACHINE, "position_gain_per_s = 50.0", "position_gain_per_s = 1e9");
    let axis = &MACHINE[MACHINE.find("[axis.y]").unwrap()..];
    let more = ["z", "u"].map(|name| with(axis, "axis.y", &format!("axis.{name}")));
    let four = [MACHINE, &more[0], &more[1]].join("\n");
    refuse([
        bad(RECORD, "machine.toml", no_controller, &["machine.toml: axis.x.controller: expected"]),
        bad(RECORD, "machine.toml", no_mass, &["machine.toml: axis.x.table_mass_kg: expected"]),
    ]);
    refuse([
        bad(SIMULATE, "machine.toml", four, &["machine.toml: axis: expected 1 to 3 axes, found 4"]),
        bad(
            SIMULATE,
            "machine.toml",
            huge,
            &["machine.toml: axis.x.position_gain_per_s: expected a number from 4.768e-5 to 2048"],
        ),
        bad(
            SIMULATE,
            "machine.toml",
            with(MACHINE, "lead_mm = 10.0", "lead_mm = 10.0\nfastest_mm_per_s = 1e12"),
            &["machine.toml: axis.x.fastest_mm_per_s: expected a number from 0 to 8305"],
        ),
    ]);
}

#[test]
fn motions() {
    let of = |old: &str, new: &str, message| bad(SIMULATE, "motion.toml", with(MOTION, old, new), message);
    let name = "name = \"short\"";
    refuse([
        of(
            "line_to_mm = { x = 20.0, y",
            "line_to_mm = { x = 20.0, w",
            &["motion.toml: line 7: block[0].line_to_mm.w: expected an axis of start_mm (x, y)"],
        ),
        of(
            "start_mm = { x = 10.0, y = 0.0 }",
            "start_mm = { x = 10.0, y = 0.0, w = 0.0 }",
            &["motion.toml: start_mm: expected axes of the machine (x, y), found axis w"],
        ),
        of(
            name,
            "name = \"short\"\nfeed_mm_per_s = 50.0",
            &["motion.toml: line 2: feed_mm_per_s: unknown key"],
        ),
        of(
            "centre_mm = { x = 0.0, y = 0.0 }",
            "centre_mm = { x = 10.0, y = 0.0 }",
            &[
                "motion.toml: line 13: block[2].arc.centre_mm: expected a centre other than the current position",
            ],
        ),
        // A radius that the file format allows and the controller rejects.
        of(
            "centre_mm = { x = 0.0, y = 0.0 }",
            "centre_mm = { x = 10.0001, y = 0.0 }",
            &["motion.toml: block[2]: expected a block that the controller can run: the arc's radius"],
        ),
        of(
            "turns = 0.25",
            "to_mm = { x = 10.0, y = 0.0 }, direction = \"positive\"",
            &["motion.toml: line 13: block[2].arc.to_mm: expected a point other than the current position"],
        ),
        of(
            "turns = 0.25",
            "to_mm = { x = 0.0, y = 10.1 }, direction = \"positive\"",
            &["motion.toml: line 13: block[2].arc.to_mm: expected a point within 0.002 mm of the circle"],
        ),
        of(
            name,
            "name = \"short\"\nramps = \"s-curve\"",
            &["motion.toml: jerk_m_per_s3: expected a value beside ramps = \"s-curve\", found none"],
        ),
        of(
            "turns = 0.25",
            "turns = 1e9",
            &["motion.toml: line 12: block[2]: expected a total duration of at most 3600 s"],
        ),
        // 10 mm from rest at 10⁻⁹ m/s² take √(2·0.01/10⁻⁹) s = 4472 s.
        of(
            "acceleration_m_per_s2 = 2.0",
            "acceleration_m_per_s2 = 1e-9",
            &["motion.toml: line 6: block[0]: expected a total duration of at most 3600 s"],
        ),
    ]);
}

/// Each is one line that names the argument, not the usage of the command.
#[test]
fn arguments() {
    let folder = WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION)]);
    let simulate = "simulate --machine machine.toml --motion motion.toml --out out.csv";
    for (command, message) in [
        (format!("{simulate} --seed -1"), "invalid value '-1' for '--seed <SEED>'"),
        (
            format!("{simulate} --sed 1"),
            "unexpected argument '--sed' found; tip: a similar argument exists: '--seed'",
        ),
        (
            "self-test --kind nonsense".to_owned(),
            "invalid value 'nonsense' for '--kind <KIND>': expected one of textbook,",
        ),
        ("improve --rounds 0".to_owned(), "invalid value '0' for '--rounds <N>': 0 is not in 1..=20"),
        (
            "trace".to_owned(),
            "the following required arguments were not provided: --machine <MACHINE> --fit <FIT>",
        ),
        ("board jogg".to_owned(), "unrecognized subcommand 'jogg'; tip: a similar subcommand exists: 'jog'"),
        ("margins --machine machine.toml --json -".to_owned(), "--json: expected a file; stdout is for"),
    ] {
        let output = folder.run(&command);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{command}: {error}");
        assert!(
            error.lines().count() == 1 && error.starts_with(&format!("lost-motion: {message}")),
            "{command}: {error}"
        );
        assert!(output.stdout.is_empty() && folder.contents().len() == 2, "{command}");
    }
}

#[test]
fn ports() {
    const SERIAL: &[&str] = &["--port: ", "expected emulated"];
    for (port, expected) in [
        ("/dev/no-such-port", SERIAL),
        ("emulator", SERIAL),
        ("emulated:", &["--port: expected emulated or emulated:PROGRAM"]),
    ] {
        refuse([bad(&with(RECORD, "emulated", port), "other.txt", "", expected)]);
    }
}

/// The whole message. Once: "a board on a serial port cannot be reached yet"; and `bench` twice among what is expected.
#[test]
fn the_message_of_a_missing_port_lists_every_port_of_this_computer_once() {
    let folder = WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION)]);
    let ports = folder.succeeds("board ports");
    // Names begin the lines; the emulated board is the first.
    let names: Vec<&str> = ports.lines().filter_map(|line| line.split_whitespace().next()).collect();
    let expected = match names.split_first() {
        Some((&"bench", [])) => "emulated or bench, as this computer has no serial port".to_owned(),
        Some((&"bench", others)) => format!("emulated, bench, or one of: {}", others.join(", ")),
        _ => panic!("{ports}"),
    };
    for port in ["/dev/no-such-port", "emulator"] {
        let message = folder.fails(&with(RECORD, "emulated", port), 2);
        let whole =
            format!("lost-motion: --port: \"{port}\": No such file or directory; expected {expected}\n");
        assert_eq!(message, whole);
    }
    let message = folder.fails(&with(RECORD, "emulated", "emulated:"), 2);
    assert_eq!(message, "lost-motion: --port: expected emulated or emulated:PROGRAM, found \"emulated:\"\n");
}

#[test]
fn outputs_that_would_replace_inputs() {
    let folder = WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION), ("fit.csv", log())]);
    let before = folder.contents();
    for (command, flag) in [
        (SIMULATE.replace("out.csv", "machine.toml"), "--out"),
        (SIMULATE.replace("out.csv", "./motion.toml"), "--out"),
        (TRACE.replace("out.json", "fit.csv"), "--json"),
        (TRACE.replace("out.toml", "machine.toml"), "--model"),
        (TRACE.replace("out.toml", "out.json"), "--model"),
    ] {
        let message = folder.fails(&command, 2);
        assert!(
            message.contains(&format!("{flag}: expected a file that is neither an input nor")),
            "{message}"
        );
        assert!(folder.contents() == before, "{command}");
    }
}
