//! The independent watchdog: it resets the chip, and with it the power stages, when no tick feeds it.

use stm32f4xx_hal::pac::IWDG;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

/// Period, ms: at least a hundred ticks, with the tolerance of its clock (17 to 47 kHz, nominally 32 kHz).
const PERIOD_MS: u32 = 10;

/// The longest period that it has, ms.
const LONGEST_MS: u32 = 32_767;

/// The watchdog. It cannot be stopped.
#[derive(Debug)]
pub struct Watchdog(IndependentWatchdog);

impl Watchdog {
    /// Starts it.
    #[must_use]
    pub fn start(watchdog: IWDG) -> Self {
        let mut watchdog = Self(IndependentWatchdog::new(watchdog));
        watchdog.set_period(PERIOD_MS);
        watchdog
    }

    /// Starts its period again.
    pub fn feed(&mut self) {
        self.0.feed();
    }

    /// Gives it its longest period (22 s at the highest frequency of its clock) while `access` stops the ticks.
    pub fn during<R>(&mut self, access: impl FnOnce() -> R) -> R {
        self.set_period(LONGEST_MS);
        let result = access();
        self.set_period(PERIOD_MS);
        result
    }

    fn set_period(&mut self, ms: u32) {
        self.0.start(ms.millis());
        // The new values take some periods of the watchdog's clock to arrive there (RM0090, 21.4.4); until then it would be fed with
        // the old ones.
        // SAFETY: a read of the status, which changes nothing.
        let watchdog = unsafe { &*IWDG::ptr() };
        while watchdog.sr().read().bits() != 0 {}
        self.0.feed();
    }
}
