//! A vertical axis with a brake: y of the bench, stood up, with 15 kg and with 18 kg.
//!
//! Its brake opens 40 ms after its output, and closes 20 ms after it. Without a preload the axis sags then, by the equation of
//! `shared/tests/vertical/sag.rs`, until the loop carries its weight.

use std::fs;

use shared::capture::Trigger;
use shared::link::message::{Reply, Request};

use super::emulated_board::EmulatedBoard;
use super::raw_link::{RawLink, frame};

/// Times of the brake in the machine file, with a reserve.
const BRAKE: &str = "brake_release_s = 0.06\nbrake_engage_s = 0.03\n";

/// A board whose y is vertical, with these keys of y in its machine file.
fn standing(keys: &str, loaded: bool) -> Option<EmulatedBoard> {
    let board = EmulatedBoard::armed()?;
    board.succeeds("board bench stand-up");
    if loaded {
        board.succeeds("board bench add-load");
    }
    let machine = fs::read_to_string(EmulatedBoard::file("host-sim/machines/bench.toml")).unwrap();
    fs::write(board.path().join("machine.toml"), machine + keys).unwrap();
    board.succeeds("board upload --port bench --machine machine.toml");
    Some(board)
}

/// Enables the drives, and reads how far y went down and up within 0.4 s, mm.
fn way_after_enable_mm(board: &EmulatedBoard) -> [f64; 2] {
    let mut link = RawLink::open(board);
    let frames = [Request::Arm { trigger: Trigger::Now, samples: 8000 }, Request::Enable];
    let [arm, enable] = &frames;
    let frames = [frame(link.header(1), arm), frame(link.header(2), enable)];
    assert_eq!(link.exchange(&frames, 2), [Reply::Done, Reply::Done]);
    drop(link);
    std::thread::sleep(std::time::Duration::from_millis(700));
    board.succeeds("board capture --port bench --only read --out on.csv");
    let log = fs::read_to_string(board.path().join("on.csv")).unwrap();
    let (head, rows) = log.split_once('\n').unwrap();
    let column = head.split(',').position(|name| name == "y_motor_mm").expect(head);
    let motor_mm = rows.lines().map(|row| row.split(',').nth(column).unwrap().parse::<f64>().unwrap());
    let motor_mm: Vec<f64> = motor_mm.collect();
    assert!(motor_mm.len() == 8000, "{} rows", motor_mm.len());
    let [least, greatest] = [f64::min, f64::max].map(|of| motor_mm.iter().copied().reduce(of).unwrap());
    [motor_mm[0] - least, greatest - motor_mm[0]]
}

/// With its weight as the preload, an axis of 15 kg and one of 18 kg holds to 1 µm, 20 counts, when its brake opens: the force of the PWM has
/// steps of 48 mN, which the friction of 20 N holds.
#[test]
fn a_preloaded_axis_holds_when_its_brake_opens() {
    for (loaded, preload_n) in [(false, 147.15), (true, 176.58)] {
        let Some(board) = standing(&format!("{BRAKE}preload_n = {preload_n}\n"), loaded) else { return };
        let [down_mm, up_mm] = way_after_enable_mm(&board);
        assert!(down_mm < 0.001 && up_mm < 0.001, "{preload_n} N: {down_mm} mm down, {up_mm} mm up");
        let status = board.succeeds("board status --port bench");
        assert!(status.contains("drives: on\n"), "{status}");
        board.succeeds("board jog --port bench --axis y --by-mm 1");
        assert_eq!(board.succeeds("board disable --port bench"), "The drives are off.\n");
    }
}

/// Without one it sags when the brake opens. With 20 N of friction and the limit of 200 N, the equation gives 0.489 mm and 0.618 mm; the viscous
/// friction of 100 N·s/m takes 1 to 2 % of it.
#[test]
fn without_a_preload_the_axis_sags() {
    for (loaded, expected_mm) in [(false, 0.489), (true, 0.618)] {
        let Some(board) = standing(BRAKE, loaded) else { return };
        let [down_mm, up_mm] = way_after_enable_mm(&board);
        assert!((0.96..1.01).contains(&(down_mm / expected_mm)), "{down_mm} mm, expected {expected_mm} mm");
        assert!(up_mm < 0.001, "{up_mm} mm up");
    }
}

/// The load that a trace has found is the preload, which is said; the direction of such an axis is not checked.
#[test]
fn a_constant_load_is_the_preload_of_an_upload() {
    let load = "[[axis.y.effect]]\nname = \"constant_load\"\nforce_n = 147.15\n";
    let Some(board) = standing(&format!("{BRAKE}{load}"), false) else { return };
    let said = board.succeeds("board upload --port bench --machine machine.toml");
    assert!(
        said.contains("The drive of y comes on with 147.2 N: the constant_load of machine.toml"),
        "{said}"
    );
    let refused = board.fails(2, "board check-direction --port bench --axis y --force-n 40");
    assert!(refused.contains("--axis: expected an axis without a brake"), "{refused}");
    let [down_mm, _] = way_after_enable_mm(&board);
    assert!(down_mm < 0.001, "{down_mm} mm down");
}
