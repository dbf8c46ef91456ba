//! The emulated board with a beam on the tables of x and u: it is homed, squared, moved, recorded, and stopped when an end lags.

use std::fs;

use super::emulated_board::EmulatedBoard;
use files::log::{Channel, Log};

fn path(name: &str) -> String {
    EmulatedBoard::file(name).display().to_string()
}

/// A board of four axes with the beam, its settings, and the enable switch closed.
fn armed() -> Option<EmulatedBoard> {
    let board = EmulatedBoard::new()?;
    board.succeeds("board bench start-four");
    board.succeeds("board bench add-beam");
    let machine = path("host-sim/machines/bench_gantry.toml");
    board.succeeds(&format!("board upload --port bench --machine {machine}"));
    board.succeeds("board bench close-switch");
    Some(board)
}

/// The columns of an axis in a status: command and motor, mm, and force, N.
fn numbers(status: &str, axis: &str) -> [f64; 3] {
    let line = status.lines().find(|line| line.starts_with(&format!("{axis} "))).unwrap();
    let columns: Vec<&str> = line.split_whitespace().collect();
    [1, 2, 4].map(|column| columns[column].parse().unwrap())
}

/// The skew in a status, µm.
fn skew_um(status: &str) -> f64 {
    let line = status.lines().find(|line| line.starts_with("u: second motor of a gantry with x, ")).unwrap();
    line.split_whitespace().rev().nth(5).unwrap().parse().unwrap()
}

/// The beam starts with 80 µm of skew, which are not known. Squared, both ends read the same within a count or two at each end and what the following
/// errors leave; both motors push with less than their friction of 20 N, as nothing bends the beam: 80 µm would be 16 N more.
#[test]
fn a_beam_is_homed_moved_and_recorded() {
    let Some(board) = armed() else { return };
    let home = board.succeeds("board home --port bench --axis x");
    assert!(home.contains("x is homed"), "{home}");
    board.succeeds("board jog --port bench --axis x --by-mm 91.7 --speed-mm-per-min 6000");
    let status = board.succeeds("board status --port bench");
    let [[x, x_motor, x_n], [u, u_motor, u_n]] = ["x", "u"].map(|axis| numbers(&status, axis));
    // The index of u came 0.12 mm behind that of x, and x has gone on by 6 µm.
    assert!((x - u).abs() < 1e-9 && (-0.15..-0.1).contains(&x), "{status}");
    assert!((x_motor - u_motor).abs() < 0.003 && skew_um(&status).abs() < 3.0, "{status}");
    assert!(x_n.abs() < 24.0 && u_n.abs() < 24.0, "{status}");
    for axis in ["y", "z"] {
        board.succeeds(&format!("board home --port bench --axis {axis}"));
    }
    let (machine, motion) =
        (path("host-sim/machines/bench_gantry.toml"), path("host-sim/motions/circle.toml"));
    board.succeeds(&format!("record --port bench --machine {machine} --motion {motion} --out out.csv --yes"));
    let log = Log::read(&board.path().join("out.csv")).unwrap();
    let channel = |axis: &str, channel| log.axis(axis).unwrap().channel(channel).unwrap().to_vec();
    let [x, u] = ["x", "u"].map(|axis| channel(axis, Channel::Command));
    let most = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most(&x, &vec![x[0]; x.len()]) > 5.0 && most(&x, &u) < 1e-6, "{}", most(&x, &u));
    let [x, u] = ["x", "u"].map(|axis| channel(axis, Channel::Motor));
    assert!(most(&x, &u) < 0.1, "{}", most(&x, &u));
    let monitor = board.succeeds("board monitor --port bench --lines 1");
    assert!(monitor.contains("u ") && monitor.contains("skew "), "{monitor}");
}

