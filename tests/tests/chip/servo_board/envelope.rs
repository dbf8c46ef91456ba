//! Uploads beyond the envelope of the emulated board (`firmware/src/bench`): refused by name, and nothing has changed.

use std::fs;

use super::emulated_board::EmulatedBoard;

/// A line of the machine file, what stands there instead, and what the board says of it.
const BEYOND: [(&str, &str, &str); 8] = [
    ("force_limit_n = 200.0", "force_limit_n = 300.1", "force_limit_n: 300.1 is above 300, the ceiling"),
    (
        "fastest_mm_per_s = 150.0",
        "fastest_mm_per_s = 301.0",
        "fastest_m_per_s: 0.301 is above 0.3, the ceiling",
    ),
    (
        "travel_mm = [-100.0, 100.0]",
        "travel_mm = [-100.5, 100.0]",
        "travel_m: -0.1005 is below -0.1, the floor",
    ),
    (
        "travel_mm = [-100.0, 100.0]",
        "travel_mm = [-100.0, 125.0]",
        "travel_m: 0.125 is above 0.1, the ceiling",
    ),
    (
        "following_error_limit_mm = 1.0",
        "following_error_limit_mm = 2.5",
        "following_error_limit_m: 0.0025 is above 0.002, the ceiling",
    ),
    (
        "scale_disagreement_limit_mm = 0.5",
        "scale_disagreement_limit_mm = 1.5",
        "scale_disagreement_limit_m: 0.0015 is above 0.001, the ceiling",
    ),
    (
        "frozen_encoder_limit_mm = 0.3",
        "frozen_encoder_limit_mm = 0.75",
        "frozen_encoder_limit_m: 0.00075 is above 0.0005, the ceiling",
    ),
    (
        "stop_deceleration_m_per_s2 = 2.0",
        "stop_deceleration_m_per_s2 = 0.25",
        "stop_deceleration_m_per_s2: 0.25 is below 0.5, the floor",
    ),
];

/// Limits that may not be left out.
const MISSING: [(&str, &str); 3] = [
    (
        "fastest_mm_per_s = 150.0\n",
        "fastest_m_per_s: it is missing; this board requires a limit of at most 0.3",
    ),
    ("travel_mm = [-100.0, 100.0]\n", "travel_m: it is missing; this board requires a limit of at most 0.1"),
    (
        "frozen_encoder_limit_mm = 0.3\n",
        "frozen_encoder_limit_m: it is missing; this board requires a limit of at most 0.0005",
    ),
];

fn machine() -> String {
    fs::read_to_string(EmulatedBoard::file("host-sim/machines/bench.toml")).unwrap()
}

/// The refusal of a machine file in which the last occurrence of a text, that of y, is replaced.
fn refusal_of(board: &EmulatedBoard, line: &str, other: &str) -> String {
    let machine = machine();
    let (before, behind) = machine.rsplit_once(line).expect(line);
    fs::write(board.path().join("beyond.toml"), format!("{before}{other}{behind}")).unwrap();
    board.fails(2, "board upload --port bench --machine beyond.toml")
}

#[test]
fn an_upload_beyond_the_envelope_is_refused_by_name() {
    let Some(board) = EmulatedBoard::new() else { return };
    let status = || {
        let status = board.succeeds("board status --port bench");
        status.lines().find(|line| line.starts_with("settings:")).unwrap().to_owned()
    };
    let missing = MISSING.map(|(line, message)| (line, "", message));
    for (line, other, message) in BEYOND.into_iter().chain(missing) {
        let refused = refusal_of(&board, line, other);
        assert!(refused.contains(&format!("y: {message}")), "{refused}\ninstead of {message}");
        assert_eq!(status(), "settings: of its program; nothing is saved in flash");
    }
    // The file without a change is accepted.
    fs::write(board.path().join("machine.toml"), machine()).unwrap();
    board.succeeds("board upload --port bench --machine machine.toml");
    assert_eq!(status(), "settings: uploaded, not saved; nothing is saved in flash");
}
