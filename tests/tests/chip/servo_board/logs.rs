//! Logs of the board: what they contain, and what the tracer finds in them.

use std::fs;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use super::emulated_board::EmulatedBoard;

/// Width of the backlash of x, which the machine file of the board does not declare, µm.
const BACKLASH_UM: f64 = 1e6 * firmware::bench::BACKLASH_M[0];

/// 0.5 s of both axes at 20 kHz, from the memory of the board.
#[test]
fn every_tick_of_a_jog_is_captured() {
    let Some(board) = EmulatedBoard::armed() else { return };
    board.succeeds("board capture --port bench --only arm --trigger motion --seconds 0.5");
    board.succeeds("board jog --port bench --axis x --by-mm 8 --speed-mm-per-min 1200");
    let text = board.succeeds("board capture --port bench --only read --out jog.csv");
    assert!(text.starts_with("10000 samples at 20000 Hz in jog.csv"), "{text}");
    let log = fs::read_to_string(board.path().join("jog.csv")).unwrap();
    let mut lines = log.lines();
    let names =
        "time_s,x_command_mm,x_motor_mm,x_table_mm,x_force_n,y_command_mm,y_motor_mm,y_table_mm,y_force_n";
    assert_eq!(lines.next(), Some(names));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|value| value.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 10_000);
    let last = rows.last().unwrap();
    // 8 mm at 20 mm/s and 0.5 m/s² take 0.44 s.
    assert!((last[0] - 0.49995).abs() < 1e-9 && (last[1] - 8.0).abs() < 1e-9, "{last:?}");
    // The table is behind the motor by half of the backlash, less than a count of the spring.
    let behind_um = 1e3 * (last[2] - last[3]);
    assert!((behind_um - 0.5 * BACKLASH_UM).abs() < 1.0, "{behind_um} µm");
    // No tick is missing: the readings change by at most 20 mm/s.
    assert!(rows.windows(2).all(|pair| (pair[1][2] - pair[0][2]).abs() < 1.5e-3));
}

/// The log goes straight into the tracer, which names the effect that the machine file lacks, with its width, and nothing on y.
#[test]
fn the_tracer_finds_the_undeclared_backlash_of_the_board() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let [machine, travel, circle] =
        ["machines/bench.toml", "motions/bench_travel.toml", "motions/bench_circle.toml"]
            .map(|name| EmulatedBoard::file(&format!("host-sim/{name}")).display().to_string());
    for axis in ["x", "y"] {
        let text = board.succeeds(&format!("board home --port bench --axis {axis}"));
        assert!(text.contains("is homed"), "{text}");
    }
    board.succeeds(&format!("record --port bench --motion {travel} --out travel.csv --yes"));
    board.succeeds(&format!("record --port bench --motion {circle} --out circle.csv --yes"));
    board.succeeds(&format!(
        "trace --machine {machine} --fit travel.csv --validate circle.csv --json out.json"
    ));
    let json: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(board.path().join("out.json")).unwrap()).unwrap();
    let effects = json["effects"].as_array().unwrap();
    let backlash = effects.iter().find(|effect| effect["name"] == "backlash").unwrap();
    assert_eq!(backlash["axis"], "x", "{effects:#?}");
    let width = backlash["parameters"]["width_um"]["value"].as_f64().unwrap();
    // A count is 0.05 µm.
    assert!((width - BACKLASH_UM).abs() < 0.5, "{width} µm");
    assert!(effects.iter().all(|effect| effect["axis"] == "x"), "{effects:#?}");
}

/// The program that records is stopped for longer than the board waits: the path is held, its rest is discarded, and no log is
/// written.
#[test]
fn a_recording_of_a_silent_host_fails_and_leaves_nothing_held() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let motion = board.at_start_of_travel();
    let record = board.start(&format!("record --port bench --motion {motion} --out travel.csv --yes"));
    // Of 7 s of motion.
    sleep(Duration::from_secs(2));
    let signal = |name: &str| {
        let id = record.id().to_string();
        assert!(Command::new("kill").args([name, &id]).status().unwrap().success());
    };
    signal("-STOP");
    // The board holds after 0.5 s and switches off after 10 s of its own time, which may run more slowly.
    sleep(Duration::from_secs(6));
    signal("-CONT");
    let output = record.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(
        message.contains("the board held the path, since this program was silent for 0.5 s"),
        "{message}"
    );
    assert!(!board.path().join("travel.csv").exists());
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("path: at rest") && status.contains("drives: on"), "{status}");
}
