//! Arguments of the commands for a servo board that are refused before the board is asked for anything: the port does not exist.

use super::work_folder::{MACHINE, MOTION, WorkFolder};

fn folder() -> WorkFolder {
    let renamed = MACHINE.replace("axis.y", "axis.z");
    let swapped = MACHINE.replace("axis.x", "axis.w").replace("axis.y", "axis.x").replace("axis.w", "axis.y");
    WorkFolder::with(&[("motion.toml", MOTION), ("renamed.toml", &renamed), ("swapped.toml", &swapped)])
}

/// Runs commands that are refused with exit code 2 and a message, and write nothing.
fn refuse(cases: &[(&str, &str)]) {
    let folder = folder();
    let before = folder.contents();
    for (command, message) in cases {
        let (verb, options) = command.split_once(" --").unwrap();
        let found = folder.fails(&format!("{verb} --port nowhere --{options}"), 2);
        assert_eq!(found.trim_end(), format!("lost-motion: {message}"), "{command}");
        assert!(folder.contents() == before, "{command}");
    }
}

#[test]
fn numbers_of_a_jog() {
    const DISTANCE: &str =
        "--by-mm: expected a distance from 0.000001 to 100000 mm, positive or negative, found";
    const ACCELERATION: &str = "--acceleration-m-per-s2: expected a number from 0.000001 to 1000, found";
    let distances = [("NaN", "NaN"), ("inf", "inf"), ("1e300", "1e300"), ("-1e300", "-1e300"), ("0", "0.0")];
    for (given, found) in distances {
        refuse(&[(&format!("board jog --axis x --by-mm {given}"), &format!("{DISTANCE} {found}"))]);
    }
    for (given, found) in [("NaN", "NaN"), ("0", "0.0"), ("-1", "-1.0"), ("1e300", "1e300")] {
        let command = format!("board jog --axis x --by-mm 1 --acceleration-m-per-s2 {given}");
        refuse(&[(&command, &format!("{ACCELERATION} {found}"))]);
    }
    let speed = "--speed-mm-per-min: expected a number from 0.001 to 1000000";
    for (given, found) in [("NaN", "NaN"), ("-5", "-5.0"), ("0", "0.0"), ("1e300", "1e300")] {
        let by = format!("board jog --axis x --by-mm 1 --speed-mm-per-min {given}");
        refuse(&[(&by, &format!("{speed} (the direction is the sign of --by-mm), found {found}"))]);
    }
    for (given, found) in [("NaN", "NaN"), ("-inf", "-inf"), ("0", "0.0"), ("-1e300", "-1e300")] {
        let at = format!("board jog --axis x --for-s 1 --speed-mm-per-min={given}");
        refuse(&[(&at, &format!("{speed}, positive or negative, found {found}"))]);
    }
    let extent =
        "the following required arguments were not provided: <--by-mm <MM>|--for-s <SECONDS>>; see --help";
    refuse(&[("board jog --axis x", extent)]);
    refuse(&[(
        "board jog --axis x --for-s -1",
        "--for-s: expected seconds above 0 and up to 3600, found -1.0",
    )]);
}

#[test]
fn numbers_of_a_direction_check() {
    const FORCE: &str = "--force-n: expected newtons above 0 and up to the force limit of the axis, found";
    const TIME: &str = "--time-s: expected seconds above 0 and up to 1, found";
    const DISTANCE: &str = "--distance-mm: expected a distance from 1e-12 to 5 mm, found";
    for (option, message) in [
        ("--force-n NaN", format!("{FORCE} NaN")),
        ("--force-n -5", format!("{FORCE} -5.0")),
        ("--force-n 0", format!("{FORCE} 0.0")),
        ("--force-n inf", format!("{FORCE} inf")),
        ("--force-n 5 --time-s NaN", format!("{TIME} NaN")),
        ("--force-n 5 --time-s -1", format!("{TIME} -1.0")),
        ("--force-n 5 --time-s 1.1", format!("{TIME} 1.1")),
        ("--force-n 5 --distance-mm NaN", format!("{DISTANCE} NaN")),
        ("--force-n 5 --distance-mm -0.1", format!("{DISTANCE} -0.1")),
        ("--force-n 5 --distance-mm 5.1", format!("{DISTANCE} 5.1")),
        ("--force-n NaN --time-s NaN", format!("{FORCE} NaN")),
    ] {
        refuse(&[(&format!("board check-direction --axis x {option}"), &message)]);
    }
}

#[test]
fn numbers_of_other_commands() {
    refuse(&[
        ("board monitor --interval-s -1", "--interval-s: expected seconds from 0 to 60, found -1"),
        ("board status --timeout-s -1", "--timeout-s: expected seconds above 0 and up to 3600, found -1"),
        (
            "board capture --seconds -1 --out out.csv",
            "--seconds: expected seconds above 0 and up to 3600, found -1.0",
        ),
    ]);
}

/// The board knows its axes by their numbers: settings of z, or of y in the first place, would go to another axis.
#[test]
fn machines_with_other_axes() {
    let renamed =
        "renamed.toml: axis.z: expected axis y here (a board has x, y, z, u, in this order), found \"z\"";
    let swapped =
        "swapped.toml: axis.y: expected axis x here (a board has x, y, z, u, in this order), found \"y\"";
    refuse(&[
        ("board upload --machine renamed.toml", renamed),
        ("board upload --machine swapped.toml", swapped),
        ("record --machine renamed.toml --motion motion.toml --out out.csv", renamed),
        ("record --machine swapped.toml --motion motion.toml --out out.csv", swapped),
    ]);
}

#[test]
fn logs_of_a_capture() {
    refuse(&[
        (
            "board capture --only arm --out out.csv",
            "--out: cannot be used with --only arm, which writes no log",
        ),
        ("board capture --only read", "--out: expected a log to write, found none"),
    ]);
}

/// A folder in the place of an output is told before a motion or a computation: the port and the model do not exist either.
#[test]
fn a_folder_in_the_place_of_an_output() {
    let folder = folder();
    for command in [
        "record --port nowhere --motion motion.toml --out .",
        "board capture --port nowhere --out .",
        "compensate --model nowhere --out .",
        "compensate --model nowhere --out c.toml --json .",
    ] {
        let message = folder.fails(command, 1);
        assert!(message.contains(".: not written: expected a file, found a folder"), "{message}");
    }
}

#[test]
fn commands_that_switch_the_drives_on_say_it() {
    for verb in ["board jog", "board home", "record"] {
        let help = folder().succeeds(&format!("{verb} --help"));
        let words: Vec<&str> = help.split_whitespace().collect();
        assert!(words.join(" ").contains("the drives on if they are off"), "{help}");
    }
}
