//! Quadrature counters on TIM3, TIM4, TIM5 and TIM8, with the counter latched at an index pulse on channel 3, of TIM4 on channel 4: its
//! channel 3 is on PB8, which starts the boot loader of the chip if it is high in reset.

use super::address::tim;
use super::bus::Bus;
use super::clock::Device;
use crate::two_drives::counters::{Counters, IndexedCounter, Timers};

/// Input on its own pin; an edge after eight equal samples at 42.5 MHz, 188 ns (chapter 28: `CCxS` 01, `ICxF` 0111): it suppresses interference
/// of the PWM and allows 2.6 million counts per second.
const INPUT: u32 = 0x71;

/// Counts the edges of both inputs (chapter 28).
const ENCODER_MODE: u32 = 0b011;

/// The channel of the index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Index {
    Third,
    Fourth,
}

/// A timer in encoder mode.
#[derive(Clone, Copy, Debug)]
struct Encoder<B> {
    bus: B,
    timer: u32,
    index: Index,
}

impl<B: Bus> Encoder<B> {
    fn start(bus: B, device: Device, timer: u32, index: Index) -> Self {
        device.restart(bus);
        let write = |register, value| bus.write(timer + register, value);
        write(tim::CCMR1, INPUT | INPUT << 8);
        let (place, enable) = match index {
            Index::Third => (0, 1 << 8),
            Index::Fourth => (8, 1 << 12),
        };
        write(tim::CCMR2, INPUT << place);
        write(tim::CCER, 1 | 1 << 4 | enable);
        write(tim::SMCR, ENCODER_MODE);
        // The period stays that of the reset, the whole range of the counter.
        write(tim::CR1, 1);
        Self { bus, timer, index }
    }

    fn count(&self) -> u32 {
        self.bus.read(self.timer + tim::CNT)
    }

    fn take_index(&self) -> Option<u32> {
        let (flag, captured) = match self.index {
            Index::Third => (1 << 3, tim::CCR1 + 8),
            Index::Fourth => (1 << 4, tim::CCR1 + 12),
        };
        // Reading the captured value clears the flag.
        (self.bus.read(self.timer + tim::SR) & flag != 0).then(|| self.bus.read(self.timer + captured))
    }
}

/// A counter of 16 bits.
#[derive(Clone, Copy, Debug)]
pub struct Short<B>(Encoder<B>);

/// A counter of 32 bits.
#[derive(Clone, Copy, Debug)]
pub struct Long<B>(Encoder<B>);

#[expect(clippy::cast_possible_truncation, reason = "the upper half of these counters is zero")]
const fn half(count: u32) -> u16 {
    count as u16
}

impl<B: Bus> IndexedCounter for Short<B> {
    type Count = u16;

    fn count(&self) -> u16 {
        half(self.0.count())
    }

    fn take_index(&self) -> Option<u16> {
        self.0.take_index().map(half)
    }
}

impl<B: Bus> IndexedCounter for Long<B> {
    type Count = u32;

    fn count(&self) -> u32 {
        self.0.count()
    }

    fn take_index(&self) -> Option<u32> {
        self.0.take_index()
    }
}

/// The counters of this chip.
pub struct ChipCounters<B>(core::marker::PhantomData<B>);

impl<B: Bus> Counters for ChipCounters<B> {
    type X = Short<B>;
    type Y = Short<B>;
    type XScale = Long<B>;
    type YScale = Short<B>;
}

/// Starts the counters.
pub fn start<B: Bus>(bus: B) -> Timers<ChipCounters<B>> {
    Timers {
        x: Short(Encoder::start(bus, Device::TIM3, tim::TIM3, Index::Third)),
        y: Short(Encoder::start(bus, Device::TIM4, tim::TIM4, Index::Fourth)),
        x_scale: Long(Encoder::start(bus, Device::TIM5, tim::TIM5, Index::Third)),
        y_scale: Short(Encoder::start(bus, Device::TIM8, tim::TIM8, Index::Third)),
    }
}
