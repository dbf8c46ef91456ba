//! What the table of the board does not use, or only for a moment: analogue outputs, brakes, the time of a tick, the cut.

use firmware::g474::stage::cut;
use shared::drive::{Board as _, DriveSignal};

use super::board::{Board, Port};
use super::model::GPIOD;

/// Data of both channels of the DAC.
const DHR12R1: u32 = 0x5000_0808;
const DHR12R2: u32 = 0x5000_0814;
const CYCLE_COUNTER: u32 = 0xe000_1004;

fn are_brakes_open(board: &Board) -> bool {
    board.model.word(GPIOD + 0x14) >> 2 & 1 == 1
}

#[test]
fn analogue_outputs_are_those_of_their_axis() {
    let mut board = Board::start(Port::Serial);
    // Beyond twelve bits the greatest count.
    board.parts.hardware.set_signals([DriveSignal::Analog(3000), DriveSignal::Analog(5000)]);
    assert_eq!([DHR12R1, DHR12R2].map(|address| board.model.word(address)), [3000, 4095]);
}

/// The brakes follow the program, and close with the cut, which also switches the outputs off and sets 0 V.
#[test]
fn the_cut_switches_off_what_is_on() {
    let mut board = Board::enabled(Port::Serial);
    for open in [true, false, true] {
        board.parts.hardware.set_brakes_open(open);
        assert_eq!(are_brakes_open(&board), open);
    }
    board.parts.hardware.set_signals([DriveSignal::Analog(3000), DriveSignal::Analog(1000)]);
    cut(board.model);
    // 0 V behind the stage.
    assert_eq!([DHR12R1, DHR12R2].map(|address| board.model.word(address)), [2048; 2]);
    assert_eq!((board.outputs(), are_brakes_open(&board)), ([false; 2], false));
}

#[test]
fn a_tick_has_the_time_of_its_start() {
    let mut board = Board::start(Port::Serial);
    for cycles in [77_000, 85_500] {
        board.model.set(CYCLE_COUNTER, cycles);
        board.parts.hardware.begin_tick();
        board.model.set(CYCLE_COUNTER, 0);
        assert_eq!(board.parts.hardware.started_at(), Some(cycles));
    }
}
