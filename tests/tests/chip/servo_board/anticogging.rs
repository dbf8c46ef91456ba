//! The cogging of the simulated machine, learned on the emulated board.

use std::f64::consts::TAU;
use std::fs;

use serde_json::Value;

use super::emulated_board::EmulatedBoard;
use firmware::bench::COGGING;

/// Lead of the bench, mm.
const LEAD_MM: f64 = 5.0;

/// Angles of a turn in which the bench counts the phase of its waves.
const PHASE_STEPS: f64 = 8192.0;

/// Two turns, and what the axis needs at either end.
const TRAVEL: &str = "--from-mm -5 --to-mm 7.5";

/// The board with both axes homed, x near the travel.
fn homed() -> Option<EmulatedBoard> {
    let board = EmulatedBoard::armed()?;
    for axis in ["x", "y"] {
        board.succeeds(&format!("board home --port bench --axis {axis}"));
    }
    board.succeeds("board jog --port bench --axis x --by-mm 86 --speed-mm-per-min 6000");
    Some(board)
}

/// Learns the cogging of x. Returns what is printed, and the JSON.
fn learn(board: &EmulatedBoard, out: &str) -> (String, Value) {
    let text = board.succeeds(&format!(
        "board anticogging --port bench --axis x {TRAVEL} --out {out} --json {out}.json --yes"
    ));
    println!("{text}");
    let json = fs::read_to_string(board.path().join(format!("{out}.json"))).unwrap();
    (text, serde_json::from_str(&json).unwrap())
}

/// The waves of the bench are found as they are, and no other: within 1.5 % of the amplitude (terms of second order: the speed varies by a sixth,
/// and a fortieth of the greatest wave is force for its acceleration) and 0.06 N (the noise of the encoder's counts and of the recorded force).
///
/// With the table applied, the following error of the passes falls to less than 4 %: the first run may be off by 2.3 % of the first wave and 3.5 % of
/// the second, and straight lines between 64 points leave 0.1 and 0.3 %. More than a sixth of a count of the encoder, 50 nm, remains. A second
/// run measures the whole cogging again, now of an axis that moves evenly: the same within 0.1 N.
#[test]
fn the_cogging_of_the_bench_is_learned_and_its_table_takes_it_away() {
    let Some(board) = homed() else { return };
    board.succeeds("board bench add-cogging");
    let (text, before) = learn(&board, "c.toml");
    assert!(text.contains("board upload --port bench"), "{text}");
    let wave = |file: &Value, period_mm: f64| {
        let waves = file["waves"].as_array().unwrap();
        let is_it = |wave: &&Value| (wave["period_mm"].as_f64().unwrap() - period_mm).abs() < 1e-9;
        let wave = waves.iter().find(is_it).unwrap();
        assert!(wave["found"].as_bool().unwrap(), "{wave}");
        [wave["amplitude_n"].as_f64().unwrap(), wave["phase_rad"].as_f64().unwrap()]
    };
    // The distance of two waves.
    let apart_n = |[a_n, a_rad]: [f64; 2], [b_n, b_rad]: [f64; 2]| {
        (a_n * a_rad.cos() - b_n * b_rad.cos()).hypot(a_n * a_rad.sin() - b_n * b_rad.sin())
    };
    let found = before["waves"].as_array().unwrap().iter().filter(|wave| wave["found"] == true);
    assert_eq!(found.count(), COGGING.len(), "{before}");
    let machine = EmulatedBoard::file("host-sim/machines/bench.toml");
    board.succeeds("board disable --port bench");
    board.succeeds(&format!(
        "board upload --port bench --machine {} --compensation c.toml",
        machine.display()
    ));
    let (_, after) = learn(&board, "again.toml");
    for true_wave in COGGING {
        let period_mm = LEAD_MM / f64::from(true_wave.order);
        let truth = [f64::from(true_wave.amplitude_n), TAU * f64::from(true_wave.phase_steps) / PHASE_STEPS];
        let [first, second] = [&before, &after].map(|file| wave(file, period_mm));
        let off_n = [first, second].map(|found| apart_n(found, truth));
        println!("{period_mm} mm: true {truth:?}, {first:?}, {second:?}, off by {off_n:?} N");
        assert!(off_n[0] < 0.015 * truth[0] + 0.06 && off_n[1] < 0.1, "{off_n:?}");
    }
    let um = [&before, &after].map(|file| file["following_error_um"].as_f64().unwrap());
    println!("{um:?} µm");
    // 8 N and 3 N on a loop of 2.4·10⁵ N/m: 33 and 13 µm, 25 µm rms.
    assert!((20.0..30.0).contains(&um[0]) && (0.008..0.04 * um[0]).contains(&um[1]), "{um:?}");
}

/// The bench without cogging gives no table. What cannot be learned is refused before anything moves.
#[test]
fn a_motor_without_cogging_gets_no_table() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let verb = "board anticogging --port bench --axis x --out c.toml";
    let unhomed = board.fails(1, &format!("{verb} {TRAVEL} --yes"));
    assert!(unhomed.contains("has to be homed"), "{unhomed}");
    board.succeeds("board disable --port bench");
    for (options, named) in [
        (TRAVEL.to_owned(), "--yes"),
        (format!("{TRAVEL} --yes --speed-mm-per-min 240"), "--speed-mm-per-min"),
        (format!("{TRAVEL} --yes --speed-mm-per-min 0.1"), "at most 1200 s"),
        (format!("{TRAVEL} --yes --passes 3"), "--passes"),
        ("--from-mm -1e300 --to-mm 0 --yes".to_owned(), "--from-mm"),
        (format!("{TRAVEL} --yes --harmonics 0"), "--harmonics"),
        (format!("{TRAVEL} --yes --period-mm -1"), "--period-mm"),
        ("--from-mm 0 --to-mm 12 --yes".to_owned(), "2 periods of 5 mm"),
        ("--from-mm 0 --to-mm 101 --yes".to_owned(), "travel_mm"),
        (format!("{TRAVEL} --yes --json c.toml"), "--json"),
    ] {
        let refused = board.fails(2, &format!("{verb} {options}"));
        assert!(refused.contains(named), "{options}: {refused}");
    }
    board.status_with(&["drives: off"]);
    drop(board);
    let Some(board) = homed() else { return };
    let (text, file) = learn(&board, "c.toml");
    assert!(text.starts_with("No cogging above ") && text.contains("c.toml is not written"), "{text}");
    assert!(!board.path().join("c.toml").exists());
    // The resolution of the recorded force is 1/32 N.
    let limit_n = file["limit_n"].as_f64().unwrap();
    assert!((1.0 / 32.0..0.3).contains(&limit_n), "{limit_n}");
}
