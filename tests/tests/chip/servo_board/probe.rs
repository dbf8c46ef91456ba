//! Probing on the emulated board, whose x table carries a probe.

use std::thread::sleep;
use std::time::Duration;

use super::emulated_board::EmulatedBoard;
use super::ports::at_mm;

/// Towards the workpiece, 11.2 mm from the position at power-up, with 0.25 µm in a tick and 1.25 µm in a position tick.
const PROBE: &str = "board probe --port bench --axis x --distance-mm 15 --speed-mm-per-min 300";

/// The workpiece, mm from the position at power-up, from which the readings of an axis count that is not homed.
const AT_MM: f64 = 11.2;

/// The numbers of the row of a name.
fn row(text: &str, name: &str) -> Vec<f64> {
    let line = text.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{text}"));
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

/// The scale reads the table, on which the probe is: its latched reading is at most the way of a tick, 0.25 µm, behind the surface, and rounded down
/// to its count of 0.05 µm; the display rounds to 0.1 µm. The motor is ahead by half of the dead zone of the screw, 7 µm, and by what its
/// 50 N/µm are stretched by friction, 20 N + 100 N·s/m · 5 mm/s: 0.41 µm. The command is ahead by what remains of the following error,
/// which its limit of 1 mm bounds, and older by up to 1.25 µm.
#[test]
fn the_positions_of_the_touch_are_those_of_the_surface() {
    let Some(board) = EmulatedBoard::armed() else { return };
    board.succeeds("board bench add-workpiece");
    let shown = board.succeeds(&format!("{PROBE} --retract"));
    let [command_mm, motor_mm, scale_mm] = row(&shown, "touched")[..] else { panic!("{shown}") };
    let rounding_mm = 0.06e-3;
    let behind_mm = scale_mm - AT_MM;
    assert!((-0.05e-3 - rounding_mm..0.25e-3 + rounding_mm).contains(&behind_mm), "{shown}");
    let stretch_mm = motor_mm - scale_mm - 7e-3;
    // A tenth of the friction is left for the ripple of the speed, and a count of each sensor.
    assert!((stretch_mm - 0.41e-3).abs() < 0.04e-3 + 2.0 * rounding_mm + 0.1e-3, "{shown}");
    assert!((command_mm - motor_mm).abs() < 1.0, "{shown}");
    assert_eq!(row(&shown, "within"), [1.25, 0.25, 0.25]);
    // It is back at the command of the touch.
    assert!(shown.ends_with(&format!("x is at {command_mm:.4} mm.\n")), "{shown}");
    // A second touch of the same surface from 1 mm before it: within a tick of the first, and the rounding of both.
    board.succeeds("board jog --port bench --axis x --by-mm -1");
    let again = board.succeeds(PROBE);
    let again_mm = row(&again, "touched")[2];
    assert!((again_mm - scale_mm).abs() < 0.25e-3 + 0.05e-3 + 2.0 * rounding_mm, "{shown}{again}");
}

/// Beyond the surface, where the first probing leaves the axis, it is touched before the start.
#[test]
fn what_is_no_touch_is_named() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let missing = PROBE.replace("-mm 15", "-mm 1");
    let failed = board.fails(1, &missing);
    assert!(failed.contains("x: not probed: the probe was not touched within the distance"), "{failed}");
    let at = at_mm(&board.succeeds("board status --port bench"), "x ");
    assert!((at - 1.0).abs() < 1e-4, "{at} mm");
    board.succeeds("board bench add-workpiece");
    board.succeeds(PROBE);
    let failed = board.fails(1, PROBE);
    assert!(failed.contains("the probe is touched before the axis moves, or is not connected"), "{failed}");
    // A motion that a second program stops.
    board.succeeds("board jog --port bench --axis x --by-mm -11");
    let first = board.start(&PROBE.replace("mm-per-min 300", "mm-per-min 60"));
    sleep(Duration::from_secs(2));
    board.succeeds("board stop --port bench");
    let output = first.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && message.lines().count() == 1, "{message}");
    assert!(message.contains("stopped"), "{message}");
    // What the axis may not do, and what is no number.
    let failed = board.fails(1, &PROBE.replace("mm-per-min 300", "mm-per-min 8160"));
    assert!(failed.contains("x would exceed 8100 mm/min"), "{failed}");
    let failed = board.fails(1, &PROBE.replace("-mm 15", "-mm 201"));
    assert!(failed.contains("travel_m: 0.201 is above 0.2"), "{failed}");
    for (wrong, option) in [("-mm 0", "--distance-mm"), ("-mm nan", "--distance-mm")] {
        let failed = board.fails(2, &PROBE.replace("-mm 15", wrong));
        assert!(failed.contains(option), "{failed}");
    }
    let failed = board.fails(2, &PROBE.replace("mm-per-min 300", "mm-per-min 0"));
    assert!(failed.contains("--speed-mm-per-min: expected a number from 0.1 to 60000"), "{failed}");
}

/// Without the enable switch nothing moves; with the switch opened on the way, the drives go off and the probing has failed.
#[test]
fn it_needs_the_enable_switch() {
    let Some(board) = EmulatedBoard::new() else { return };
    let failed = board.fails(1, PROBE);
    assert!(failed.contains("the enable switch is open"), "{failed}");
    board.succeeds("board bench close-switch");
    let first = board.start(&PROBE.replace("mm-per-min 300", "mm-per-min 60"));
    sleep(Duration::from_secs(2));
    board.succeeds("board bench open-switch");
    let output = first.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && message.lines().count() == 1, "{message}");
    assert!(message.contains("the drives have gone off"), "{message}");
}
