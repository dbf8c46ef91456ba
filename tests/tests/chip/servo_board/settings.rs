//! Settings in the flash of the board: they outlive it.

use std::fs;

use super::emulated_board::EmulatedBoard;

/// A machine file of the bench with another travel of x.
fn write_machine(board: &EmulatedBoard) {
    let machine = fs::read_to_string(EmulatedBoard::file("host-sim/machines/bench.toml")).unwrap();
    let narrow = machine.replacen("travel_mm = [-100.0, 100.0]", "travel_mm = [-60.0, 60.0]", 1);
    assert_ne!(narrow, machine);
    fs::write(board.path().join("narrow.toml"), narrow).unwrap();
}

fn settings_line(board: &EmulatedBoard) -> String {
    let status = board.succeeds("board status --port bench");
    status.lines().find(|line| line.starts_with("settings:")).unwrap().to_owned()
}

/// A jog over the end of the narrow travel, after homing: refused with the saved settings, and by name.
fn is_narrow(board: &EmulatedBoard) -> bool {
    board.succeeds("board bench open-switch");
    board.succeeds("board bench close-switch");
    board.succeeds("board home --port bench --axis x");
    let output = board.run("board jog --port bench --axis x --by-mm 155 --speed-mm-per-min 6000");
    let refused = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() || refused.contains("leads out of the travel"), "{refused}");
    board.succeeds("board disable --port bench");
    !output.status.success()
}

#[test]
fn saved_settings_outlive_the_board_and_uploaded_ones_do_not() {
    let Some(board) = EmulatedBoard::new() else { return };
    write_machine(&board);
    assert_eq!(settings_line(&board), "settings: of its program; nothing is saved in flash");
    board.succeeds("board upload --port bench --machine narrow.toml");
    assert_eq!(settings_line(&board), "settings: uploaded, not saved; nothing is saved in flash");
    board.succeeds("board bench end");
    assert_eq!(settings_line(&board), "settings: of its program; nothing is saved in flash");
    assert!(!is_narrow(&board));
    board.succeeds("board upload --port bench --machine narrow.toml --save");
    assert_eq!(settings_line(&board), "settings: saved; save 1 is in flash");
    board.succeeds("board bench end");
    assert_eq!(settings_line(&board), "settings: saved; save 1 is in flash");
    assert!(is_narrow(&board));
    // Off after a start: a saved state does not move anything.
    board.succeeds("board bench end");
    let refused = board.fails(1, "board enable --port bench");
    assert!(refused.contains("the enable switch is open"), "{refused}");
    board.succeeds("board bench erase-flash");
    assert_eq!(settings_line(&board), "settings: of its program; nothing is saved in flash");
}

#[test]
fn a_save_with_the_drives_on_is_refused() {
    let Some(board) = EmulatedBoard::armed() else { return };
    write_machine(&board);
    board.succeeds("board enable --port bench");
    let refused = board.fails(1, "board upload --port bench --machine narrow.toml --save");
    assert!(refused.contains("the drives are on"), "{refused}");
    board.succeeds("board disable --port bench");
    board.succeeds("board upload --port bench --machine narrow.toml --save");
}

/// A flash with damaged records: a fault by name, which has to be acknowledged.
#[test]
fn a_damaged_flash_is_a_fault_by_name() {
    let Some(board) = EmulatedBoard::new() else { return };
    write_machine(&board);
    board.succeeds("board upload --port bench --machine narrow.toml --save");
    board.succeeds("board bench end");
    let path = board.path().join("run").join("flash");
    let mut flash = fs::read(&path).unwrap();
    assert_eq!(flash.len(), 2 * 128 * 1024);
    flash[40] ^= 1;
    fs::write(&path, flash).unwrap();
    let line = settings_line(&board);
    let reasons = "(first slot: the checksum differs; second slot: nothing is stored)";
    assert_eq!(line, format!("settings: of its program; nothing in flash can be used {reasons}"));
    board.succeeds("board bench close-switch");
    let refused = board.fails(1, "board enable --port bench");
    assert!(refused.contains("the settings in flash cannot be used"), "{refused}");
    board.succeeds("board clear --port bench");
    board.succeeds("board enable --port bench");
}
