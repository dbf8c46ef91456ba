//! The independent watchdog: it resets the chip, and with it the power stages, when no tick feeds it.
//!
//! Its period is never extended: the ticks continue while the flash is erased ([`super::flash`]).

use super::address::iwdg;
use super::bus::Bus;

/// Keys of `IWDG_KR` (chapter 42): start, write access, feed.
const START: u32 = 0xcccc;
const ACCESS: u32 = 0x5555;
const FEED: u32 = 0xaaaa;

/// Period, ms: two hundred ticks.
const PERIOD_MS: u32 = 10;

/// Its clock, Hz, nominally (DS12288: 29.5 to 34 kHz).
const CLOCK_HZ: u32 = 32_000;

/// Prescaler 0: a quarter of the clock (chapter 42).
const PRESCALER: u32 = 0;

/// Periods of the prescaler less one (chapter 42).
const RELOAD: u32 = CLOCK_HZ / 4 * PERIOD_MS / 1000 - 1;

/// Greatest number of reads of the status until both values have arrived, for some periods of its clock (chapter 42); then it is fed in any case.
const READS: u32 = 100_000;

/// The watchdog. It cannot be stopped.
#[derive(Clone, Copy, Debug)]
pub struct Watchdog<B>(B);

impl<B: Bus> Watchdog<B> {
    /// Starts it.
    #[must_use]
    pub fn start(bus: B) -> Self {
        bus.write(iwdg::KR, START);
        bus.write(iwdg::KR, ACCESS);
        bus.write(iwdg::PR, PRESCALER);
        bus.write(iwdg::RLR, RELOAD);
        let _ = bus.within_reads(READS, iwdg::SR, u32::MAX, 0);
        let mut watchdog = Self(bus);
        watchdog.feed();
        watchdog
    }

    /// Starts its period again.
    pub fn feed(&mut self) {
        self.0.write(iwdg::KR, FEED);
    }
}
