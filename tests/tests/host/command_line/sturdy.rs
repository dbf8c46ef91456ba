//! What a run leaves and shows: no file named `-`, no temporary files of killed runs, no control characters on the terminal, and no
//! compiler that nobody asked for.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::work_folder::{MACHINE, MOTION, SIMULATE, TRACE, WorkFolder, log};

fn folder() -> WorkFolder {
    WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION), ("fit.csv", log())])
}

/// Every output of every command: refused in one line before anything is computed, and never a file or folder of that name.
#[test]
fn a_dash_is_no_output() {
    let folder = folder();
    let before = folder.contents();
    for (command, flag) in [
        ("simulate --machine machine.toml --motion motion.toml --out -", "--out"),
        ("record --port emulated --machine machine.toml --motion motion.toml --out -", "--out"),
        ("import fit.csv --out -", "--out"),
        ("trace --machine machine.toml --fit fit.csv --json -", "--json"),
        ("trace --machine machine.toml --fit fit.csv --model -", "--model"),
        ("trace --machine machine.toml --fit fit.csv --propose -", "--propose"),
        ("trace --machine machine.toml --fit fit.csv --report -", "--report"),
        ("trace --friction-map fit.csv --report -", "--report"),
        ("verify --machine machine.toml --before fit.csv --after fit.csv --json -", "--json"),
        ("verify --machine machine.toml --before fit.csv --after fit.csv --report -", "--report"),
        ("circle fit.csv --json -", "--json"),
        ("circle fit.csv --report -", "--report"),
        ("init --log fit.csv --out -", "--out"),
        ("gcode --motion motion.toml --format fanuc --out -", "--out"),
        ("positions --fit fit.csv --json -", "--json"),
        ("positions --fit fit.csv --report -", "--report"),
        ("budget --model machine.toml --json -", "--json"),
        ("budget --model machine.toml --report -", "--report"),
        ("app --out -", "--out"),
        ("compensate --model machine.toml --out -", "--out"),
        ("compensate --model machine.toml --out c.toml --json -", "--json"),
        ("margins --machine machine.toml --json -", "--json"),
        ("resonances raw.csv --json -", "--json"),
        ("tune --machine machine.toml --out -", "--out"),
        ("tune --machine machine.toml --json -", "--json"),
        (
            "improve --machine machine.toml --plant machine.toml --fit motion.toml --motion motion.toml --out -",
            "--out",
        ),
        ("compare --json -", "--json"),
        ("compare --report -", "--report"),
        ("reproduce --json -", "--json"),
        ("reproduce --report -", "--report"),
        ("sensors --json -", "--json"),
        ("sensors --report -", "--report"),
        ("demo --json -", "--json"),
        ("demo --report -", "--report"),
        ("self-test --cases 1 --json -", "--json"),
        ("self-test --cases 1 --report -", "--report"),
        ("self-test --cases 1 --keep -", "--keep"),
        ("board capture --port nowhere --out -", "--out"),
    ] {
        let message = folder.fails(command, 2);
        let noun = if ["--report", "--keep"].contains(&flag) || command.starts_with("improve") {
            "folder"
        } else {
            "file"
        };
        let expected = format!(
            "lost-motion: {flag}: expected a {noun}; stdout is for the sentences and tables, found \"-\"\n"
        );
        assert_eq!(message, expected, "{command}");
        assert!(folder.contents() == before, "{command}");
    }
}

fn temporary_files(folder: &WorkFolder) -> Vec<String> {
    let names = folder.contents().into_iter().map(|(name, _)| name);
    names.filter(|name| name.starts_with(".lost-motion-")).collect()
}

/// A run that is killed leaves its temporary file, which the next run that writes there removes; one that is being written stays.
#[cfg(target_os = "linux")]
#[test]
fn the_next_run_removes_what_a_killed_one_left() {
    let long = MOTION.replace("turns = 0.25", "turns = 50.0");
    let folder =
        WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION), ("long.toml", &long)]);
    let start = || {
        let known = temporary_files(&folder);
        let mut child = Command::new(tests::program::lost_motion())
            .args(
                SIMULATE
                    .replace("motion.toml", "long.toml")
                    .replace("out.csv", "long.csv")
                    .split_whitespace(),
            )
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let started = Instant::now();
        let is_new = |name: &String| !known.contains(name);
        while !temporary_files(&folder).iter().any(is_new) && started.elapsed() < Duration::from_secs(30) {
            assert!(child.try_wait().unwrap().is_none(), "the run has ended");
            std::thread::sleep(Duration::from_millis(20));
        }
        child
    };
    let mut killed = start();
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert_eq!(temporary_files(&folder).len(), 1);
    let mut running = start();
    // The start of the second run has removed the file of the first.
    let of_running = temporary_files(&folder);
    assert!(
        of_running.len() == 1 && of_running[0].contains(&format!("-{}-", running.id())),
        "{of_running:?}"
    );
    folder.succeeds(SIMULATE);
    assert_eq!(temporary_files(&folder), of_running);
    running.kill().unwrap();
    running.wait().unwrap();
    folder.succeeds(SIMULATE);
    assert!(temporary_files(&folder).is_empty());
}

