//! The two channels of the converter for ±10 V outputs.

use stm32f4xx_hal::gpio::{Analog, PA4, PA5};
use stm32f4xx_hal::pac::DAC;
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
        let mut outputs = Self(dac);
        for (axis, counts) in zero.into_iter().enumerate() {
            outputs.set(axis, counts);
        }
        // Without a trigger, so that a value takes effect one bus cycle after it is written.
        outputs.0.cr().write(|w| w.en1().set_bit().en2().set_bit());
        outputs
    }

    /// Sets both channels to 0 V, from any context and in any state of the program. Before the device has its clock this changes nothing.
    pub fn cut() {
        // SAFETY: these writes set what the stages get while they are off.
        let dac = unsafe { &*DAC::ptr() };
        let [x, y] = setup::TABLE.map(zero_volts);
        // SAFETY: twelve bits.
        dac.dhr12r1().write(|w| unsafe { w.daccdhr().bits(x.min(4095)) });
        // SAFETY: as above.
        dac.dhr12r2().write(|w| unsafe { w.daccdhr().bits(y.min(4095)) });
    }

    /// Sets the channel of an axis.
    pub fn set(&mut self, axis: usize, counts: u16) {
        let counts = counts.min(4095);
        let register = if axis == 0 { self.0.dhr12r1() } else { self.0.dhr12r2() };
        // SAFETY: twelve bits.
        register.write(|w| unsafe { w.daccdhr().bits(counts) });
    }
}
