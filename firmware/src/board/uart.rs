//! The serial port of the link: USART3 at 1 Mbaud, 8 data bits, no parity, one stop bit.
//!
//! Its interrupt moves bytes between the port and two queues, at a higher priority than the tick and in less than a microsecond:
//! a byte arrives every 10 µs, and the port holds one.

use heapless::spsc::{Consumer, Producer, Queue};
use shared::link::port::{BAUD, BytePort};
use stm32f4xx_hal::gpio::{Alternate, PB10, PB11};
use stm32f4xx_hal::pac::USART3;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Capacity of a queue in bytes, plus one: several ticks of the port.
pub const QUEUE: usize = 512;

/// The queues of received and of waiting bytes.
pub type Queues = [Queue<u8, QUEUE>; 2];

/// Transmitter and receiver.
pub type UartPins = (PB10<Alternate<7>>, PB11<Alternate<7>>);

/// The port, in its interrupt.
pub struct UartInterrupt {
    uart: USART3,
    received: Producer<'static, u8>,
    waiting: Consumer<'static, u8>,
    /// Bytes that were lost because a queue or the port was full.
    lost: u32,
}

/// The port, between ticks.
pub struct Uart {
    received: Consumer<'static, u8>,
    waiting: Producer<'static, u8>,
}

/// Starts the port.
pub fn start(
    uart: USART3,
    _pins: UartPins,
    queues: &'static mut Queues,
    rcc: &mut Rcc,
) -> (Uart, UartInterrupt) {
    USART3::enable(rcc);
    USART3::reset(rcc);
    let divider = u16::try_from(rcc.clocks.pclk1().raw() / BAUD).unwrap_or(u16::MAX);
    // SAFETY: 42 MHz / 1 MBd = 42 sixteenths.
    uart.brr().write(|w| unsafe { w.bits(divider) });
    uart.cr1().write(|w| w.ue().set_bit().te().set_bit().re().set_bit().rxneie().set_bit());
    let [received, waiting] = queues;
    let ((to_host_loop, from_port), (to_port, from_loop)) = (received.split(), waiting.split());
    let port = Uart { received: from_port, waiting: to_port };
    (port, UartInterrupt { uart, received: to_host_loop, waiting: from_loop, lost: 0 })
}

impl BytePort for Uart {
    fn read(&mut self) -> Option<u8> {
        self.received.dequeue()
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let taken = bytes.iter().take_while(|byte| self.waiting.enqueue(**byte).is_ok()).count();
        if taken > 0 {
            // The interrupt sends the first byte.
            rtic::pend(stm32f4xx_hal::pac::Interrupt::USART3);
        }
        taken
    }
}

impl UartInterrupt {
    /// Moves bytes between port and queues.
    pub fn service(&mut self) {
        let status = self.uart.sr().read();
        if status.ore().bit_is_set() {
            self.lost = self.lost.saturating_add(1);
        }
        if status.rxne().bit_is_set() || status.ore().bit_is_set() {
            // Reading the data clears both flags.
            #[expect(clippy::cast_possible_truncation, reason = "eight data bits")]
            let byte = self.uart.dr().read().dr().bits() as u8;
            if self.received.enqueue(byte).is_err() {
                self.lost = self.lost.saturating_add(1);
            }
        }
        // One or two bytes: the port has a data and a shift register. (An emulated port takes all.)
        while self.uart.sr().read().txe().bit_is_set() {
            let Some(byte) = self.waiting.dequeue() else { break };
            // SAFETY: eight data bits.
            self.uart.dr().write(|w| unsafe { w.dr().bits(u16::from(byte)) });
        }
        let more = self.waiting.ready();
        self.uart.cr1().modify(|_, w| w.txeie().bit(more));
    }
}
