//! A scale that stands, with the loop on it, and direction checks that wait.

use std::fs;
use std::thread::sleep;
use std::time::Duration;

use super::emulated_board::EmulatedBoard;

/// Positions of motor and scale of x, mm, by the status.
fn readings_mm(status: &str) -> [f64; 2] {
    let line = status.lines().find(|line| line.starts_with("x ")).unwrap();
    let mut words = line.split_whitespace().skip(2).map(|word| word.parse().unwrap());
    [(); 2].map(|()| words.next().unwrap())
}

/// The machine file of the bench with the loop of x on its scale, and without limits for it: those of a file that declares none hold.
fn with_scale_in_the_loop(feedback: &str) -> String {
    let machine = fs::read_to_string(EmulatedBoard::file("host-sim/machines/bench.toml")).unwrap();
    let (x, y) = machine.split_once("[axis.y]").unwrap();
    let without: Vec<&str> = x
        .lines()
        .filter(|line| !line.starts_with("scale_disagreement") && !line.starts_with("frozen_encoder"))
        .collect();
    let x = without.join("\n").replacen("feedback = \"motor\"", feedback, 1);
    format!("{x}\n[axis.y]{y}")
}

/// With the scale or with both in the loop: a jog at 10 mm/s whose scale freezes ends with the fault of the scale, when the motor has
/// moved by 0.4 mm at most since, and 45/64 of it at least. It then has at most 10 mm/s + Kp·0.4 mm = 20 mm/s, and coasts with the drives off
/// by less than v²·15 kg/(2·20 N) = 0.15 mm. Before, it moved on without end.
#[test]
fn a_frozen_scale_in_the_loop_switches_the_drives_off_within_half_a_millimetre() {
    for feedback in ["feedback = \"table\"", "feedback = \"dual\"\ndual_feedback_time_constant_s = 0.05"] {
        let Some(board) = EmulatedBoard::armed() else { return };
        fs::write(board.path().join("machine.toml"), with_scale_in_the_loop(feedback)).unwrap();
        board.succeeds("board upload --port bench --machine machine.toml");
        let moving = board.start("board jog --port bench --axis x --by-mm 60 --speed-mm-per-min 600");
        sleep(Duration::from_secs(2));
        board.succeeds("board bench freeze-scale");
        let output = moving.wait_with_output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{feedback}: {message}");
        assert!(
            message.contains("x: the motor moves and the scale reading does not"),
            "{feedback}: {message}"
        );
        let status = board.succeeds("board status --port bench");
        assert!(status.contains("drives: off by a fault"), "{status}");
        let [motor_mm, scale_mm] = readings_mm(&status);
        assert!((0.28..0.56).contains(&(motor_mm - scale_mm)), "{feedback}: {status}");
    }
}

/// By hand, with seconds between the commands: the check still waits, and pushes the axis when the switch is closed.
#[test]
fn a_direction_check_by_hand_waits_for_the_switch() {
    let Some(board) = EmulatedBoard::new() else { return };
    let waits = board.succeeds("board check-direction --port bench --axis x --force-n 40 --no-wait");
    assert!(waits.contains("within 10 s"), "{waits}");
    sleep(Duration::from_secs(5));
    board.succeeds("board bench close-switch");
    let status = board.status_with(&["direction check of x: force, motor encoder and scale have the same"]);
    let [motor_mm, scale_mm] = readings_mm(&status);
    assert!((0.15..0.3).contains(&motor_mm) && (0.15..0.3).contains(&scale_mm), "{status}");
}

/// Another command that opens a session ends a check that waits: closing the switch afterwards pushes nothing. That it also expires with the silence of its
/// host is tested with the ticks of `shared/tests/link/direction.rs`.
#[test]
fn a_direction_check_ends_with_the_next_session() {
    let Some(board) = EmulatedBoard::new() else { return };
    board.succeeds("board check-direction --port bench --axis x --force-n 40 --no-wait");
    board.succeeds("board clear --port bench");
    board.succeeds("board bench close-switch");
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("direction check of x: ended before the enable switch was closed"), "{status}");
    assert!(readings_mm(&status).iter().all(|mm| mm.abs() < 1e-3), "{status}");
}

/// With a motor encoder that is frozen, the scale ends the force at 0.1 mm; the axis coasts as far again, and the encoder is named.
#[test]
fn a_frozen_encoder_ends_a_direction_check_by_the_scale() {
    let Some(board) = EmulatedBoard::new() else { return };
    board.succeeds("board bench freeze-encoder");
    board.succeeds("board check-direction --port bench --axis x --force-n 40 --no-wait");
    board.succeeds("board bench close-switch");
    let status = board.status_with(&["the scale has moved, the motor encoder stands"]);
    let [motor_mm, scale_mm] = readings_mm(&status);
    assert!(motor_mm.abs() < 1e-3 && (0.15..0.3).contains(&scale_mm), "{status}");
}
