//! A CMSDK UART (ARM DDI 0479) of the emulated board.

use core::ptr;

use shared::link::BytePort;

/// The registers, as words from the base address.
const DATA: usize = 0;
const STATE: usize = 1;
const CONTROL: usize = 2;
const INTERRUPT: usize = 3;
const BAUD_DIVIDER: usize = 4;

/// Bits of `STATE`.
const TRANSMIT_FULL: u32 = 1;
const RECEIVE_FULL: u32 = 2;

/// Bits of `CONTROL`: transmitter, receiver, interrupt of the receiver.
const ENABLE: u32 = 1 | 2 | 8;

/// Interrupt of the receiver in `INTERRUPT`, cleared by writing it.
const RECEIVED: u32 = 2;

/// 25 MHz over the least divider that the UART accepts: as fast as it can be.
const LEAST_DIVIDER: u32 = 16;

/// One UART.
pub struct Uart(*mut u32);

impl Uart {
    /// UART0, the link.
    ///
    /// # Safety
    /// To be called once: the registers are used without a lock.
    #[must_use]
    pub unsafe fn link() -> Self {
        Self::start(0x4000_4000)
    }

    /// UART1, the bench.
    ///
    /// # Safety
    /// To be called once: the registers are used without a lock.
    #[must_use]
    pub unsafe fn bench() -> Self {
        Self::start(0x4000_5000)
    }

    fn start(base: usize) -> Self {
        let uart = Self(ptr::with_exposed_provenance_mut(base));
        uart.set(BAUD_DIVIDER, LEAST_DIVIDER);
        uart.set(CONTROL, ENABLE);
        uart
    }

    fn set(&self, register: usize, value: u32) {
        // SAFETY: a register of the UART.
        unsafe { self.0.add(register).write_volatile(value) }
    }

    fn get(&self, register: usize) -> u32 {
        // SAFETY: a register of the UART.
        unsafe { self.0.add(register).read_volatile() }
    }
}

impl BytePort for Uart {
    fn read(&mut self) -> Option<u8> {
        if self.get(STATE) & RECEIVE_FULL == 0 {
            return None;
        }
        self.set(INTERRUPT, RECEIVED);
        #[expect(clippy::cast_possible_truncation, reason = "eight bits")]
        let byte = self.get(DATA) as u8;
        Some(byte)
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let mut written = 0;
        for byte in bytes {
            if self.get(STATE) & TRANSMIT_FULL != 0 {
                break;
            }
            self.set(DATA, u32::from(*byte));
            written += 1;
        }
        written
    }
}
