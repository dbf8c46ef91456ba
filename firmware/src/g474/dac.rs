//! The two channels of the converter for ±10 V outputs, on PA4 and PA5 with their buffers.

use super::address::dac;
use super::bus::Bus;
use super::clock::Device;
use crate::setup::AXES;

/// `DAC_MCR` (chapter 22): the clock is above 160 MHz (HFSEL 10); both channels drive their pins with the buffer (000).
const FAST_CLOCK: u32 = 0b10 << 14;

/// Both channels on, without a trigger, so that a value takes effect at once (chapter 22).
const BOTH: u32 = 1 | 1 << 16;

/// Starts both channels at the given counts, which are to be 0 V behind the stages.
pub fn start(bus: impl Bus, zero: [u16; AXES]) {
    Device::DAC1.restart(bus);
    bus.write(dac::MCR, FAST_CLOCK);
    set_both(bus, zero);
    bus.write(dac::CR, BOTH);
}

/// Sets both channels.
pub fn set_both(bus: impl Bus, counts: [u16; AXES]) {
    counts.into_iter().enumerate().for_each(|(axis, counts)| set(bus, axis, counts));
}

/// Sets the channel of an axis.
pub fn set(bus: impl Bus, axis: usize, counts: u16) {
    let register = if axis == 0 { dac::DHR12R1 } else { dac::DHR12R2 };
    bus.write(register, u32::from(counts.min(4095)));
}
