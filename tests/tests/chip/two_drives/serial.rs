//! The serial port: what is sent and received by way of its queues, and what is lost.

use std::cell::{Cell, RefCell};

use firmware::two_drives::serial::{QUEUE, Received, SerialRegisters, Uart, UartInterrupt, split};
use shared::link::port::BytePort;

thread_local! {
    /// How often the interrupt was raised.
    static PENDED: Cell<u32> = const { Cell::new(0) };
}

#[derive(Default)]
struct State {
    received: Received,
    /// Bytes that the port takes until the next interrupt.
    room: usize,
    sent: Vec<u8>,
    interrupts: Vec<bool>,
}

#[derive(Clone, Copy)]
struct Port(&'static RefCell<State>);

impl SerialRegisters for Port {
    fn take(&mut self) -> Received {
        std::mem::take(&mut self.0.borrow_mut().received)
    }

    fn can_send(&self) -> bool {
        self.0.borrow().room > 0
    }

    fn send(&mut self, byte: u8) {
        let mut state = self.0.borrow_mut();
        state.room -= 1;
        state.sent.push(byte);
    }

    fn set_sending_interrupt(&mut self, on: bool) {
        self.0.borrow_mut().interrupts.push(on);
    }

    fn pend() {
        PENDED.set(PENDED.get() + 1);
    }
}

fn started() -> (Port, Uart<Port>, UartInterrupt<Port>) {
    let port = Port(Box::leak(Box::default()));
    let queues = Box::leak(Box::new([const { heapless::spsc::Queue::new() }; 2]));
    let (uart, interrupt) = split(port, queues);
    (port, uart, interrupt)
}

/// Two bytes at a time, as the port has two registers; the interrupt stays on while more are waiting. It is raised for the first byte, and not for none.
#[test]
fn bytes_are_sent_in_order_while_the_port_takes_them() {
    let (port, mut uart, mut interrupt) = started();
    PENDED.set(0);
    assert_eq!((uart.write(&[]), PENDED.get()), (0, 0));
    assert_eq!((uart.write(&[1, 2, 3]), PENDED.get()), (3, 1));
    for (sent, more) in [(&[1, 2][..], true), (&[1, 2, 3], false)] {
        port.0.borrow_mut().room = 2;
        interrupt.service();
        let state = port.0.borrow();
        assert_eq!((&state.sent[..], state.interrupts.last()), (sent, Some(&more)));
    }
    // A queue holds one less than its length.
    assert_eq!(uart.write(&[7; QUEUE + 1]), QUEUE - 1);
    assert_eq!(interrupt.lost(), 0);
}

/// An overrun of the port and a byte for which the queue has no place count as lost, each once.
#[test]
fn lost_bytes_are_counted() {
    let (port, mut uart, mut interrupt) = started();
    let mut receive = |byte, is_overrun| {
        port.0.borrow_mut().received = Received { byte, is_overrun };
        interrupt.service();
        interrupt.lost()
    };
    assert_eq!([receive(None, false), receive(Some(9), false), receive(Some(8), true)], [0, 0, 1]);
    assert_eq!([uart.read(), uart.read(), uart.read()], [Some(9), Some(8), None]);
    assert!((1..QUEUE).all(|_| receive(Some(7), false) == 1));
    assert_eq!([receive(Some(6), false), receive(Some(6), true)], [2, 4]);
}
