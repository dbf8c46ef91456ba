//! The emulated board with four axes: x, y, z and u are homed, jogged, moved together, shown, recorded and stopped together; what is for
//! another number of axes is refused.

use super::emulated_board::EmulatedBoard;

const AXES: [&str; 4] = ["x", "y", "z", "u"];

/// A board of four axes, with the enable switch closed.
fn armed() -> Option<EmulatedBoard> {
    let board = EmulatedBoard::new()?;
    board.succeeds("board bench start-four");
    board.succeeds("board bench close-switch");
    Some(board)
}

fn path(name: &str) -> String {
    EmulatedBoard::file(name).display().to_string()
}

/// The columns of an axis in a status.
fn columns<'s>(status: &'s str, axis: &str) -> Vec<&'s str> {
    let line = status.lines().find(|line| line.starts_with(&format!("{axis} "))).unwrap();
    line.split_whitespace().collect()
}

#[test]
fn four_axes_are_homed_and_moved_together() {
    let Some(board) = armed() else { return };
    let machine = path("host-sim/machines/bench_four.toml");
    board.succeeds(&format!("board upload --port bench --machine {machine}"));
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("4 axes, 20000 ticks per second"), "{status}");
    let motion = path("host-sim/motions/bench_four.toml");
    let record = format!("record --port bench --machine {machine} --motion {motion} --out out.csv --yes");
    let refused = board.fails(1, &record);
    assert!(refused.contains("it has to be homed"), "{refused}");
    for axis in AXES {
        board.succeeds(&format!("board home --port bench --axis {axis}"));
        board.succeeds(&format!("board jog --port bench --axis {axis} --by-mm 91.7 --speed-mm-per-min 6000"));
    }
    let status = board.succeeds("board status --port bench");
    for axis in AXES {
        let columns = columns(&status, axis);
        // The index pulse of the reference is at −91.7 mm.
        assert!(columns[1].parse::<f64>().unwrap().abs() < 0.02, "{status}");
        assert!(columns.last() == Some(&"homed") && !status.contains("not homed"), "{status}");
    }
    let recorded = board.succeeds(&record);
    for axis in AXES {
        assert!(recorded.lines().any(|line| line.starts_with(&format!("{axis} "))), "{recorded}");
    }
    // Each axis is where the blocks have it: its command is at the corners, and its motor near them.
    let log = files::log::Log::read(&board.path().join("out.csv")).unwrap();
    assert_eq!(log.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>(), AXES);
    for (axis, [least, greatest]) in log.axes.iter().zip([[0.0, 8.0], [0.0, 9.0], [-4.0, 3.0], [-5.0, 5.0]]) {
        for channel in [files::log::Channel::Command, files::log::Channel::Motor] {
            let mm = axis.channel(channel).unwrap();
            let ends = [mm.iter().copied().fold(0.0, f64::min), mm.iter().copied().fold(0.0, f64::max)];
            let near =
                ends.iter().zip([least, greatest]).all(|(end, expected)| (end - expected).abs() < 0.05);
            assert!(near, "{} {channel:?}: {ends:?}", axis.name);
        }
    }
    let monitor = board.succeeds("board monitor --port bench --lines 1");
    assert!(AXES.iter().all(|axis| monitor.contains(&format!("{axis} "))), "{monitor}");
}

/// z is jogged onto its limit switch: it is not homed, so that no soft limit holds it. The fault is named, and every axis is off.
#[test]
fn a_fault_of_the_third_and_of_the_fourth_axis_stops_all_by_name() {
    let Some(board) = armed() else { return };
    for axis in ["z", "u"] {
        let failed = board
            .fails(1, &format!("board jog --port bench --axis {axis} --by-mm 160 --speed-mm-per-min 6000"));
        assert!(failed.contains(&format!("{axis}: ")), "{failed}");
        let status = board.status_with(&["off by a fault"]);
        assert!(status.contains(&format!("off by a fault: {axis}: ")), "{status}");
        for other in AXES {
            assert_eq!(columns(&status, other)[4], "0.0", "{status}");
            let refused = board.fails(1, &format!("board jog --port bench --axis {other} --by-mm 1"));
            assert!(refused.contains("`board clear` acknowledges it"), "{refused}");
        }
        board.succeeds("board clear --port bench");
        board.succeeds(&format!("board jog --port bench --axis {axis} --by-mm -20"));
    }
}

/// By one line with the file, before anything is erased or moved.
#[test]
fn a_machine_of_another_number_of_axes_is_refused() {
    let Some(board) = armed() else { return };
    let two = path("host-sim/machines/bench.toml");
    let four = path("host-sim/machines/bench_four.toml");
    let refused = board.fails(2, &format!("board upload --port bench --machine {two} --save"));
    assert_eq!(
        refused,
        format!("lost-motion: {two}: axis: expected 4 axes, as the board has (x, y, z, u), found 2")
    );
    let motion = path("host-sim/motions/bench_travel.toml");
    let refused = board.fails(2, &format!("record --port bench --motion {motion} --out out.csv --yes"));
    assert!(refused.contains("machines/bench.toml: axis: expected 4 axes"), "{refused}");
    board.succeeds("board bench end");
    let refused = board.fails(2, &format!("board upload --port bench --machine {four} --save"));
    assert_eq!(
        refused,
        format!("lost-motion: {four}: axis: expected 2 axes, as the board has (x, y), found 4")
    );
    let refused = board.fails(2, "board home --port bench --axis u");
    assert_eq!(refused, "lost-motion: --axis: expected x or y (the axes of the board), found \"u\"");
}

/// What a board of two axes has saved is not for one of four: a fault, and the settings of the program.
#[test]
fn a_record_of_another_number_of_axes_is_a_fault() {
    let Some(board) = EmulatedBoard::new() else { return };
    board.succeeds(&format!(
        "board upload --port bench --machine {} --save",
        path("host-sim/machines/bench.toml")
    ));
    board.succeeds("board bench end");
    board.succeeds("board bench start-four");
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("off by a fault") && status.contains("of its program"), "{status}");
}
