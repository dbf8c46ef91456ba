//! Homing to a hard stop on the emulated board.

use std::thread::sleep;
use std::time::Duration;

use super::emulated_board::EmulatedBoard;

/// Homes x to the hard stop, 28.8 mm before its position at power-up.
const HOME: &str = "board home --port bench --axis x --stop-force-n -60 --search-mm 40 --stop-at-mm -60";

/// Motor and scale of x, mm, and whether it is homed.
fn x(board: &EmulatedBoard) -> ([f64; 2], bool) {
    let status = board.succeeds("board status --port bench");
    let line = status.lines().find(|line| line.starts_with("x ")).unwrap().to_owned();
    let words: Vec<&str> = line.split_whitespace().collect();
    ([2, 3].map(|word: usize| words[word].parse().unwrap()), !line.contains("not homed"))
}

/// The axis ends 2 mm before the stop; once the loop has settled, motor and scale agree but for the dead zone of the screw of 0.014 mm, which the
/// motor has crossed on its way back. A second homing starts 0.1 mm before the stop that the first one has found, and ends at the same command.
#[test]
fn an_axis_is_homed_to_a_hard_stop_and_again_from_beside_it() {
    let Some(board) = EmulatedBoard::armed() else { return };
    board.succeeds("board bench add-stop");
    assert_eq!(board.succeeds(HOME), "x is homed; it is at -58.0000 mm.\n");
    // Fifty integral times of the velocity loop.
    sleep(Duration::from_secs(1));
    let ([motor_mm, scale_mm], homed) = x(&board);
    assert!(homed && (motor_mm + 58.0).abs() < 0.001, "{motor_mm} mm");
    assert!((scale_mm - motor_mm).abs() < 0.0155, "{motor_mm} mm, {scale_mm} mm");
    board.succeeds("board jog --port bench --axis x --by-mm -1.9");
    assert_eq!(board.succeeds(HOME), "x is homed; it is at -58.0000 mm.\n");
}

/// Without a stop the search ends at its distance; a force that the axis does not have is refused.
#[test]
fn a_stop_that_is_not_there_is_named() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let missing = HOME.replace("--search-mm 40", "--search-mm 1");
    let failed = board.fails(1, &missing);
    assert!(failed.contains("x: not homed: no hard stop within the search distance"), "{failed}");
    assert!(!x(&board).1);
    let refused = board.fails(2, &HOME.replace("-60 --search", "-201 --search"));
    assert!(
        refused.contains("--stop-force-n: expected at most 200 N, the force limit of the axis"),
        "{refused}"
    );
    let refused = board.fails(2, &format!("{HOME} --stop-speed-mm-per-min 400"));
    assert!(
        refused.contains("--stop-speed-mm-per-min: expected at most 300 (half of frozen_encoder_limit_m"),
        "{refused}"
    );
}
