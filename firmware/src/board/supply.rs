//! The supply of the chip: its voltage detector.
//!
//! On this chip the detector is not connected to the break of TIM1, so that each tick reads it: the drives go off as by the emergency stop.

use stm32f4xx_hal::pac::PWR;
use stm32f4xx_hal::rcc::{Enable, Rcc};

/// The detector.
pub struct SupplyDetector(PWR);

impl SupplyDetector {
    /// Starts the detector with its highest level, about 2.9 V (PLS 111, RM0090, 5.4.1).
    pub fn start(power: PWR, rcc: &mut Rcc) -> Self {
        PWR::enable(rcc);
        // SAFETY: three bits.
        power.cr().modify(|_, w| unsafe { w.pls().bits(0b111).pvde().set_bit() });
        Self(power)
    }

    /// Whether the supply is below the level.
    pub fn is_low(&self) -> bool {
        self.0.csr().read().pvdo().bit_is_set()
    }
}
