//! The converters: resolver sine and cosine sampled at the same moment, bus voltage and temperature.
//!
//! ADC1 converts the sines of X and Y, ADC2 the cosines, bus voltage and temperature: conversions of 47.5 + 12.5 cycles at 42.5 MHz, of
//! which four take 5.65 µs. TIM2 channel 1 triggers both 7 µs before the tick. They have one clock, so that both start in the same cycle of it.
//! There is no interrupt and no DMA.

use super::address::adc;
use super::bus::Bus;
use super::clock::Device;
use crate::two_drives::Conversions;

/// Both with a quarter of the clock of the core, synchronously (chapter 21: CKMODE 11).
const QUARTER: u32 = 0b11 << 16;

/// Bits of `ADC_CR` (chapter 21).
const ON: u32 = 1;
const START_INJECTED: u32 = 1 << 3;
const REGULATOR: u32 = 1 << 28;
const CALIBRATE: u32 = 1 << 31;

/// `ADC_ISR` (chapter 21): ready.
const READY: u32 = 1;

/// Start-up time of the regulator, µs (DS12288).
const REGULATOR_US: u32 = 20;

/// 47.5 cycles (chapter 21: SMP 100).
const SAMPLE_TIME: u32 = 0b100;

/// `ADC_JSQR` (chapter 21): rising edges (01) of TIM2 channel 1 (3).
const TRIGGER: u32 = 3 << 2 | 0b01 << 7;

/// Channels of a sequence: sines of X and Y at PC2 and PC0; cosines at PC3 and PC1, bus voltage at PC4, temperature at PC5.
const SINES: [u32; 2] = [8, 6];
const COSINES_AND_SUPPLY: [u32; 4] = [9, 7, 5, 11];

/// Places of the channels in `ADC_JSQR`.
const PLACES: [u32; 4] = [9, 15, 21, 27];

fn sequence(channels: &[u32]) -> u32 {
    // One less than their number.
    let length = channels.iter().skip(1).map(|_| 1).sum::<u32>();
    channels.iter().zip(PLACES).fold(TRIGGER | length, |bits, (channel, place)| bits | channel << place)
}

fn sample_times(channels: &[u32]) -> [u32; 2] {
    let of = |first: u32| {
        let these = channels.iter().filter(move |channel| first <= **channel && **channel < first + 10);
        these.fold(0, |bits, channel| bits | SAMPLE_TIME << (3 * (channel - first)))
    };
    [of(0), of(10)]
}

/// Calibrates and starts the converters; they convert with each trigger of TIM2.
pub fn start(bus: impl Bus) {
    Device::ADC12.restart(bus);
    bus.write(adc::CCR, QUARTER);
    // Out of deep power-down (the zero of its bit), then the regulator (chapter 21).
    let both = [adc::ADC1, adc::ADC2];
    for bits in [0, REGULATOR] {
        for device in both {
            bus.write(device + adc::CR, bits);
        }
    }
    bus.wait_us(REGULATOR_US);
    for (device, channels) in both.into_iter().zip([&SINES[..], &COSINES_AND_SUPPLY[..]]) {
        bus.write(device + adc::CR, REGULATOR | CALIBRATE);
        bus.wait_for(device + adc::CR, CALIBRATE, 0);
        // Chapter 21: four cycles of the converter before it is switched on.
        bus.wait_us(1);
        bus.write(device + adc::ISR, READY);
        bus.write(device + adc::CR, REGULATOR | ON);
        bus.wait_for(device + adc::ISR, READY, READY);
        let [low, high] = sample_times(channels);
        bus.write(device + adc::SMPR1, low);
        bus.write(device + adc::SMPR2, high);
        bus.write(device + adc::JSQR, sequence(channels));
        bus.write(device + adc::CR, REGULATOR | ON | START_INJECTED);
    }
}

/// The results of the last trigger.
pub fn read(bus: impl Bus) -> Conversions {
    #[expect(clippy::cast_possible_truncation, reason = "twelve bits")]
    let result = |device, number: u32| bus.read(device + adc::JDR1 + 4 * number) as u16;
    Conversions {
        resolvers: [0, 1].map(|axis| [result(adc::ADC1, axis), result(adc::ADC2, axis)]),
        bus: result(adc::ADC2, 2),
        temperature: result(adc::ADC2, 3),
    }
}
