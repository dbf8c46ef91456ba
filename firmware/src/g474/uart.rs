//! The serial port of the link: USART3 at 1 Mbaud, 8 data bits, no parity, one stop bit.
//! What moves bytes between it and the link is in [`crate::two_drives::serial`].

use shared::link::port::BAUD;

use super::address::usart3;
use super::bus::{Bus, Line};
use super::clock::{CORE_HZ, Device};
use crate::two_drives::serial::{self, Queues, Received, SerialRegisters};

/// `USART_CR1` (chapter 37): on; receiver, transmitter; interrupts of a received byte, and of a free transmitter.
const ON: u32 = 1;
const BOTH_WAYS: u32 = 1 << 2 | 1 << 3;
const RECEIVED_INTERRUPT: u32 = 1 << 5;
const SENDING_INTERRUPT: u32 = 1 << 7;

/// `USART_ISR` (chapter 37): overrun, received, can send.
const OVERRUN: u32 = 1 << 3;
const RECEIVED: u32 = 1 << 5;
const CAN_SEND: u32 = 1 << 7;

/// The registers of the port.
#[derive(Clone, Copy, Debug)]
pub struct UartRegisters<B>(B);

/// The port, between ticks.
pub type Uart<B> = serial::Uart<UartRegisters<B>>;

/// The port, in its interrupt.
pub type UartInterrupt<B> = serial::UartInterrupt<UartRegisters<B>>;

/// Starts the port.
pub fn start<B: Bus>(bus: B, queues: &'static mut Queues) -> (Uart<B>, UartInterrupt<B>) {
    Device::USART3.restart(bus);
    bus.write(usart3::BRR, CORE_HZ / BAUD);
    bus.write(usart3::CR1, ON | BOTH_WAYS | RECEIVED_INTERRUPT);
    serial::split(UartRegisters(bus), queues)
}

impl<B: Bus> SerialRegisters for UartRegisters<B> {
    fn take(&mut self) -> Received {
        let status = self.0.read(usart3::ISR);
        let is_overrun = status & OVERRUN != 0;
        if is_overrun {
            self.0.write(usart3::ICR, OVERRUN);
        }
        // Reading the data clears the flag of the byte.
        #[expect(clippy::cast_possible_truncation, reason = "eight data bits")]
        let byte = (status & RECEIVED != 0).then(|| self.0.read(usart3::RDR) as u8);
        Received { byte, is_overrun }
    }

    fn can_send(&self) -> bool {
        self.0.read(usart3::ISR) & CAN_SEND != 0
    }

    fn send(&mut self, byte: u8) {
        self.0.write(usart3::TDR, u32::from(byte));
    }

    fn set_sending_interrupt(&mut self, on: bool) {
        self.0.set_field(usart3::CR1, SENDING_INTERRUPT, if on { SENDING_INTERRUPT } else { 0 });
    }

    fn pend() {
        B::pend(Line::Usart3);
    }
}
