//! Commands that take a log take it in the form of another program, with the same result.

use serde_json::Value;

use super::work_folder::{MACHINE, MOTION, WorkFolder, log};

/// The log in another form, and the arguments with which it is read.
struct Form {
    file: &'static str,
    text: String,
    arguments: String,
}

/// Cells of a log, line by line, the header first.
fn cells(log: &str) -> Vec<Vec<&str>> {
    log.lines().map(|line| line.split(',').collect()).collect()
}

/// As `halsampler -t` writes it: the number of the sample, then the channels; the columns have no names.
fn halsampler(log: &str, rate_hz: f64) -> Form {
    let cells = cells(log);
    let text = cells[1..].iter().enumerate().map(|(i, row)| format!("{i} {} \n", row[1..].join(" ")));
    let map = |(name, column): (&&str, usize)| format!(" --map {name}={column}");
    let maps: String = cells[0][1..].iter().zip(2..).map(map).collect();
    Form { file: "sampler.txt", text: text.collect(), arguments: format!("--rate {rate_hz}{maps}") }
}

/// As TwinCAT Scope exports it on a German computer: times in ms, a group of channels, decimal commas.
fn twincat(log: &str) -> Form {
    let cells = cells(log);
    let names: String = (1..cells[0].len()).map(|column| format!("\tPin {column}")).collect();
    let mut text =
        format!("Name\tScope\r\nFile\tC:\\a.svdx\r\n\r\nName{}\r\n\r\n", names.replace("Pin ", "Pin"));
    for row in &cells[1..] {
        let time_ms = 1e3 * row[0].parse::<f64>().unwrap();
        text.push_str(&format!("{time_ms:.4}\t{}\r\n", row[1..].join("\t")).replace('.', ","));
    }
    let map = |(name, column): (&&str, usize)| format!(" --map {name}=Pin{column}");
    let maps = cells[0][1..].iter().zip(1..).map(map).collect();
    Form { file: "scope.csv", text, arguments: maps }
}

/// Our own names, between semicolons.
fn semicolons(log: &str) -> Form {
    Form { file: "semicolons.csv", text: log.replace(',', ";"), arguments: String::new() }
}

fn forms(log: &str, rate_hz: f64) -> [Form; 3] {
    [halsampler(log, rate_hz), twincat(log), semicolons(log)]
}

/// Runs a command that writes `out.json`, and gives the JSON and stderr.
fn json(folder: &WorkFolder, arguments: &str) -> (Value, String) {
    let output = folder.run(&format!("{arguments} --json out.json"));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments}: {stderr}");
    (serde_json::from_str(&folder.read("out.json")).unwrap(), stderr)
}

/// Two results are the same but for names of files, and rounding of the last bits of the sampling time: to 1e-6 of each number.
fn assert_same(found: &Value, expected: &Value, place: &str) {
    match (found, expected) {
        (Value::Object(one), Value::Object(other)) => {
            assert!(one.keys().eq(other.keys()), "{place}: {found} {expected}");
            for (key, value) in
                one.iter().filter(|(key, _)| !["log", "files", "name"].contains(&key.as_str()))
            {
                assert_same(value, &other[key], &format!("{place}.{key}"));
            }
        }
        (Value::Array(one), Value::Array(other)) => {
            assert_eq!(one.len(), other.len(), "{place}");
            one.iter().zip(other).for_each(|(one, other)| assert_same(one, other, place));
        }
        (Value::Number(one), Value::Number(other)) => {
            let [one, other] = [one, other].map(|number| number.as_f64().unwrap());
            assert!((one - other).abs() <= 1e-9 + 1e-6 * other.abs(), "{place}: {one} {other}");
        }
        _ => assert_eq!(found, expected, "{place}"),
    }
}

