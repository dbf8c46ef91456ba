//! The interrupts of both ports: what they send while the device takes it, and what they count as lost.

use firmware::g474::bus::Line;
use firmware::setup::CAN_TO_BOARD;
use firmware::two_drives::serial::QUEUE;
use shared::link::Request;
use shared::link::can_frames::CanFrame;

use super::board::{Board, Port};
use super::model::PENDED;

/// Control, state and clear of USART3; the bits of what can be sent, of an overrun, and of the interrupt of the former (chapter 37).
const CR1: u32 = 0x4000_4800;
const ISR: u32 = 0x4000_481c;
const ICR: u32 = 0x4000_4820;
const CAN_SEND: u32 = 1 << 7;
const OVERRUN: u32 = 1 << 3;

/// A port that takes no byte raises an interrupt when it does, and none when there are no more. A reply raises the interrupt of its port.
#[test]
fn bytes_wait_until_the_port_takes_them() {
    let mut board = Board::enabled(Port::Serial);
    let idle = board.model.word(ISR);
    board.model.set(ISR, idle & !CAN_SEND);
    PENDED.with_borrow_mut(Vec::clear);
    board.send(&Request::Status);
    board.ticks(20);
    assert!(board.host.replies.is_empty() && board.model.word(CR1) & CAN_SEND != 0);
    assert!(
        PENDED
            .with_borrow(|lines| lines.iter().all(|line| matches!(line, Line::Usart3)) && !lines.is_empty())
    );
    board.model.set(ISR, idle);
    board.ticks(20);
    assert_eq!((board.host.replies.len(), board.model.word(CR1) & CAN_SEND), (1, 0));
}

/// An overrun is counted and cleared. Without a byte nothing is read: more interrupts than the queue has places lose none.
#[test]
fn an_overrun_is_counted_and_cleared() {
    let mut board = Board::start(Port::Serial);
    (0..=QUEUE).for_each(|_| board.parts.serial.service());
    assert_eq!((board.parts.serial.lost(), board.model.written(ICR)), (0, Vec::new()));
    let idle = board.model.word(ISR);
    board.model.set(ISR, idle | OVERRUN);
    board.parts.serial.service();
    assert_eq!((board.parts.serial.lost(), board.model.written(ICR)), (1, vec![OVERRUN]));
}

/// The queue holds eight frames: of nine that nobody takes, one is lost.
#[test]
fn a_frame_without_a_place_is_counted() {
    let mut board = Board::start(Port::Can);
    let (frame, _) = CanFrame::of_stream(&[1, 2, 3]).unwrap();
    for _ in 0..9 {
        assert!(board.model.with(|state| state.can.receive(u32::from(CAN_TO_BOARD), &frame)));
        board.parts.can.service();
    }
    assert_eq!(board.parts.can.lost(), 1);
}
