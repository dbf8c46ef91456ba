//! The two channels of the converter for ±10 V outputs.

use stm32f4xx_hal::gpio::{Analog, PA4, PA5};
use stm32f4xx_hal::pac::{DAC, dac};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use crate::setup::{self, AXES};
use crate::two_drives::zero_volts;

/// Both channels.
pub struct AnalogOutputs(DAC);

impl AnalogOutputs {
    /// Starts both channels at the given counts, which are to be 0 V behind the stages.
    pub fn new(dac: DAC, _pins: (PA4<Analog>, PA5<Analog>), zero: [u16; AXES], rcc: &mut Rcc) -> Self {
        DAC::enable(rcc);
        DAC::reset(rcc);
        set_both(&dac, zero);
        // Without a trigger, so that a value takes effect one bus cycle after it is written.
        dac.cr().write(|w| w.en1().set_bit().en2().set_bit());
        Self(dac)
    }

    /// Sets both channels to 0 V, from any context and in any state of the program. Before the device has its clock this changes nothing.
    pub fn cut() {
        // SAFETY: these writes set what the stages get while they are off.
        let dac = unsafe { &*DAC::ptr() };
        set_both(dac, setup::TABLE.map(zero_volts));
    }

    /// Sets the channel of an axis.
    pub fn set(&mut self, axis: usize, counts: u16) {
        set(&self.0, axis, counts);
    }
}

fn set_both(dac: &dac::RegisterBlock, counts: [u16; AXES]) {
    counts.into_iter().enumerate().for_each(|(axis, counts)| set(dac, axis, counts));
}

/// Sets the channel of an axis in the registers.
fn set(dac: &dac::RegisterBlock, axis: usize, counts: u16) {
    let counts = counts.min(4095);
    let register = if axis == 0 { dac.dhr12r1() } else { dac.dhr12r2() };
    // SAFETY: twelve bits.
    register.write(|w| unsafe { w.daccdhr().bits(counts) });
}
