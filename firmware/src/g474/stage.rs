//! The power stages: PWM of TIM1, and what switches the drives off.
//!
//! Outputs are off until the program sets the main output enable (MOE), and never switch on by themselves. They are switched off by a low
//! stop (PB12), a failure of the crystal, a supply below the level of the detector, and a lock-up of the core.

use super::address::tim;
use super::bus::Bus;
use super::clock::{CORE_HZ, Device};
use super::tick::UPDATE_AS_TRIGGER;
use super::{dac, pins};
use crate::setup;
use crate::two_drives::zero_volts;

/// PWM counts of full duty: those of a period.
#[expect(clippy::cast_possible_truncation, reason = "8500")]
pub const FULL_COUNTS: u16 = (CORE_HZ / setup::PWM_HZ) as u16;
const _: () = assert!(FULL_COUNTS as u32 * setup::PWM_HZ == CORE_HZ);

/// Both channels (chapter 28): PWM mode 2, the pulse at the end of the period, buffered.
const CHANNELS: u32 = 0x7878;

/// Main output (chapter 28).
const MAIN_OUTPUT: u32 = 1 << 15;

/// Break on, active low, no automatic output; outputs are driven when running and idle (11, 10); lock level 2 protects these bits (except
/// the main output) and the polarities until a reset.
const BREAK: u32 = 1 << 12 | 1 << 11 | 1 << 10 | 2 << 8;

/// Flags of the pin of the break, and of the breaks of the system (chapter 28).
const BROKEN: u32 = 1 << 7 | 1 << 13;

const fn timer(register: u32) -> u32 {
    tim::TIM1 + register
}

/// Starts the PWM with its outputs off and low.
pub fn start(bus: impl Bus) {
    Device::TIM1.restart(bus);
    let full = u32::from(FULL_COUNTS);
    bus.write(timer(tim::ARR), full - 1);
    bus.write(timer(tim::CCMR1), CHANNELS);
    // A compare value beyond the period gives no pulse.
    bus.write(timer(tim::CCR1), full);
    bus.write(timer(tim::CCR1 + 4), full);
    bus.write(timer(tim::CCER), 1 | 1 << 4);
    // To TIM2. Idle outputs are low.
    bus.write(timer(tim::CR2), UPDATE_AS_TRIGGER);
    bus.write(timer(tim::BDTR), BREAK);
    bus.write(timer(tim::EGR), 1);
    bus.write(timer(tim::SR), 0);
    // Counter enabled, with a buffered period.
    bus.write(timer(tim::CR1), 1 << 7 | 1);
}

/// Sets the compare value of an axis, for the next period.
pub fn set_compare(bus: impl Bus, axis: usize, counts: u16) {
    let register = if axis == 0 { tim::CCR1 } else { tim::CCR1 + 4 };
    bus.write(timer(register), u32::from(counts));
}

/// Enables or disables the stages immediately.
pub fn set_outputs(bus: impl Bus, on: bool) {
    bus.set_field(timer(tim::BDTR), MAIN_OUTPUT, if on { MAIN_OUTPUT } else { 0 });
    pins::set_enable(bus, on);
}

/// Whether a break has been active since the last call. Its flag cannot be cleared while it is.
pub fn take_stop(bus: impl Bus) -> bool {
    let broken = bus.read(timer(tim::SR)) & BROKEN;
    if broken != 0 {
        // Zeros clear, ones change nothing.
        bus.write(timer(tim::SR), !broken);
    }
    broken != 0
}

/// Disables the power stages, closes the brakes and sets the analogue outputs to 0 V, from any context and in any state of the program. These
/// writes can only switch off.
pub fn cut(bus: impl Bus) {
    pins::set_enable(bus, false);
    pins::set_brakes_open(bus, false);
    bus.clear_bits(timer(tim::BDTR), MAIN_OUTPUT);
    dac::set_both(bus, setup::TABLE.map(zero_volts));
}
