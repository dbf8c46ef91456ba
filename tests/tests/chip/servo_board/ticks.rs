//! Ticks of the emulated board that are late or missed: counted, shown, and a fault.

use super::emulated_board::EmulatedBoard;

/// Late ticks and missed ticks, and the longest delay in µs if it is at least half a period, as `board status` shows them.
fn ticks(board: &EmulatedBoard) -> ([u32; 2], Option<f64>) {
    let status = board.succeeds("board status --port bench");
    let line = status.lines().find_map(|line| line.strip_prefix("ticks with the stages on: ")).unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    let delay_us = words.iter().find_map(|word| word.parse().ok().filter(|_| word.contains('.')));
    ([0, 2].map(|word: usize| words[word].parse().unwrap()), delay_us)
}

/// Makes something with the ticks while the drives are on, which go off by the fault.
fn overrun(action: &str) -> Option<EmulatedBoard> {
    let board = EmulatedBoard::armed()?;
    board.succeeds("board enable --port bench");
    board.succeeds(&format!("board bench {action}"));
    let status = board.status_with(&["drives: off by a fault: overrun"]);
    assert!(status.contains("s ago: fault: overrun"), "{status}");
    Some(board)
}

/// The fault comes with the slow tick itself, so that the drives are off in the next one, which is not counted.
#[test]
fn a_tick_that_takes_longer_than_its_period_is_late_and_switches_the_drives_off() {
    let Some(board) = overrun("slow-tick") else { return };
    assert_eq!(ticks(&board).0, [1, 0]);
    let line = board.succeeds("board monitor --port bench --lines 1");
    assert!(line.trim_end().ends_with("; 1 ticks late, 0 missed"), "{line}");
    board.succeeds("board clear --port bench");
    board.succeeds("board jog --port bench --axis y --by-mm 1");
    assert_eq!(ticks(&board).0, [1, 0]);
}

/// The interrupts are held off for two periods from behind a tick on. One of the two ticks that are due meanwhile is lost; the other one
/// starts after at least one period, and less than two.
#[test]
fn a_tick_whose_interrupt_is_lost_is_missed_and_switches_the_drives_off() {
    let Some(board) = overrun("hold-off-ticks") else { return };
    let (counts, delay_us) = ticks(&board);
    assert_eq!(counts, [0, 1]);
    assert!(delay_us.is_some_and(|us| (50.0..=100.0).contains(&us)), "{delay_us:?} µs");
}

/// The server plans the blocks of a motion while the axes move, which takes longer than a tick: each tick preempts it, and starts within
/// half a period.
#[test]
fn each_tick_preempts_the_server() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let motion = board.at_start_of_travel();
    let machine = EmulatedBoard::file("host-sim/machines/bench.toml").display().to_string();
    let files = format!("--machine {machine} --motion {motion} --out log.csv");
    board.succeeds(&format!("record --port bench {files} --yes"));
    assert_eq!(ticks(&board), ([0, 0], None));
}
