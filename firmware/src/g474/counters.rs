//! Quadrature counters on TIM3, TIM4, TIM5 and TIM8, latched at an index pulse on channel 3 and by the timer of the ticks on channel 4; those of TIM4
//! the other way round: its channel 3 is on PB8, which starts the boot loader of the chip if it is high in reset.

use super::address::tim;
use super::bus::Bus;
use super::clock::Device;
use crate::two_drives::counters::{Counters, IndexedCounter, Timers};

/// Input on its own pin; an edge after eight equal samples at 42.5 MHz, 188 ns (chapter 28: `CCxS` 01, `ICxF` 0111): it suppresses interference
/// of the PWM and allows 2.6 million counts per second.
const INPUT: u32 = 0x71;

/// Captures at the trigger (chapter 28: `CCxS` 11).
const AT_TRIGGER: u32 = 0b11;

/// Counts the edges of both inputs (chapter 28: SMS 011), with the update of TIM2 as the trigger (TS 001, its TRGO at all of these timers).
const ENCODER_MODE: u32 = 1 << 4 | 0b011;

/// Captured counts of channels 3 and 4.
const CCR3: u32 = tim::CCR1 + 8;
const CCR4: u32 = tim::CCR1 + 12;

/// The channel of the index; the other of the two has the tick.
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
        let (of_index, of_tick) = match index {
            Index::Third => (0, 8),
            Index::Fourth => (8, 0),
        };
        write(tim::CCMR2, INPUT << of_index | AT_TRIGGER << of_tick);
        write(tim::CCER, 1 | 1 << 4 | 1 << 8 | 1 << 12);
        write(tim::SMCR, ENCODER_MODE);
        // The period stays that of the reset, the whole range of the counter.
        write(tim::CR1, 1);
        Self { bus, timer, index }
    }

    fn count(&self) -> u32 {
        self.bus.read(self.timer + tim::CNT)
    }

    fn latched(&self) -> u32 {
        let captured = match self.index {
            Index::Third => CCR4,
            Index::Fourth => CCR3,
        };
        self.bus.read(self.timer + captured)
    }

    fn take_index(&self) -> Option<u32> {
        let (flag, captured) = match self.index {
            Index::Third => (1 << 3, CCR3),
            Index::Fourth => (1 << 4, CCR4),
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

    fn latched(&self) -> u16 {
        half(self.0.latched())
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

    fn latched(&self) -> u32 {
        self.0.latched()
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