/// Names of machine, motion and files, a column and a cell with an escape sequence that clears the screen, and a character that turns the
/// direction of the text.
#[test]
fn no_control_character_reaches_the_terminal() {
    let bad = "\u{1b}[2J\u{9b}2J\u{202e}";
    let in_toml = "\\u001b[2J\\u009b2J\\u202e";
    let machine = MACHINE.replace("name = \"demo\"", &format!("name = \"demo{in_toml}\""));
    let motion = MOTION.replace("name = \"short\"", &format!("name = \"short{in_toml}\""));
    let header = log().replace("x_motor_mm", &format!("x_motor{bad}_mm"));
    let cell = log().replace("0.001,", &format!("0.00{bad},"));
    let foreign = format!("t;a{bad}b\n0;1\n1;2\n");
    let out = format!("out{bad}.csv");
    let effect = format!("{machine}\n[[axis.y.effect]]\nname = \"{in_toml}\"\n");
    let key = format!("{machine}\n\"{in_toml}\" = 1\n");
    let folder = WorkFolder::with(&[
        ("machine.toml", machine.as_str()),
        ("effect.toml", &effect),
        ("key.toml", &key),
        ("motion.toml", &motion),
        ("header.csv", &header),
        ("cell.csv", &cell),
        ("foreign.txt", &foreign),
        ("fit.csv", log()),
        (&format!("fit{bad}.txt"), &log().replace(',', ";")),
    ]);
    let trace = "trace --evaluate --machine machine.toml --fit";
    for (command, code) in [
        (format!("{} --seed 2", SIMULATE.replace("out.csv", &out)), 0),
        (format!("{trace} fit.csv"), 0),
        (format!("{trace} fit{bad}.txt"), 0),
        (format!("{trace} header.csv"), 2),
        (format!("{trace} cell.csv"), 2),
        (format!("{trace} foreign.txt --rate 1000"), 2),
        (format!("{trace} no{bad}where.csv"), 2),
        (format!("{trace} fit.csv --json no{bad}where/out.json"), 1),
        (SIMULATE.replace("machine.toml", "effect.toml"), 2),
        (SIMULATE.replace("machine.toml", "key.toml"), 2),
        (format!("{trace} fit.csv --seed{bad}"), 2),
        (format!("import fit{bad}.txt --out log.csv"), 0),
        (format!("verify --machine machine.toml --before fit.csv --after {out}"), 0),
        (TRACE.replace("machine.toml", "effect.toml"), 2),
    ] {
        let output = folder.run(&command);
        let shown = [output.stdout, output.stderr].concat();
        let shown = String::from_utf8(shown).unwrap();
        assert_eq!(output.status.code(), Some(code), "{command:?}: {shown:?}");
        let is_bad = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
        assert!(!shown.is_empty() && !shown.contains(is_bad), "{command:?}: {shown:?}");
    }
}

/// A query of an emulated board whose program is not built says what builds it, and calls no compiler. The program is asked for beside this one
/// and in the target folder: neither has it.
#[cfg(unix)]
#[test]
fn a_query_of_a_board_that_is_not_built_compiles_nothing() {
    use std::os::unix::fs::PermissionsExt;

    let folder = WorkFolder::with(&[
        ("cargo", "#!/bin/sh\ntouch compiled\n"),
        ("machine.toml", MACHINE),
        ("motion.toml", MOTION),
    ]);
    let path = |name: &str| folder.path().join(name);
    std::fs::set_permissions(path("cargo"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let program = tests::program::lost_motion();
    // A link where both are on one file system, which is sooner done.
    std::fs::hard_link(program, path("lost-motion"))
        .or_else(|_| std::fs::copy(program, path("lost-motion")).map(drop))
        .unwrap();
    for command in [
        "board status --port bench",
        "board status --port emulated",
        "board monitor --port bench --lines 1",
        "board jog --port bench --axis x --by-mm 1",
        "board bench close-switch",
        "record --port bench --motion motion.toml --out out.csv --yes",
        "record --port emulated --machine machine.toml --motion motion.toml --out out.csv",
    ] {
        let output = Command::new(path("lost-motion"))
            .args(command.split_whitespace())
            .current_dir(folder.path())
            .env("PATH", folder.path())
            .env("CARGO_TARGET_DIR", path("target"))
            .env("LOST_MOTION_BENCH", path("bench"))
            .output()
            .unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(matches!(output.status.code(), Some(1 | 2)), "{command}: {error}");
        let builds = ["build it with `cargo servo`", "build it with `cargo emulated`"];
        assert!(
            error.lines().count() == 1 && builds.iter().any(|what| error.contains(what)),
            "{command}: {error}"
        );
        assert!(!path("compiled").exists() && !path("out.csv").exists(), "{command}");
    }
}
