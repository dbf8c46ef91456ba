//! Stop, hold and disable from a second program, while a first one holds the port and moves the machine.

use std::fs::File;
use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};
use shared::interpolate::feed_hold::FeedState;
use shared::link::Status;
use shared::link::message::{Jog, Reply, Request};
use shared::link::packet::Header;
use shared::link::report::Activity;
use shared::safety::Power;

use super::emulated_board::EmulatedBoard;
use super::ports::{MOTIONS, at_mm};
use super::raw_link::{RawLink, frame};

/// Longest time that a second program may take, of a computer that does other things as well.
const SECOND_PROGRAM: Duration = Duration::from_secs(4);

/// What the first program is told, and what its axes do afterwards.
const HALTS: [(&str, &str, [&str; 2]); 3] = [
    ("stop", "another program has stopped the motion", ["path: at rest", "drives: on"]),
    ("hold", "another program has held the path", [", held", "drives: on"]),
    (
        "disable",
        "another program has switched the drives off",
        ["path: at rest", "drives: off; the enable switch permits"],
    ),
];

/// Halts a motion from a second program, and checks what the first one says and that its axes stand short of their target.
fn halt(board: &EmulatedBoard, first: Child, (verb, told, shown): (&str, &str, [&str; 2])) {
    // Of 6 s of motion.
    sleep(Duration::from_secs(2));
    let started = Instant::now();
    board.succeeds(&format!("board {verb} --port bench"));
    assert!(started.elapsed() < SECOND_PROGRAM, "{verb}: {:?}", started.elapsed());
    let output = first.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{verb}: {message}");
    assert!(message.contains(told) && message.lines().count() == 1, "{verb}: {message}");
    let status = board.status_with(&shown);
    let [x_mm, y_mm] = ["x ", "y "].map(|axis| at_mm(&status, axis));
    assert!(x_mm.abs() < 55.0 && y_mm.abs() < 105.0, "{verb}: {status}");
    sleep(Duration::from_millis(500));
    let later = board.succeeds("board status --port bench");
    // Without drives a motor is free within the dead zone of its screw.
    let most_mm = if verb == "disable" { 1e3 * firmware::bench::BACKLASH_M[0] } else { 1e-9 };
    for (axis, mm) in [("x ", x_mm), ("y ", y_mm)] {
        assert!((at_mm(&later, axis) - mm).abs() <= most_mm, "{verb}: {status} {later}");
    }
}

/// Each of the motions of a program, jogs, a homing and a resumed path, is halted in each way by a second one.
#[test]
fn a_second_program_halts_what_the_first_one_moves() {
    for ((before, motion), halts) in MOTIONS.iter().zip([&HALTS[..], &HALTS[2..], &HALTS[..1], &HALTS[1..2]])
    {
        for case in halts {
            let Some(board) = EmulatedBoard::armed() else { return };
            for command in *before {
                board.succeeds(command);
            }
            let first = board.start(motion);
            halt(&board, first, *case);
        }
    }
}

/// A recording that is stopped or held by a second program writes no log, and leaves nothing held.
#[test]
fn a_second_program_halts_a_recording_which_writes_no_log() {
    for (verb, told) in [("stop", HALTS[0].1), ("hold", HALTS[1].1)] {
        let Some(board) = EmulatedBoard::armed() else { return };
        let motion = board.at_start_of_travel();
        let first = board.start(&format!("record --port bench --motion {motion} --out travel.csv --yes"));
        sleep(Duration::from_secs(2));
        board.succeeds(&format!("board {verb} --port bench"));
        let output = first.wait_with_output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{verb}: {message}");
        assert!(message.contains(told), "{verb}: {message}");
        assert!(!board.path().join("travel.csv").exists());
        board.status_with(&["path: at rest", "drives: on"]);
    }
}

/// Whoever looks at the board during a motion does not disturb it: the jog reaches its target.
#[test]
fn a_second_program_looks_at_a_motion_that_goes_on() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let first = board.start("board jog --port bench --axis x --by-mm 30 --speed-mm-per-min 600");
    sleep(Duration::from_secs(1));
    let lines = board.succeeds("board monitor --port bench --interval-s 0.1 --lines 8");
    assert!(
        lines.lines().count() == 8 && lines.lines().all(|line| line.contains("drives on; jog")),
        "{lines}"
    );
    // The fastest monitor.
    let lines = board.succeeds("board monitor --port bench --interval-s 0 --lines 20");
    assert_eq!(lines.lines().count(), 20);
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("path: jog\n") && status.contains("drives: on"), "{status}");
    assert!(first.wait_with_output().unwrap().status.success());
    let status = board.succeeds("board status --port bench");
    assert!((at_mm(&status, "x ") - 30.0).abs() < 1e-3 && !status.contains("ago:"), "{status}");
}

/// A monitor that holds the port passes halts on, says so, and goes on.
#[test]
fn a_monitor_survives_a_stop() {
    let Some(board) = EmulatedBoard::armed() else { return };
    board.succeeds("board enable --port bench");
    let monitor = board.start_with_output("board monitor --port bench --interval-s 0.3 --lines 10");
    sleep(Duration::from_secs(1));
    board.succeeds("board disable --port bench");
    let output = monitor.wait_with_output().unwrap();
    let lines = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && lines.lines().count() == 10, "{lines}");
    let told = lines.lines().position(|line| line == HALTS[2].1).unwrap();
    let is = |line: &str, drives: &str| line.contains(&format!("drives {drives}"));
    assert!(lines.lines().take(told).all(|line| is(line, "on;")), "{lines}");
    assert!(told > 0 && lines.lines().skip(told + 1).all(|line| is(line, "off;")), "{lines}");
}

