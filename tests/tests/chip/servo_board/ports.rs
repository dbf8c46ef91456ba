//! A second program at the port, an interrupt of a program that moves an axis, and a program of the board that is missing.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};

use super::emulated_board::EmulatedBoard;

/// Motions of 6 s and more, with what prepares them.
pub const MOTIONS: [(&[&str], &str); 4] = [
    (&[], "board jog --port bench --axis x --by-mm 60 --speed-mm-per-min 600"),
    (&[], "board jog --port bench --axis x --for-s 20 --speed-mm-per-min 300"),
    (&[], "board home --port bench --axis y"),
    (
        &[
            "board enable --port bench",
            "board jog --port bench --axis x --by-mm 60 --speed-mm-per-min 600 --no-wait",
            "board hold --port bench",
        ],
        "board resume --port bench",
    ),
];

pub fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// The command of an axis, mm, by the status.
pub fn at_mm(status: &str, axis: &str) -> f64 {
    let line = status.lines().find(|line| line.starts_with(axis)).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

/// The status of a board whose axes stand, with the drives on: they stay where they are.
fn standing(board: &EmulatedBoard) -> String {
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("path: at rest") && status.contains("drives: on"), "{status}");
    sleep(Duration::from_millis(500));
    let later = board.succeeds("board status --port bench");
    for axis in ["x ", "y "] {
        assert!((at_mm(&later, axis) - at_mm(&status, axis)).abs() < 1e-9, "{status} {later}");
    }
    status
}

/// Interrupts a command that moves axes after 2 s: it says that they stand and ends with 130.
fn interrupted(board: &EmulatedBoard, command: &str) {
    let moving = board.start(command);
    sleep(Duration::from_secs(2));
    interrupt(&moving);
    let output = moving.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{command}: {message}");
    let stands = "the axes stand, and the rest of the path is discarded";
    assert!(message.contains(stands), "{command}: {message}");
}

/// The command that records a motion.
fn record(motion: &str) -> String {
    format!("record --port bench --motion {motion} --out travel.csv --yes")
}

/// Ctrl-C stops each command that moves an axis, which says that the axes stand and ends with 130. Nothing moves afterwards, the drives
/// are on, and the path does not go on: the axis has not reached its target.
#[test]
fn an_interrupt_of_a_motion_leaves_standing_axes() {
    for (before, motion) in MOTIONS {
        let Some(board) = EmulatedBoard::armed() else { return };
        for command in before {
            board.succeeds(command);
        }
        interrupted(&board, motion);
        let status = standing(&board);
        let [x_mm, y_mm] = ["x ", "y "].map(|axis| at_mm(&status, axis));
        assert!(x_mm.abs() < 55.0 && y_mm.abs() < 105.0, "{motion}: {status}");
    }
}

/// Ctrl-C during a recording stops the motion, and no log is left: neither a whole one nor a part of it.
#[test]
fn an_interrupt_of_a_recording_leaves_standing_axes_and_no_log() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let motion = board.at_start_of_travel();
    // Of 7 s of motion.
    interrupted(&board, &record(&motion));
    let left: Vec<_> = fs::read_dir(board.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().contains("travel")), "{left:?}");
    standing(&board);
}

/// Ctrl-C on the way to the start of a recording: the axes stand before they have reached it.
#[test]
fn an_interrupt_on_the_way_to_the_start_of_a_recording_leaves_standing_axes() {
    let Some(board) = EmulatedBoard::armed() else { return };
    for axis in ["x", "y"] {
        board.succeeds(&format!("board home --port bench --axis {axis}"));
    }
    let motion = EmulatedBoard::file("host-sim/motions/bench_travel.toml").display().to_string();
    let before = board.succeeds("board status --port bench");
    // Some 130 mm at 20 mm/s.
    interrupted(&board, &record(&motion));
    let status = standing(&board);
    let way_mm = ["x ", "y "].map(|axis| (at_mm(&status, axis) - at_mm(&before, axis)).abs());
    assert!(way_mm.iter().any(|mm| *mm > 5.0) && way_mm.iter().all(|mm| *mm < 60.0), "{status}");
}

