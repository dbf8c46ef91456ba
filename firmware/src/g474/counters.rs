//! Counters of encoders, or of steps, on TIM3, TIM4, TIM5 and TIM8, latched at an index pulse on channel 3 and by the timer of the ticks on channel 4; those of TIM4
//! the other way round: its channel 3 is on PB8, which starts the boot loader of the chip if it is high in reset.

use super::address::tim;
use super::bus::Bus;
use super::clock::Device;
use crate::setup::{AXES, AxisTable};
use crate::two_drives::counters::{Counters, IndexedCounter, Timers};

/// Input on its own pin; an edge after eight equal samples at 42.5 MHz, 188 ns (chapter 28: `CCxS` 01, `ICxF` 0111): it suppresses interference
/// of the PWM and allows 2.6 million counts per second.
const INPUT: u32 = 0x71;

/// Captures at the trigger (chapter 28: `CCxS` 11).
const AT_TRIGGER: u32 = 0b11;

/// The trigger is the update of TIM2 (TS 001, its TRGO at all of these timers).
const TICK_AS_TRIGGER: u32 = 1 << 4;

/// What is connected to inputs 1 and 2 of a counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signals {
    /// A and B of an encoder: all edges of both are counted.
    Quadrature,
    /// Direction, high: up, and steps: their rising edges are counted. A level has to last for 190 ns, and the direction must not change during a step.
    DirectionAndSteps,
}

/// The signals of the master that an axis without a scale follows, at the input of its scale (`board follow`).
pub const MASTERS: [Signals; AXES] = [Signals::Quadrature; AXES];

/// The signals at the inputs of the scales: those of a scale, or of a master where there is none.
#[must_use]
pub fn scale_signals(table: &[AxisTable; AXES], masters: [Signals; AXES]) -> [Signals; AXES] {
    core::array::from_fn(|axis| match table[axis].scale_m_per_count {
        Some(_) => Signals::Quadrature,
        None => masters[axis],
    })
}

impl Signals {
    /// Mode of the timer (chapter 28: SMS 0011, or 1011 "clock plus direction, x1").
    const fn mode(self) -> u32 {
        match self {
            Self::Quadrature => 0b011,
            Self::DirectionAndSteps => 1 << 16 | 0b011,
        }
    }

    /// Edge of input 2 (chapter 28: CC2P), where one edge counts: set, the rising one.
    const fn edge(self) -> u32 {
        match self {
            Self::Quadrature => 0,
            Self::DirectionAndSteps => 1 << 5,
        }
    }
}

/// Captured counts of channels 3 and 4.
const CCR3: u32 = tim::CCR1 + 8;
const CCR4: u32 = tim::CCR1 + 12;

/// The channel of the index; the other of the two has the tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Index {
    Third,
    Fourth,
}

/// A timer in an encoder mode.
#[derive(Clone, Copy, Debug)]
struct Encoder<B> {
    bus: B,
    timer: u32,
    index: Index,
}

impl<B: Bus> Encoder<B> {
    fn start(bus: B, (device, timer): (Device, u32), signals: Signals, index: Index) -> Self {
        device.restart(bus);
        let write = |register, value| bus.write(timer + register, value);
        write(tim::CCMR1, INPUT | INPUT << 8);
        let (of_index, of_tick) = match index {
            Index::Third => (0, 8),
            Index::Fourth => (8, 0),
        };
        write(tim::CCMR2, INPUT << of_index | AT_TRIGGER << of_tick);
        write(tim::CCER, 1 | 1 << 4 | signals.edge() | 1 << 8 | 1 << 12);
        write(tim::SMCR, TICK_AS_TRIGGER | signals.mode());
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

/// Starts the counters, with the signals at the inputs of the scales.
pub fn start<B: Bus>(bus: B, [x_scale, y_scale]: [Signals; AXES]) -> Timers<ChipCounters<B>> {
    let encoder = Signals::Quadrature;
    Timers {
        x: Short(Encoder::start(bus, (Device::TIM3, tim::TIM3), encoder, Index::Third)),
        y: Short(Encoder::start(bus, (Device::TIM4, tim::TIM4), encoder, Index::Fourth)),
        x_scale: Long(Encoder::start(bus, (Device::TIM5, tim::TIM5), x_scale, Index::Third)),
        y_scale: Short(Encoder::start(bus, (Device::TIM8, tim::TIM8), y_scale, Index::Third)),
    }
}
