//! Drives: who may switch them on, what switches them off, and what a host that goes away leaves behind.

use std::io::{BufRead, BufReader};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::emulated_board::EmulatedBoard;

#[test]
fn a_host_cannot_enable_without_the_switch() {
    let Some(board) = EmulatedBoard::new() else { return };
    let refused = board.fails(1, "board enable --port bench");
    assert!(refused.contains("the enable switch is open"), "{refused}");
    board.succeeds("board bench close-switch");
    assert!(board.succeeds("board status --port bench").contains("the enable switch permits an enable"));
    board.succeeds("board enable --port bench");
    board.succeeds("board bench open-switch");
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("drives: off; the enable switch has to be closed"), "{status}");
}

/// With the drives off a pressed emergency stop is no fault, but neither status nor a refusal asks for the switch alone. The end of a bench
/// that does not run is told.
#[test]
fn a_pressed_emergency_stop_is_named_with_the_drives_off() {
    let Some(board) = EmulatedBoard::armed() else { return };
    board.succeeds("board bench press-stop");
    board.status_with(&["drives: off; the emergency stop is pressed: release it, then open and close"]);
    let refused = board.fails(1, "board enable --port bench");
    assert!(refused.ends_with("the board refuses it: the emergency stop is pressed"), "{refused}");
    board.succeeds("board bench release-stop");
    board.status_with(&["drives: off; the enable switch has to be closed"]);
    assert_eq!(board.succeeds("board bench end"), "The emulator has ended.\n");
    assert_eq!(board.succeeds("board bench end"), "No emulator was running.\n");
}

/// With a frozen encoder the motor runs away from its reading, and the scale shows it; the fault is named, has to be acknowledged, and is in the history.
#[test]
fn a_fault_is_named_and_has_to_be_acknowledged() {
    let Some(board) = EmulatedBoard::armed() else { return };
    board.succeeds("board enable --port bench");
    board.succeeds("board bench freeze-encoder");
    let failed = board.fails(1, "board jog --port bench --axis x --by-mm 5");
    let fault = "x: motor and scale disagree";
    assert!(failed.contains(fault), "{failed}");
    board.succeeds("board bench thaw-encoder");
    let refused = board.fails(1, "board jog --port bench --axis y --by-mm 5");
    assert!(refused.contains("`board clear` acknowledges it"), "{refused}");
    let status = board.succeeds("board status --port bench");
    assert!(status.contains(&format!("off by a fault: {fault}")), "{status}");
    assert!(status.contains(&format!("s ago: fault: {fault}")), "{status}");
    board.succeeds("board clear --port bench");
    board.succeeds("board jog --port bench --axis y --by-mm 1");
}

/// The program that jogs is killed: the board holds the path by itself, and another program resumes it to its end.
#[test]
fn a_killed_host_leaves_a_held_path_that_can_be_resumed() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let mut jog = board.start("board jog --port bench --axis x --by-mm 60 --speed-mm-per-min 600");
    // Of 6 s of motion.
    sleep(Duration::from_secs(2));
    jog.kill().unwrap();
    jog.wait().unwrap();
    // Silence of 0.5 s of a board that may be slower than real time.
    sleep(Duration::from_secs(3));
    board.status_with(&["path: jog, held", "drives: on", "the host was silent: path held"]);
    board.succeeds("board resume --port bench");
    let status = board.succeeds("board status --port bench");
    let x: Vec<&str> =
        status.lines().find(|line| line.starts_with("x ")).unwrap().split_whitespace().collect();
    assert_eq!(x[1], "60.0000", "{status}");
}

/// Settings that the controller refuses: by file, axis and name, with exit code 2, and the board keeps its own.
#[test]
fn a_wrong_setting_is_refused_by_name() {
    let Some(board) = EmulatedBoard::new() else { return };
    let machine = std::fs::read_to_string(EmulatedBoard::file("host-sim/machines/bench.toml")).unwrap();
    let wrong = machine.replacen("velocity_loop_rate_hz = 20000.0", "velocity_loop_rate_hz = 16000.0", 1);
    std::fs::write(board.path().join("wrong.toml"), wrong).unwrap();
    let refused = board.fails(2, "board upload --port bench --machine wrong.toml");
    assert!(refused.contains("wrong.toml") && refused.contains("expected 20000"), "{refused}");
    let motion = EmulatedBoard::file("host-sim/motions/bench_travel.toml").display().to_string();
    let record = format!("record --port bench --machine wrong.toml --motion {motion} --out out.csv --yes");
    let refused = board.fails(2, &record);
    assert!(refused.contains("wrong.toml: velocity_loop_rate_hz: expected 20000, the tick"), "{refused}");
    std::fs::write(board.path().join("machine.toml"), machine).unwrap();
    board.succeeds("board upload --port bench --machine machine.toml");
}