/// Ctrl-C ends a direction check that waits for the switch: closing the switch afterwards pushes nothing.
#[test]
fn an_interrupt_of_a_direction_check_ends_it() {
    let Some(board) = EmulatedBoard::new() else { return };
    board.succeeds("board status --port bench");
    let checking = board.start("board check-direction --port bench --axis x --force-n 40");
    sleep(Duration::from_secs(1));
    interrupt(&checking);
    let output = checking.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains("the force is off"), "{message}");
    board.succeeds("board bench close-switch");
    sleep(Duration::from_millis(500));
    let status = board.succeeds("board status --port bench");
    let line = status.lines().find(|line| line.starts_with("x ")).unwrap();
    // Motor and scale: the axis stands where it was.
    for mm in line.split_whitespace().skip(2).take(2) {
        assert!(mm.parse::<f64>().unwrap().abs() < 1e-3, "{status}");
    }
}

/// While one program moves an axis, what needs a session is refused to another one at once, with the command and the process of the
/// first, which goes on.
#[test]
fn a_second_program_is_told_who_holds_the_port() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let moving = board.start("board jog --port bench --axis x --by-mm 60 --speed-mm-per-min 600");
    sleep(Duration::from_secs(1));
    for command in ["enable", "clear", "resume", "home --axis y", "jog --axis y --by-mm 1"] {
        let started = Instant::now();
        let refused = board.fails(1, &format!("board {command} --port bench"));
        assert!(started.elapsed() < Duration::from_secs(2), "{command}: {:?}", started.elapsed());
        let holder = format!(
            "board jog --port bench --axis x --by-mm 60 --speed-mm-per-min 600 (process {})",
            moving.id()
        );
        assert!(refused.contains("in use by lost-motion") && refused.contains(&holder), "{refused}");
        assert!(
            refused.contains("`board stop`, `hold`, `disable`, `status` and `monitor` work"),
            "{refused}"
        );
    }
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("path: jog\n") && (5.0..55.0).contains(&at_mm(&status, "x ")), "{status}");
    interrupt(&moving);
    assert_eq!(moving.wait_with_output().unwrap().status.code(), Some(130));
    board.succeeds("board stop --port bench");
}

/// A serial port that another program has open, here a pseudo-terminal that this test holds: refused by its name. A process that another
/// test starts has it as well until it ends, and may be named before.
#[test]
fn a_serial_port_of_another_program_is_refused_by_its_name() {
    let Some(board) = EmulatedBoard::new() else { return };
    let (_master, slave) = TTYPort::pair().unwrap();
    let name = SerialPort::name(&slave).unwrap();
    let own = format!("(process {})", std::process::id());
    let mut refused = String::new();
    for _ in 0..100 {
        refused = board.fails(1, &format!("board stop --port {name}"));
        assert!(refused.contains("in use by") && refused.contains("(process "), "{refused}");
        if refused.contains(&own) {
            return;
        }
        sleep(Duration::from_millis(100));
    }
    panic!("{refused}");
}

/// Without the program of the board nothing is built: each command says at once how to build it.
#[test]
fn a_missing_program_of_the_board_is_not_built() {
    let Some(board) = EmulatedBoard::new() else { return };
    let alone = board.path().join("lost-motion");
    fs::copy(tests::program::lost_motion(), &alone).unwrap();
    for command in ["status", "stop", "enable", "monitor", "clear"] {
        let started = Instant::now();
        let output = Command::new(&alone)
            .args(["board", command, "--port", "bench"])
            .env("LOST_MOTION_BENCH", board.path().join("none"))
            .env("CARGO_TARGET_DIR", board.path().join("target"))
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{command}: {message}");
        assert!(message.contains("build it with `cargo servo`") && message.lines().count() == 1, "{message}");
        assert!(started.elapsed() < Duration::from_secs(5), "{command}: {:?}", started.elapsed());
    }
    assert!(!board.path().join("target").exists());
}