/// The search for effects, on the log of a machine with a backlash that its file does not declare.
#[test]
fn a_trace_of_a_foreign_log_is_that_of_the_plain_one() {
    let worn = format!("{MACHINE}\n[[axis.y.effect]]\nname = \"backlash\"\nwidth_um = 9.0\n");
    let folder =
        WorkFolder::with(&[("worn.toml", worn.as_str()), ("machine.toml", MACHINE), ("motion.toml", MOTION)]);
    folder.succeeds("simulate --machine worn.toml --motion motion.toml --out plain.csv");
    let trace = "trace --machine machine.toml --fit";
    let (expected, stderr) = json(&folder, &format!("{trace} plain.csv"));
    assert!(stderr.is_empty() && !expected["effects"].as_array().unwrap().is_empty(), "{stderr}");
    for form in forms(&folder.read("plain.csv"), 1000.0) {
        std::fs::write(folder.path().join(form.file), form.text).unwrap();
        let (found, stderr) = json(&folder, &format!("{trace} {} {}", form.file, form.arguments));
        assert_same(&found, &expected, form.file);
        // What was assumed, each line with the name of the file.
        assert!(stderr.lines().count() >= 2, "{stderr}");
        assert!(stderr.lines().all(|line| line.starts_with(&format!("{}: ", form.file))), "{stderr}");
    }
}

/// A log of a case, judged without a search; from standard input as well.
#[test]
fn a_log_of_a_case_has_the_same_residuals_in_any_form() {
    let Some(cases) = tests::cases::folders() else { return };
    let machine = std::fs::read(cases[0].join("machine.toml")).unwrap();
    let folder = WorkFolder::with(&[("machine.toml", machine)]);
    let packed = tests::cases::logs(&cases[0], "fit_")[0].display().to_string();
    folder.succeeds(&format!("import {packed} --out plain.csv"));
    let plain = folder.read("plain.csv");
    let trace = "trace --evaluate --machine machine.toml --fit";
    let (expected, _) = json(&folder, &format!("{trace} plain.csv"));
    let second = |row: usize| cells(&plain)[row][0].parse::<f64>().unwrap();
    let rate_hz = (1.0 / (second(2) - second(1))).round();
    let text = &halsampler(&plain, rate_hz);
    for form in forms(&plain, rate_hz) {
        std::fs::write(folder.path().join(form.file), form.text).unwrap();
        let (found, _) = json(&folder, &format!("{trace} {} {}", form.file, form.arguments));
        assert_same(&found["residual"], &expected["residual"], form.file);
    }
    let command = format!("{trace} - {} --json out.json", text.arguments);
    assert!(folder.run_on(&command, text.text.as_bytes()).status.success());
    let found: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    assert_same(&found["residual"], &expected["residual"], "stdin");
}

/// The log before in our own form, the log after in a foreign one: the arguments are for the foreign one alone, which is told.
#[test]
fn a_verification_takes_our_own_and_a_foreign_log() {
    let folder =
        WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION), ("before.csv", log())]);
    folder.succeeds("simulate --machine machine.toml --motion motion.toml --out after.csv --seed 2");
    let verify = "verify --machine machine.toml --before before.csv --after";
    let (expected, stderr) = json(&folder, &format!("{verify} after.csv"));
    assert_eq!(stderr, "");
    let form = halsampler(&folder.read("after.csv"), 1000.0);
    std::fs::write(folder.path().join("after.txt"), form.text).unwrap();
    let (found, stderr) = json(&folder, &format!("{verify} after.txt {}", form.arguments));
    assert_same(&found, &expected, "verify");
    let told = "before.csv: its columns are those of a log of ours: --map, --unit, --rate and --preset are not applied to it\n";
    assert!(stderr.starts_with(told) && stderr.contains("after.txt: LinuxCNC halsampler"), "{stderr}");
}

