//! The clock with its supervision, and the cause of the last reset.

use shared::safety::Fault;
use stm32f4xx_hal::pac::RCC;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

use crate::setup;

/// Sets the clock to 168 MHz from the crystal, that of USB to 48 MHz, with the clock security system on: a failure of the crystal stops the PWM by
/// the break of its timer and raises the NMI, instead of slowing down the ticks together with the watchdog feeding.
///
/// Waits for the crystal. To be called with the power stages off.
pub fn set_up(rcc: Rcc) -> Rcc {
    let rcc = rcc.freeze(Config::hse(setup::CRYSTAL_HZ.Hz()).sysclk(168.MHz()).require_pll48clk());
    rcc.cr().modify(|_, w| w.csson().on());
    rcc
}

/// The fault that ended the previous run, if it was a watchdog reset. Clears the reset flags.
pub fn previous_fault(rcc: &RCC) -> Option<Fault> {
    let cause = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    let watchdog = cause.wdgrstf().bit_is_set() || cause.wwdgrstf().bit_is_set();
    watchdog.then_some(Fault::Watchdog)
}
