//! The bus of the chip.

use stm32g4::stm32g474::Interrupt;

use super::bus::{Bus, Line};
use super::clock::CORE_HZ;

/// The registers at their addresses.
#[derive(Clone, Copy, Debug)]
pub struct Chip(());

impl Chip {
    /// Access to all registers.
    ///
    /// # Safety
    /// What the registers do to the memory of the program is up to the caller: nobody else may configure these devices.
    #[must_use]
    pub const unsafe fn new() -> Self {
        Self(())
    }
}

impl Bus for Chip {
    fn read(self, address: u32) -> u32 {
        // SAFETY: the condition of `Chip::new`; an address of a register, or of the flash.
        unsafe { core::ptr::with_exposed_provenance::<u32>(address as usize).read_volatile() }
    }

    fn write(self, address: u32, value: u32) {
        // SAFETY: the condition of `Chip::new`; an address of a register, or of the slots of the flash, which contain no variable.
        unsafe { core::ptr::with_exposed_provenance_mut::<u32>(address as usize).write_volatile(value) }
    }

    fn wait_us(self, us: u32) {
        cortex_m::asm::delay(us * (CORE_HZ / 1_000_000));
    }

    fn pend(line: Line) {
        rtic::pend(match line {
            Line::Usart3 => Interrupt::USART3,
            Line::Fdcan1 => Interrupt::FDCAN1_IT0,
        });
    }
}