/// The board checks a gain schedule; one that it refuses leaves the settings as they are.
#[test]
fn a_gain_schedule_is_uploaded_and_one_beyond_its_ratios_is_refused() {
    let Some(board) = EmulatedBoard::new() else { return };
    let machine = std::fs::read_to_string(EmulatedBoard::file("host-sim/machines/bench.toml")).unwrap();
    let gain = "velocity_gain_n_s_per_m = 3000.0\n";
    let upload = |ratios: &str| {
        let keys =
            format!("{gain}gain_schedule_position_mm = [-50, 0, 50]\ngain_schedule_ratio = {ratios}\n");
        std::fs::write(board.path().join("machine.toml"), machine.replacen(gain, &keys, 1)).unwrap();
        "board upload --port bench --machine machine.toml"
    };
    let settings = || {
        let status = board.succeeds("board status --port bench");
        status.lines().find(|line| line.starts_with("settings:")).unwrap().to_owned()
    };
    for beyond in ["[1, 0.24, 1]", "[1, 4.1, 1]"] {
        let refused = board.fails(2, upload(beyond));
        assert!(refused.contains("gain_schedule_ratio") && refused.contains("0.25"), "{refused}");
        assert!(settings().starts_with("settings: of its program"), "{refused}");
    }
    board.succeeds(upload("[1, 0.25, 4]"));
    assert!(settings().starts_with("settings: uploaded"), "{}", settings());
}

/// With an observer of the velocity, the axes move as far as without; one that the loop rate does not allow is refused with its range.
#[test]
fn an_observer_of_the_velocity_is_uploaded_and_one_beyond_its_range_is_refused() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let machine = std::fs::read_to_string(EmulatedBoard::file("host-sim/machines/bench.toml")).unwrap();
    let gain = "velocity_gain_n_s_per_m = 3000.0\n";
    let upload = |hz: &str| {
        let keys = format!("{gain}velocity_observer_hz = {hz}\n");
        std::fs::write(board.path().join("machine.toml"), machine.replace(gain, &keys)).unwrap();
        "board upload --port bench --machine machine.toml"
    };
    for beyond in ["19", "5001"] {
        let refused = board.fails(2, upload(beyond));
        let range = "velocity_observer_hz: expected a number from 20 to 5000";
        assert!(refused.contains(range), "{refused}");
    }
    board.succeeds(upload("300"));
    board.succeeds("board enable --port bench");
    board.succeeds("board jog --port bench --axis x --by-mm 2");
}

/// Nothing moves, and there is no fault: the commands say so.
#[test]
fn commands_without_an_effect_say_so() {
    let Some(board) = EmulatedBoard::new() else { return };
    assert_eq!(board.succeeds("board hold --port bench"), "No path runs: nothing is held.\n");
    assert_eq!(board.succeeds("board clear --port bench"), "There is no fault to acknowledge.\n");
    let nothing = board.fails(1, "board capture --port bench --only read --out out.csv");
    assert!(nothing.contains("nothing was recorded"), "{nothing}");
    board.succeeds("board capture --port bench --only arm");
    let nothing = board.fails(1, "board capture --port bench --only read --out out.csv");
    assert!(nothing.contains("nothing was recorded: the recording is armed"), "{nothing}");
    assert!(!board.path().join("out.csv").exists());
    // Only the board knows the force limit.
    let refused = board.fails(2, "board check-direction --port bench --axis x --force-n 201");
    assert!(refused.contains("--force-n: expected newtons above 0 and up to the force limit"), "{refused}");
}

/// A program that prints for nobody must not keep the drives on.
#[test]
fn a_monitor_ends_with_its_reader() {
    let Some(board) = EmulatedBoard::new() else { return };
    let mut monitor = board.start_with_output("board monitor --port bench --interval-s 0.1");
    let mut output = BufReader::new(monitor.stdout.take().unwrap());
    let mut line = String::new();
    output.read_line(&mut line).unwrap();
    assert!(line.contains("drives off"), "{line}");
    drop(output);
    let started = Instant::now();
    let ended = loop {
        if let Some(status) = monitor.try_wait().unwrap() {
            break Some(status);
        }
        if started.elapsed() > Duration::from_secs(30) {
            monitor.kill().unwrap();
            break None;
        }
        sleep(Duration::from_millis(50));
    };
    assert_eq!(ended.and_then(|status| status.code()), Some(0));
}

#[test]
fn a_port_that_does_not_exist_is_an_input_error() {
    let Some(board) = EmulatedBoard::new() else { return };
    let refused = board.fails(2, "board status --port /dev/there-is-no-such-port");
    assert!(refused.contains("expected emulated, bench, or one of"), "{refused}");
    let refused = board.fails(2, "board jog --port bench --axis z --by-mm 1");
    assert!(refused.contains("expected x or y"), "{refused}");
}
