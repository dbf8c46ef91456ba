//! The serial port of the link: USART3 at 1 Mbaud, 8 data bits, no parity, one stop bit.
//! What moves bytes between it and the link is in [`crate::two_drives::serial`].

use shared::link::port::BAUD;
use stm32f4xx_hal::gpio::{Alternate, PB10, PB11};
use stm32f4xx_hal::pac::USART3;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::two_drives::serial::{self, Queues, Received, SerialRegisters};

/// Transmitter and receiver.
pub type UartPins = (PB10<Alternate<7>>, PB11<Alternate<7>>);

/// The registers of the port.
pub struct UartRegisters(USART3);

/// The port, between ticks.
pub type Uart = serial::Uart<UartRegisters>;

/// The port, in its interrupt.
pub type UartInterrupt = serial::UartInterrupt<UartRegisters>;

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
    serial::split(UartRegisters(uart), queues)
}

impl SerialRegisters for UartRegisters {
    fn take(&mut self) -> Received {
        let status = self.0.sr().read();
        let is_overrun = status.ore().bit_is_set();
        // Reading the data clears both flags.
        #[expect(clippy::cast_possible_truncation, reason = "eight data bits")]
        let byte = (status.rxne().bit_is_set() || is_overrun).then(|| self.0.dr().read().dr().bits() as u8);
        Received { byte, is_overrun }
    }

    fn can_send(&self) -> bool {
        self.0.sr().read().txe().bit_is_set()
    }

    fn send(&mut self, byte: u8) {
        // SAFETY: eight data bits.
        self.0.dr().write(|w| unsafe { w.dr().bits(u16::from(byte)) });
    }

    fn set_sending_interrupt(&mut self, on: bool) {
        self.0.cr1().modify(|_, w| w.txeie().bit(on));
    }

    fn pend() {
        rtic::pend(stm32f4xx_hal::pac::Interrupt::USART3);
    }
}
