//! The serial port of the link: 1 Mbaud, 8 data bits, no parity, one stop bit.
//!
//! Its interrupt moves bytes between the port and two queues, at a higher priority than the tick and in less than a microsecond:
//! a byte arrives every 10 µs, and the port holds one.

use heapless::spsc::{Consumer, Producer, Queue};
use shared::link::port::BytePort;

/// Capacity of a queue in bytes, plus one: several ticks of the port.
pub const QUEUE: usize = 512;

/// The queues of received and of waiting bytes.
pub type Queues = [Queue<u8, QUEUE>; 2];

/// What the port has received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Received {
    /// The byte.
    pub byte: Option<u8>,
    /// Whether an earlier byte was lost because the port was full.
    pub is_overrun: bool,
}

/// The registers of a serial port.
pub trait SerialRegisters {
    /// Takes what was received, and clears the flags of it.
    fn take(&mut self) -> Received;

    /// Whether a byte can be sent.
    fn can_send(&self) -> bool;

    /// Sends a byte.
    fn send(&mut self, byte: u8);

    /// Whether the interrupt is raised while a byte can be sent.
    fn set_sending_interrupt(&mut self, on: bool);

    /// Raises the interrupt of the port, from any context.
    fn pend();
}

/// The port, in its interrupt.
pub struct UartInterrupt<R> {
    registers: R,
    received: Producer<'static, u8>,
    waiting: Consumer<'static, u8>,
    /// Bytes that were lost because a queue or the port was full.
    lost: u32,
}

/// The port, between ticks.
pub struct Uart<R> {
    received: Consumer<'static, u8>,
    waiting: Producer<'static, u8>,
    registers: core::marker::PhantomData<R>,
}

/// The two sides of a port that was started.
pub fn split<R: SerialRegisters>(registers: R, queues: &'static mut Queues) -> (Uart<R>, UartInterrupt<R>) {
    let [received, waiting] = queues;
    let ((to_loop, from_port), (to_port, from_loop)) = (received.split(), waiting.split());
    let port = Uart { received: from_port, waiting: to_port, registers: core::marker::PhantomData };
    (port, UartInterrupt { registers, received: to_loop, waiting: from_loop, lost: 0 })
}

impl<R: SerialRegisters> BytePort for Uart<R> {
    fn read(&mut self) -> Option<u8> {
        self.received.dequeue()
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let taken = bytes.iter().take_while(|byte| self.waiting.enqueue(**byte).is_ok()).count();
        if taken > 0 {
            // The interrupt sends the first byte.
            R::pend();
        }
        taken
    }
}

impl<R: SerialRegisters> UartInterrupt<R> {
    /// Moves bytes between port and queues.
    pub fn service(&mut self) {
        let Received { byte, is_overrun } = self.registers.take();
        let is_dropped = byte.is_some_and(|byte| self.received.enqueue(byte).is_err());
        self.lost = self.lost.saturating_add(u32::from(is_overrun)).saturating_add(u32::from(is_dropped));
        // One or two bytes: the port has a data and a shift register. (An emulated port takes all.)
        while self.registers.can_send() {
            let Some(byte) = self.waiting.dequeue() else { break };
            self.registers.send(byte);
        }
        let more = self.waiting.ready();
        self.registers.set_sending_interrupt(more);
    }

    /// Bytes that were lost because a queue or the port was full.
    pub const fn lost(&self) -> u32 {
        self.lost
    }
}
