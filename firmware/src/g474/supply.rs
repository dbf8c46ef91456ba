//! The supply of the chip: the voltage detector, which stops the PWM in hardware.
//!
//! Below its level of about 2.9 V the detector asserts the break of TIM1, and no flash is erased or
//! programmed. The brown-out reset is an option of the chip, which the program does not change: its level 4 resets below 2.8 V.

use super::address::{pwr, syscfg};
use super::bus::Bus;
use super::clock::Device;

/// `PWR_CR2` (chapter 6): detector on, its level 6.
const DETECTOR: u32 = 1 | 6 << 1;

/// `PWR_CR3` (chapter 6): without the pull-downs of USB Type-C at PB4 and PB6, which are on after a reset.
const NO_DEAD_BATTERY: u32 = 1 << 14;

/// `PWR_SR2` (chapter 6): the supply is below the level.
const IS_LOW: u32 = 1 << 11;

/// `SYSCFG_CFGR2` (chapter 10): a lock-up of the core, and the detector, assert the breaks of the timers.
const BREAKS: u32 = 1 | 1 << 2;

/// Starts the detector, and releases PB4 and PB6.
pub fn start(bus: impl Bus) {
    Device::SYSCFG.enable(bus);
    bus.set_bits(pwr::CR3, NO_DEAD_BATTERY);
    bus.write(pwr::CR2, DETECTOR);
    bus.write(syscfg::CFGR2, BREAKS);
}

/// Whether the supply is too low for the flash.
pub fn is_low(bus: impl Bus) -> bool {
    bus.read(pwr::SR2) & IS_LOW != 0
}