/// A circle of which no column has our name, and a ballbar's table in degrees and micrometres between semicolons.
#[test]
fn a_circle_takes_foreign_logs_and_tables() {
    let circle = include_str!("../../../../host-sim/motions/circle.toml");
    let folder = WorkFolder::with(&[("machine.toml", MACHINE), ("circle.toml", circle)]);
    folder.succeeds("simulate --machine machine.toml --motion circle.toml --out plain.csv");
    let (expected, _) = json(&folder, "circle plain.csv");
    let form = twincat(&folder.read("plain.csv"));
    std::fs::write(folder.path().join("scope.csv"), form.text).unwrap();
    let (found, stderr) = json(&folder, &format!("circle scope.csv {}", form.arguments));
    assert_same(&found, &expected, "circle");
    assert!(stderr.starts_with("scope.csv: TwinCAT Scope"), "{stderr}");

    let table = |separator: char, header: &str| -> String {
        let rows = (0..7200_u32).map(|i| {
            let (degrees, direction) = (0.1 * f64::from(i), if i < 3600 { 1 } else { -1 });
            let degrees = if direction > 0 { degrees } else { 720.0 - degrees };
            let um = 3.0 * (2.0 * degrees.to_radians()).sin() + 0.02 * f64::from(i * 7919 % 101) / 101.0;
            format!("{degrees:.1}{separator}{um:.5}{separator}{direction}\n")
        });
        format!("{header}\n{}", rows.collect::<String>())
    };
    let own = table(',', "angle_deg,radius_um,direction");
    let german = table(';', "Winkel;Abweichung;Richtung").replace('.', ",");
    std::fs::write(folder.path().join("own.csv"), own).unwrap();
    std::fs::write(folder.path().join("german.csv"), german).unwrap();
    let maps = "--map angle_deg=Winkel --map radius_um=Abweichung --map direction=Richtung";
    let (expected, stderr) = json(&folder, "circle own.csv --radius 100");
    assert_eq!(stderr, "");
    let (found, stderr) = json(&folder, &format!("circle german.csv --radius 100 {maps}"));
    assert_same(&found, &expected, "ballbar");
    assert!(stderr.contains("german.csv: a ballbar's table of 7200 rows"), "{stderr}");
    // By way of a file.
    folder.succeeds(&format!("import german.csv --out ours.csv {maps}"));
    let (found, stderr) = json(&folder, "circle ours.csv --radius 100");
    assert_same(&found, &expected, "ballbar");
    assert_eq!(stderr, "");
    ballbar_refused(&folder, maps);
}

/// What `import` and `trace` say of a ballbar's table.
fn ballbar_refused(folder: &WorkFolder, maps: &str) {
    for (arguments, expected) in [
        (
            "import own.csv --out no.csv",
            "own.csv: this table of a ballbar needs no import: lost-motion circle reads it (with --radius MM",
        ),
        (
            "import german.csv --out no.csv",
            "or --map angle_deg=THEIRS and --map radius_mm=THEIRS (or radius_um) of a ballbar, found the columns",
        ),
        (&format!("import german.csv --out no.parquet {maps}"), "--out: expected a name that ends in .csv"),
        (
            &format!("trace --machine machine.toml --fit german.csv --json no.csv {maps}"),
            "german.csv: expected a log, found a ballbar's table, which lost-motion circle reads",
        ),
    ] {
        let error = folder.fails(arguments, 2);
        assert!(error.contains(expected), "{arguments}: {error}");
        assert!(!folder.path().join("no.csv").exists() && !folder.path().join("no.parquet").exists());
    }
}

/// A file that is neither is refused with what reads a foreign log; with arguments, the advice is not repeated.
#[test]
fn what_is_missing_is_told_in_one_line() {
    let folder = WorkFolder::with(&[("machine.toml", MACHINE), ("a.txt", "t;x\n0;1\n0,001;2\n0,002;3\n")]);
    let trace = "trace --machine machine.toml --json out.json --fit a.txt";
    let plain = folder.fails(trace, 2);
    let advice = "(a log of another program is read with --map OURS=THEIRS, --unit, --rate and --preset: lost-motion import --help)\n";
    assert!(plain.contains("a.txt: line 1: expected --map OURS=THEIRS for at least one channel"), "{plain}");
    assert!(plain.ends_with(advice), "{plain}");
    for (arguments, expected) in [
        ("--map x_motr_mm=x", "--map: expected time_s, or, of an axis x: x_command_mm"),
        ("--map x_motor_mm=y", "a.txt: line 1: expected a column of the file: \"t\", \"x\", found \"y\""),
        ("--rate 0", "--rate: expected a number of samples per second, found \"0\""),
        ("--preset parquet", "a.txt: expected a Parquet file"),
    ] {
        let message = folder.fails(&format!("{trace} {arguments}"), 2);
        assert!(message.contains(expected) && !message.ends_with(advice), "{arguments}: {message}");
    }
    assert!(!folder.path().join("out.json").exists());
}
