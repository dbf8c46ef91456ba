//! An axis that follows a master, on the emulated board: a turn is 4000 counts in a second.

use std::thread::sleep;
use std::time::Duration;

use super::emulated_board::EmulatedBoard;
use super::ports::at_mm;

const FOLLOW: &str =
    "board follow --port bench --axis x --distance-mm 5 --counts 4000 --speed-mm-per-min 600";

/// Homed, and away from the ends of the travel.
fn homed() -> Option<EmulatedBoard> {
    let board = EmulatedBoard::armed()?;
    board.succeeds("board home --port bench --axis x");
    board.succeeds("board jog --port bench --axis x --by-mm 50 --speed-mm-per-min 6000");
    Some(board)
}

/// The command of x, mm.
fn x_mm(board: &EmulatedBoard) -> f64 {
    at_mm(&board.succeeds("board status --port bench"), "x ")
}

/// Two turns forwards and one back are one turn, 5 mm, to the last digit that is shown. After the stop nothing moves it, until it engages again where it is.
#[test]
fn each_turn_is_its_distance_until_it_is_stopped() {
    let Some(board) = homed() else { return };
    let start = x_mm(&board);
    let first = board.start(FOLLOW);
    // It has the port first.
    sleep(Duration::from_secs(1));
    board.status_with(&["path: following a counter", "x: follows a counter"]);
    for action in ["turn-master", "turn-master", "turn-master-back"] {
        board.succeeds(&format!("board bench {action}"));
        sleep(Duration::from_secs(2));
    }
    // 50 times its greatest time constant, 20 ms, after the last count, at the speed of a busy computer.
    let turned = x_mm(&board);
    assert!((turned - start - 5.0).abs() < 1.5e-4, "{start} to {turned} mm");
    let failed = board.fails(1, "board jog --port bench --axis x --by-mm 1");
    assert!(!failed.is_empty());
    board.succeeds("board stop --port bench");
    let output = first.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && message.contains("another program has stopped"), "{message}");
    board.succeeds("board bench turn-master");
    sleep(Duration::from_secs(2));
    assert!((x_mm(&board) - turned).abs() < 1.5e-4);
    let shown = board.succeeds(&format!("{FOLLOW} --time-s 1"));
    assert!(shown.ends_with("mm, and follows no longer.\n"), "{shown}");
    assert!((x_mm(&board) - turned).abs() < 1.5e-4);
}

/// 50 mm/s before an axis of 10 mm/s: after 2 mm it stops by its fault. The other axis has a scale and no counter; what is no number is an unusable argument.
#[test]
fn what_cannot_be_followed_is_named() {
    let Some(board) = homed() else { return };
    let fast = FOLLOW.replace("-mm 5 ", "-mm 50 ");
    let first = board.start(&fast);
    sleep(Duration::from_secs(1));
    board.status_with(&["x: follows a counter"]);
    board.succeeds("board bench turn-master");
    let output = first.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && message.lines().count() == 1, "{message}");
    assert!(message.contains("x: it lags behind the counter that it follows"), "{message}");
    board.status_with(&["drives: off by a fault"]);
    board.succeeds("board clear --port bench");
    let failed = board.fails(1, &FOLLOW.replace("axis x", "axis y"));
    assert!(failed.contains("there is no counter at this input"), "{failed}");
    // The counter of x for y, which is not homed.
    let failed = board.fails(1, &format!("{} --counter x", FOLLOW.replace("axis x", "axis y")));
    assert!(failed.contains("y: it has to be homed"), "{failed}");
    let failed = board.fails(1, &FOLLOW.replace("-min 600", "-min 9000"));
    assert!(failed.contains("x would exceed 8100 mm/min"), "{failed}");
    for (from, to, option) in [
        ("-mm 5 ", "-mm 0 ", "--distance-mm: expected a distance"),
        ("-mm 5 ", "-mm nan ", "--distance-mm: expected a distance"),
        ("counts 4000", "counts 0.5", "--counts: expected a whole number"),
        ("counts 4000", "counts -1", "--counts: expected a whole number"),
        ("-min 600", "-min 0", "--speed-mm-per-min: expected a number"),
        ("-min 600", "-min 600 --lag-mm 0", "--lag-mm: expected a number"),
        ("-min 600", "-min 600 --acceleration-m-per-s2 0", "--acceleration-m-per-s2: expected a number"),
        ("-min 600", "-min 600 --time-s -1", "--time-s: expected a number"),
        ("-min 600", "-min 600 --counter z", "--counter: expected x or y"),
    ] {
        let failed = board.fails(2, &FOLLOW.replace(from, to));
        assert!(failed.contains(option), "{failed}");
    }
}
