//! The converters: resolver sine and cosine sampled at the same moment, bus voltage and temperature.
//!
//! ADC1 and ADC2 convert their injected channels simultaneously, X, Y, then the supply: three pairs of 28 + 12 cycles at 21 MHz,
//! 5.7 µs. TIM2 channel 1 triggers them 7 µs before the tick, so that the results are 7 to 1.3 µs old when the tick reads them.
//! There is no interrupt and no DMA.

use stm32f4xx_hal::gpio::{Analog, PC0, PC1, PC2, PC3, PC4, PC5};
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, ADC2};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::two_drives::Conversions;

/// Bus voltage and temperature; sine and cosine of X, of Y. Their types prove that they are analogue.
pub type ConverterPins = ((PC0<Analog>, PC1<Analog>), (PC2<Analog>, PC3<Analog>), (PC4<Analog>, PC5<Analog>));

/// Both converters.
pub struct Converters {
    first: ADC1,
    second: ADC2,
}

impl Converters {
    /// Starts the converters; they convert with each trigger of TIM2.
    pub fn new(first: ADC1, second: ADC2, common: &ADC_COMMON, _pins: ConverterPins, rcc: &mut Rcc) -> Self {
        // The reset of ADC1 is that of all converters.
        ADC1::enable(rcc);
        ADC2::enable(rcc);
        ADC1::reset(rcc);
        // 84 MHz / 4; at most 36 MHz are allowed.
        common.ccr().write(|w| w.adcpre().div4().multi().dual_j());
        // Channels 10 to 15 are in this register.
        first.smpr1().write(|w| w.smp10().cycles28().smp12().cycles28().smp14().cycles28());
        second.smpr1().write(|w| w.smp11().cycles28().smp13().cycles28().smp15().cycles28());
        first.cr1().write(|w| w.scan().set_bit());
        second.cr1().write(|w| w.scan().set_bit());
        // A sequence of three (JL = 2) is JSQ2 to JSQ4.
        // SAFETY: channel numbers of the converter.
        unsafe {
            first.jsqr().write(|w| w.jl().bits(2).jsq2().bits(12).jsq3().bits(14).jsq4().bits(10));
            second.jsqr().write(|w| w.jl().bits(2).jsq2().bits(13).jsq3().bits(15).jsq4().bits(11));
        }
        // The trigger of the first one starts both.
        second.cr2().write(|w| w.adon().set_bit());
        first.cr2().write(|w| w.adon().set_bit().jextsel().tim2cc1().jexten().rising_edge());
        Self { first, second }
    }

    /// The results of the last trigger.
    pub fn read(&self) -> Conversions {
        let sine = [self.first.jdr1().read().jdata().bits(), self.first.jdr2().read().jdata().bits()];
        let cosine = [self.second.jdr1().read().jdata().bits(), self.second.jdr2().read().jdata().bits()];
        Conversions {
            resolvers: [[sine[0], cosine[0]], [sine[1], cosine[1]]],
            bus: self.first.jdr3().read().jdata().bits(),
            temperature: self.second.jdr3().read().jdata().bits(),
        }
    }
}
