//! The clock and its watch, and how the chip came to start.

use shared::safety::Fault;
use stm32f4xx_hal::pac::RCC;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

use crate::setup;

/// 168 MHz of the crystal, with the clock security system on: a crystal that fails stops the PWM by the break of its
/// timer and raises the NMI, instead of slowing down ticks and watchdog feeding alike.
///
/// Waits for the crystal. To be called with the power stages off.
pub fn set_up(rcc: Rcc) -> Rcc {
    let rcc = rcc.freeze(Config::hse(setup::CRYSTAL_HZ.Hz()).sysclk(168.MHz()));
    rcc.cr().modify(|_, w| w.csson().on());
    rcc
}

/// Why the run before ended, where it did not by power or by hand. The flags are cleared for the next start.
pub fn ended_by(rcc: &RCC) -> Option<Fault> {
    let cause = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    let watchdog = cause.wdgrstf().bit_is_set() || cause.wwdgrstf().bit_is_set();
    watchdog.then_some(Fault::Watchdog)
}
