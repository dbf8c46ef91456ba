//! The tick: an interrupt of TIM2 at the start of each PWM period, at which the encoders are latched.

use cortex_m::peripheral::DWT;
use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::setup;

/// Counts by which the period of the timer exceeds the PWM period. While the PWM runs, its update resets the timer before the
/// period ends; if the PWM stops, the ticks continue 1.5 % slower.
const EXTRA_COUNTS: u32 = 64;

/// Time from the trigger of the converters to the tick, counts of 84 MHz: 7 µs. They need 5.7 µs.
const CONVERSION_COUNTS: u32 = 600;

/// The timer of the ticks.
pub struct TickTimer {
    timer: TIM2,
    /// Cycles of the core at the start of the present tick.
    started_at: u32,
}

impl TickTimer {
    /// Starts the ticks, reset by each update of TIM1 (ITR0) so that they keep its phase.
    pub fn new(timer: TIM2, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        let period = rcc.clocks.timclk1().raw() / setup::TICK_HZ;
        timer.arr().write(|w| w.arr().set(period + EXTRA_COUNTS - 1));
        // Channel 1 triggers the converters at its rising edge (PWM mode 2); it has no pin.
        timer.ccmr1_output().write(|w| w.oc1m().pwm_mode2());
        timer.ccr1().write(|w| w.ccr().set(period - CONVERSION_COUNTS));
        timer.ccer().write(|w| w.cc1e().set_bit());
        timer.smcr().write(|w| w.ts().itr0().sms().reset_mode());
        // Each tick latches the counters of the encoders.
        timer.cr2().write(|w| w.mms().update());
        timer.egr().write(|w| w.ug().set_bit());
        timer.sr().write(|w| w.uif().clear_bit());
        timer.dier().write(|w| w.uie().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        Self { timer, started_at: 0 }
    }

    /// The start of a tick: clears the interrupt flag. If it is set again during the tick, the next tick is due.
    pub fn acknowledge(&mut self) {
        self.started_at = DWT::cycle_count();
        self.timer.sr().write(|w| w.uif().clear_bit());
    }

    /// The count of the clock cycles of the core at the start of the present tick.
    pub const fn started_at(&self) -> u32 {
        self.started_at
    }

    /// Whether the next tick is due.
    pub fn is_due(&self) -> bool {
        self.timer.sr().read().uif().bit_is_set()
    }
}
