//! An emulated board that nobody uses: it takes little of the computer, and its time goes on.

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::emulated_board::EmulatedBoard;

/// Clock ticks per second of the times of a process (`getconf CLK_TCK`).
const CLOCK_HZ: f64 = 100.0;

/// Largest share of a core of an emulator whose board waits.
const MOST_IDLE: f64 = 0.15;

/// Processor time of the emulator of a board, s.
fn processor_s(board: &EmulatedBoard) -> f64 {
    let run = board.path().join("run").canonicalize().unwrap();
    let ids =
        fs::read_dir("/proc").unwrap().flatten().filter_map(|entry| entry.file_name().into_string().ok());
    let of_board = |id: &String| {
        let folder = fs::read_link(format!("/proc/{id}/cwd")).ok();
        let name = fs::read_to_string(format!("/proc/{id}/comm")).unwrap_or_default();
        folder.is_some_and(|folder| folder == run) && name.starts_with("qemu")
    };
    let id = ids.into_iter().find(of_board).expect("the emulator runs");
    let stat = fs::read_to_string(format!("/proc/{id}/stat")).unwrap();
    // Behind the name: the times of the process are fields 14 and 15 of all.
    let fields: Vec<&str> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
    let ticks: f64 = fields[11..13].iter().map(|ticks| ticks.parse::<f64>().unwrap()).sum();
    ticks / CLOCK_HZ
}

/// Time of the board, s.
fn board_s(board: &EmulatedBoard) -> f64 {
    let line = board.succeeds("board monitor --port bench --lines 1");
    line.split(" s:").next().unwrap().parse().unwrap()
}

/// Share of a core that the emulator takes during so many seconds.
fn share_of_a_core(board: &EmulatedBoard, seconds: u8) -> f64 {
    let before = processor_s(board);
    sleep(Duration::from_secs(seconds.into()));
    (processor_s(board) - before) / f64::from(seconds)
}

/// Waits for a silent board to switch its drives off: 10 s of its own time, which is six times as long on a computer that emulates
/// every tick at a sixth of their speed. Panics if it never takes less of a core.
fn wait_until_idle(board: &EmulatedBoard) {
    let start = Instant::now();
    while share_of_a_core(board, 1) > MOST_IDLE {
        assert!(start.elapsed() < Duration::from_mins(1), "{} of a core", share_of_a_core(board, 1));
    }
}

/// Before, it took 0.64 of a core of a busy computer. With drives that were on when the host went, too: they are off after 10 s.
#[test]
fn a_board_that_nobody_uses_takes_little_of_the_computer() {
    let Some(board) = EmulatedBoard::armed() else { return };
    board.succeeds("board enable --port bench");
    sleep(Duration::from_secs(1));
    let busy = processor_s(&board);
    sleep(Duration::from_secs(2));
    // With the drives on every tick is run.
    assert!(processor_s(&board) - busy > 0.3, "{}", processor_s(&board) - busy);
    wait_until_idle(&board);
    let (start_s, started) = (board_s(&board), Instant::now());
    sleep(Duration::from_secs(1));
    let share = share_of_a_core(&board, 3);
    println!("{share} of a core");
    assert!(share < MOST_IDLE, "{share} of a core");
    // Its time has gone on: of the emulator, which a busy computer runs more slowly.
    let ratio = (board_s(&board) - start_s) / started.elapsed().as_secs_f64();
    assert!((0.7..1.1).contains(&ratio), "{ratio}");
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("drives: off; the enable switch permits an enable"), "{status}");
    assert!(status.contains("s ago: the host was silent while the axes stood: drives off"), "{status}");
    // No fault has to be acknowledged.
    board.succeeds("board jog --port bench --axis x --by-mm 1");
}
