//! The tick: an interrupt of TIM2 at the start of each PWM period, at which the encoders are latched.

use super::address::{CYCLE_COUNTER, tim};
use super::bus::Bus;
use super::clock::{CORE_HZ, Device};
use crate::setup;

/// Counts of a period.
const PERIOD: u32 = CORE_HZ / setup::TICK_HZ;

/// Counts by which the period of the timer exceeds the PWM period. While the PWM runs, its update resets the timer before the
/// period ends; if the PWM stops, the ticks continue 1.5 % slower.
const EXTRA_COUNTS: u32 = 128;

/// Time from the trigger of the converters to the tick, counts of 170 MHz: 7 µs. They need 5.65 µs.
const CONVERSION_COUNTS: u32 = 1190;

/// Flag and interrupt of the update.
const UPDATE: u32 = 1;

/// Reset (chapter 29: SMS 100) by TIM1 (TS 000).
const RESET_MODE: u32 = 0b100;

/// Control 2 of a timer whose updates are its trigger output (chapters 28 and 29: MMS 010).
pub const UPDATE_AS_TRIGGER: u32 = 0b010 << 4;

/// Channel 1: PWM mode 2 (chapter 29), which rises at the compare value.
const PWM_MODE_2: u32 = 0b111 << 4;

const fn timer(register: u32) -> u32 {
    tim::TIM2 + register
}

/// The timer of the ticks.
#[derive(Clone, Copy, Debug)]
pub struct TickTimer<B> {
    bus: B,
    /// Cycles of the core at the start of the present tick.
    started_at: u32,
}

impl<B: Bus> TickTimer<B> {
    /// Starts the ticks, reset by each update of TIM1 so that they keep its phase.
    pub fn start(bus: B) -> Self {
        Device::TIM2.restart(bus);
        bus.write(timer(tim::ARR), PERIOD + EXTRA_COUNTS - 1);
        // Channel 1 triggers the converters at its rising edge; it has no pin.
        bus.write(timer(tim::CCMR1), PWM_MODE_2);
        bus.write(timer(tim::CCR1), PERIOD - CONVERSION_COUNTS);
        bus.write(timer(tim::CCER), 1);
        bus.write(timer(tim::SMCR), RESET_MODE);
        // Each tick latches the counters of the encoders.
        bus.write(timer(tim::CR2), UPDATE_AS_TRIGGER);
        bus.write(timer(tim::EGR), UPDATE);
        bus.write(timer(tim::SR), 0);
        bus.write(timer(tim::DIER), UPDATE);
        bus.write(timer(tim::CR1), 1);
        Self { bus, started_at: 0 }
    }

    /// The start of a tick: clears the interrupt flag. If it is set again during the tick, the next tick is due.
    pub fn acknowledge(&mut self) {
        self.started_at = self.bus.read(CYCLE_COUNTER);
        self.bus.write(timer(tim::SR), !UPDATE);
    }

    /// The count of the clock cycles of the core at the start of the present tick.
    pub const fn started_at(&self) -> u32 {
        self.started_at
    }

    /// Whether the next tick is due.
    pub fn is_due(&self) -> bool {
        self.bus.read(timer(tim::SR)) & UPDATE != 0
    }
}
