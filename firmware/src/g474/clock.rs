//! The clock with its supervision, and the cause of the last reset.

use shared::safety::Fault;

use super::address::{flash, pwr, rcc};
use super::bus::Bus;
use crate::setup;

/// Clock of the core and of all buses and timers, Hz.
pub const CORE_HZ: u32 = 170_000_000;

/// Clock at the input of the PLL, Hz: the crystal, divided (chapter 7: 2.66 to 16 MHz).
const PLL_INPUT_HZ: u32 = 4_000_000;
/// Its divider, 1 to 16.
const DIVIDER: u32 = setup::CRYSTAL_HZ / PLL_INPUT_HZ;
/// Its multiplier, 8 to 127: the oscillator has twice the clock of the core, which PLLR divides.
const MULTIPLIER: u32 = 2 * CORE_HZ / PLL_INPUT_HZ;
const _: () = assert!(DIVIDER * PLL_INPUT_HZ == setup::CRYSTAL_HZ && DIVIDER >= 1 && DIVIDER <= 16);
const _: () = assert!(MULTIPLIER * PLL_INPUT_HZ == 2 * CORE_HZ && MULTIPLIER >= 8 && MULTIPLIER <= 127);

/// Bits of `RCC_CR` (chapter 7).
const CRYSTAL_ON: u32 = 1 << 16;
const CRYSTAL_READY: u32 = 1 << 17;
const CLOCK_SECURITY: u32 = 1 << 19;
const PLL_ON: u32 = 1 << 24;
const PLL_READY: u32 = 1 << 25;

/// `RCC_PLLCFGR` (chapter 7): from the crystal, output R divided by two.
const PLL: u32 = 3 | (DIVIDER - 1) << 4 | MULTIPLIER << 8 | 1 << 24;

/// Fields of `RCC_CFGR` (chapter 7): the source of the clock and which one it is; the divider of the core, halved for the change to more than
/// 80 MHz.
const SOURCE: u32 = 0b11;
const SOURCE_PLL: u32 = 0b11;
const SOURCE_STATE: u32 = 0b11 << 2;
const CORE_DIVIDER: u32 = 0b1111 << 4;
const HALVED: u32 = 0b1000 << 4;

/// `PWR_CR5` (chapter 6): without the boost, which 150 to 170 MHz need.
const NO_BOOST: u32 = 1 << 8;

/// `FLASH_ACR` (chapter 3): four wait states, which 170 MHz need with the boost; prefetch, both caches. The access of
/// a debugger stays as it is.
const LATENCY: u32 = 0b1111;
const WAIT_STATES: u32 = 4;
const ACCESS: u32 = WAIT_STATES | 1 << 8 | 1 << 9 | 1 << 10;

/// Flags of `RCC_CSR` (chapter 7): clear them; reset by either watchdog.
const CLEAR: u32 = 1 << 23;
const WATCHDOGS: u32 = 1 << 29 | 1 << 30;

/// Flag of `RCC_CIFR` (chapter 7): the crystal has failed.
const CRYSTAL_FAILED: u32 = 1 << 8;

/// Sets the clock to 170 MHz from the crystal, with the clock security system on: a failure of the crystal stops the PWM by the break of
/// its timer and raises the NMI, instead of slowing down the ticks together with the watchdog feeding.
///
/// Waits for the crystal. To be called with the power stages off and the clock of [`pwr`] enabled.
pub fn set_up(bus: impl Bus) {
    bus.set_bits(rcc::CR, CRYSTAL_ON);
    bus.wait_for(rcc::CR, CRYSTAL_READY, CRYSTAL_READY);
    // The order of chapter 6: halve the core, boost, wait states, clock, and after a microsecond the whole core.
    bus.set_field(rcc::CFGR, CORE_DIVIDER, HALVED);
    bus.clear_bits(pwr::CR5, NO_BOOST);
    bus.set_field(flash::ACR, LATENCY, ACCESS);
    bus.wait_for(flash::ACR, LATENCY, WAIT_STATES);
    bus.write(rcc::PLLCFGR, PLL);
    bus.set_bits(rcc::CR, PLL_ON);
    bus.wait_for(rcc::CR, PLL_READY, PLL_READY);
    bus.set_field(rcc::CFGR, SOURCE, SOURCE_PLL);
    bus.wait_for(rcc::CFGR, SOURCE_STATE, SOURCE_PLL << 2);
    bus.wait_us(1);
    bus.set_field(rcc::CFGR, CORE_DIVIDER, 0);
    bus.set_bits(rcc::CR, CLOCK_SECURITY);
}

/// The fault that ended the previous run, if it was a watchdog reset. Clears the reset flags.
pub fn previous_fault(bus: impl Bus) -> Option<Fault> {
    let cause = bus.read(rcc::CSR);
    bus.write(rcc::CSR, CLEAR);
    (cause & WATCHDOGS != 0).then_some(Fault::Watchdog)
}

/// Whether the crystal has failed.
pub fn crystal_has_failed(bus: impl Bus) -> bool {
    bus.read(rcc::CIFR) & CRYSTAL_FAILED != 0
}

/// A device: its bit in the registers of its bus. Enables its clock, then resets it.
#[derive(Clone, Copy, Debug)]
pub struct Device {
    reset: u32,
    bit: u32,
}

impl Device {
    /// Ports A to D.
    pub const PORTS: [Self; 4] = [
        Self { reset: rcc::AHB2RSTR, bit: 0 },
        Self { reset: rcc::AHB2RSTR, bit: 1 },
        Self { reset: rcc::AHB2RSTR, bit: 2 },
        Self { reset: rcc::AHB2RSTR, bit: 3 },
    ];
    /// Both converters.
    pub const ADC12: Self = Self { reset: rcc::AHB2RSTR, bit: 13 };
    /// Digital-to-analogue converter.
    pub const DAC1: Self = Self { reset: rcc::AHB2RSTR, bit: 16 };
    /// Ticks.
    pub const TIM2: Self = Self { reset: rcc::APB1RSTR1, bit: 0 };
    /// Motor encoder of X.
    pub const TIM3: Self = Self { reset: rcc::APB1RSTR1, bit: 1 };
    /// Motor encoder of Y.
    pub const TIM4: Self = Self { reset: rcc::APB1RSTR1, bit: 2 };
    /// Scale of X.
    pub const TIM5: Self = Self { reset: rcc::APB1RSTR1, bit: 3 };
    /// Serial port.
    pub const USART3: Self = Self { reset: rcc::APB1RSTR1, bit: 18 };
    /// CAN.
    pub const FDCAN: Self = Self { reset: rcc::APB1RSTR1, bit: 25 };
    /// Power control.
    pub const PWR: Self = Self { reset: rcc::APB1RSTR1, bit: 28 };
    /// System configuration.
    pub const SYSCFG: Self = Self { reset: rcc::APB2RSTR, bit: 0 };
    /// PWM.
    pub const TIM1: Self = Self { reset: rcc::APB2RSTR, bit: 11 };
    /// Scale of Y.
    pub const TIM8: Self = Self { reset: rcc::APB2RSTR, bit: 13 };

    /// Enables the clock.
    pub fn enable(self, bus: impl Bus) {
        let enable = self.reset + rcc::TO_ENABLE;
        bus.set_bits(enable, 1 << self.bit);
        // Chapter 7: two cycles until the first access. The read waits for the write.
        let _ = bus.read(enable);
    }

    /// Enables the clock and resets the device.
    pub fn restart(self, bus: impl Bus) {
        self.enable(bus);
        bus.set_bits(self.reset, 1 << self.bit);
        bus.clear_bits(self.reset, 1 << self.bit);
    }
}