/// u is not moved by itself, in any way: one line, with its first motor, and nothing has moved.
#[test]
fn the_second_motor_is_refused_by_name() {
    let Some(board) = armed() else { return };
    board.succeeds("board home --port bench --axis x");
    let before = numbers(&board.succeeds("board status --port bench"), "u")[0];
    for command in [
        "board jog --port bench --axis u --by-mm 1",
        "board home --port bench --axis u",
        "board probe --port bench --axis u --distance-mm 1 --speed-mm-per-min 60",
        "board follow --port bench --axis u --distance-mm 5 --counts 4000 --speed-mm-per-min 600 --counter x",
    ] {
        let refused = board.fails(1, command);
        assert!(refused.contains("u is the second motor of a gantry, and moves with x"), "{refused}");
    }
    assert_eq!(numbers(&board.succeeds("board status --port bench"), "u")[0].to_bits(), before.to_bits());
    let (machine, motion) =
        (path("host-sim/machines/bench_gantry.toml"), path("host-sim/motions/bench_four.toml"));
    let record = format!("record --port bench --machine {machine} --motion {motion} --out out.csv --yes");
    let refused = board.fails(2, &record);
    let expected =
        "start_mm: expected axes with a command of their own (u is the second motor of x), found axis u";
    assert!(refused.contains(expected), "{refused}");
}

/// The table of u has 400 N more friction, twice the force of its drive: it stands, and x bends the beam up to the limit of 0.2 mm.
#[test]
fn an_end_that_lags_stops_the_beam_by_name() {
    let Some(board) = armed() else { return };
    board.succeeds("board home --port bench --axis x");
    board.succeeds("board jog --port bench --axis x --by-mm 20 --speed-mm-per-min 3000");
    board.succeeds("board bench add-drag");
    let failed = board.fails(1, "board jog --port bench --axis x --by-mm 20 --speed-mm-per-min 3000");
    assert!(failed.contains("u: skew of the gantry beyond its limit"), "{failed}");
    let status = board.status_with(&["off by a fault: u: skew"]);
    assert!(["x", "u"].map(|axis| numbers(&status, axis)[2].abs() < 0.05) == [true; 2], "{status}");
    let refused = board.fails(1, "board jog --port bench --axis x --by-mm -1");
    assert!(refused.contains("`board clear` acknowledges it"), "{refused}");
    board.succeeds("board bench remove-drag");
    board.succeeds("board clear --port bench");
    board.succeeds("board jog --port bench --axis x --by-mm -1");
    assert!(skew_um(&board.succeeds("board status --port bench")).abs() < 10.0);
}

/// By one line with the file and the key.
#[test]
fn bad_keys_of_a_gantry_are_refused_before_the_upload() {
    let Some(board) = EmulatedBoard::new() else { return };
    board.succeeds("board bench start-four");
    let good = fs::read_to_string(EmulatedBoard::file("host-sim/machines/bench_gantry.toml")).unwrap();
    for (line, changed, code, wanted) in [
        (
            "gantry_with = \"x\"",
            "gantry_with = \"u\"",
            2,
            "axis.u.gantry_with: expected the name of another axis",
        ),
        (
            "gantry_skew_limit_mm = 0.2",
            "",
            2,
            "axis.u.gantry_skew_limit_mm: expected a limit beside gantry_with",
        ),
        (
            "gantry_offset_mm = -0.04",
            "gantry_offset_mm = -200",
            2,
            "axis.u.gantry_offset_mm: expected a number from -100 to 100",
        ),
        (
            "gantry_skew_limit_mm = 0.2",
            "gantry_skew_limit_mm = 1.5",
            2,
            "u: gantry.skew_limit_m: 0.0015 is above 0.001, the ceiling of this board",
        ),
    ] {
        let text = good.replace(line, changed);
        assert_ne!(text, good);
        fs::write(board.path().join("bad.toml"), text).unwrap();
        let refused = board.fails(code, "board upload --port bench --machine bad.toml");
        assert!(refused.contains("bad.toml") && refused.contains(wanted), "{refused}");
    }
    assert!(!board.succeeds("board status --port bench").contains("second motor"));
}