/// A program that was killed leaves its socket, and one that was suspended passes nothing on: the second program says so within its
/// time, and the board has held the path by itself.
#[test]
fn a_program_that_is_killed_or_suspended_locks_nobody_out() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let jog = "board jog --port bench --axis x --by-mm 60 --speed-mm-per-min 600";
    let mut first = board.start(jog);
    sleep(Duration::from_secs(2));
    first.kill().unwrap();
    first.wait().unwrap();
    board.succeeds("board stop --port bench");
    let first = board.start(jog);
    sleep(Duration::from_secs(2));
    let signal = |name: &str| {
        assert!(Command::new("kill").args([name, &first.id().to_string()]).status().unwrap().success());
    };
    signal("-STOP");
    sleep(Duration::from_millis(300));
    let started = Instant::now();
    let refused = board.fails(1, "board stop --port bench");
    assert!(started.elapsed() < SECOND_PROGRAM, "{:?}", started.elapsed());
    assert!(refused.contains("passes nothing on") && refused.contains(&first.id().to_string()), "{refused}");
    signal("-CONT");
    let output = first.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    // Held by its silence, or stopped by what the second program has sent meanwhile.
    assert_eq!(output.status.code(), Some(1), "{message}");
    board.succeeds("board stop --port bench");
}

/// A recording is not started without a consent: by a flag, or by Enter on a terminal, here a pseudo-terminal.
#[test]
fn a_recording_asks_before_it_moves() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let motion = board.at_start_of_travel();
    board.succeeds("board disable --port bench");
    let record = format!("record --port bench --motion {motion} --out travel.csv");
    let refused = board.fails(2, &record);
    for part in ["--yes", "switches the drives on", "to the start of the motion (x ", "a terminal to ask at"]
    {
        assert!(refused.contains(part), "{refused}");
    }
    assert!(board.succeeds("board status --port bench").contains("drives: off"));
    for (answer, code, said) in [("n\n", 1, "not started: nothing has moved"), ("\n", 0, "")] {
        let (mut master, slave) = TTYPort::pair().unwrap();
        let name = SerialPort::name(&slave).unwrap();
        let terminal = || Stdio::from(File::options().read(true).write(true).open(&name).unwrap());
        let mut first = board
            .command(&record)
            .stdin(terminal())
            .stderr(terminal())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        master.set_timeout(Duration::from_millis(100)).unwrap();
        let mut shown = String::new();
        let mut read = |until: &str, shown: &mut String| {
            let started = Instant::now();
            let mut bytes = [0; 256];
            while !shown.contains(until) && started.elapsed() < Duration::from_secs(10) {
                let count = master.read(&mut bytes).unwrap_or(0);
                shown.push_str(&String::from_utf8_lossy(&bytes[..count]));
            }
        };
        read("Enter starts it", &mut shown);
        assert!(shown.contains("switches the drives on") && shown.contains("Enter starts it"), "{shown}");
        assert!(board.succeeds("board status --port bench").contains("drives: off"));
        master.write_all(answer.as_bytes()).unwrap();
        let mut all = String::new();
        while first.try_wait().unwrap().is_none() {
            let mut bytes = [0; 256];
            let count = master.read(&mut bytes).unwrap_or(0);
            all.push_str(&String::from_utf8_lossy(&bytes[..count]));
        }
        let mut bytes = [0; 1024];
        let count = master.read(&mut bytes).unwrap_or(0);
        all.push_str(&String::from_utf8_lossy(&bytes[..count]));
        assert_eq!(first.wait().unwrap().code(), Some(code), "{all}");
        assert!(all.contains(said), "{all}");
        assert_eq!(board.path().join("travel.csv").exists(), code == 0);
    }
}

/// On the emulated board: a status, a stop and a status in one piece, without a session. By the ticks of both statuses the stop was
/// executed and answered within 2 ms, although it has arrived while the first reply was being sent. Its line has no rate; that of a real
/// board, with a stream, is in `shared/tests/link/halts.rs`.
#[test]
fn a_stop_is_executed_and_answered_within_two_milliseconds() {
    let Some(board) = EmulatedBoard::armed() else { return };
    // The median of three: the computer may suspend the emulator for milliseconds once.
    let mut times_ms = [(); 3].map(|()| time_of_a_stop_ms(&board));
    println!("{times_ms:?} ms from status to status");
    times_ms.sort_by(f64::total_cmp);
    assert!(times_ms[1] <= 2.0, "{times_ms:?} ms");
}

/// Time of the board from the status before a stop to the status after it, in a session of its own, ms.
fn time_of_a_stop_ms(board: &EmulatedBoard) -> f64 {
    let mut link = RawLink::open(board);
    let jog = Jog { axis: 0, distance_m: Some(0.03), velocity_m_per_s: 0.01, acceleration_m_per_s2: 0.5 };
    for (number, request) in (1..).zip([Request::Enable, Request::Jog(jog)]) {
        assert_eq!(link.exchange(&[frame(link.header(number), &request)], 1), [Reply::Done]);
        sleep(Duration::from_millis(100));
    }
    let none = Header::without_session;
    let three = [(1, Request::Status), (2, Request::Stop), (3, Request::Status)];
    let found = link.exchange(&three.map(|(number, request)| frame(none(number), &request)), 3);
    let [Reply::Status(before), Reply::Done, Reply::Status(after)] = &found[..] else { panic!("{found:?}") };
    let is = |status: &Status, feed| {
        assert_eq!((status.power, status.activity, status.feed), (Power::On, Activity::Jog, feed));
    };
    is(before, FeedState::Running);
    is(after, FeedState::Discarding);
    let ms = 1e3 * (after.tick - before.tick) as f64 / link.welcome.rates.velocity_loop_hz;
    drop(link);
    board.status_with(&["path: at rest"]);
    ms
}
