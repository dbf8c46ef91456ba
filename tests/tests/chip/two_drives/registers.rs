//! Registers with values that a test sets and reads.

use std::cell::RefCell;

use firmware::setup::AXES;
use firmware::two_drives::counters::{Counters, IndexedCounter, Timers};
use firmware::two_drives::switches::{Levels, Wiring};
use firmware::two_drives::{Conversions, Registers};

/// PWM counts of full duty.
pub const FULL_COUNTS: u16 = 8400;

/// The pins: other ones than those of either board.
pub static WIRING: Wiring = Wiring {
    scale_signals: [1, 1 << 1],
    probe: 1 << 2,
    limits: [[1, 1 << 1], [1 << 2, 1 << 3]],
    drive_faults: [1 << 4, 1 << 5],
    stop: 1 << 6,
    enable_switch: 1 << 7,
    homes: [1, 1 << 1],
};

/// The counters of the motors of X and Y, then of the scales, as they are latched.
#[derive(Default)]
pub struct State {
    pub counts: [u32; 4],
    pub indexes: [Option<u32>; 4],
    pub levels: Levels,
    pub conversions: Conversions,
    pub directions: [bool; AXES],
    pub compares: [u16; AXES],
    pub analog: [Option<u16>; AXES],
    pub are_brakes_open: bool,
    /// Each write to the outputs.
    pub outputs: Vec<bool>,
}

/// The registers, for the lifetime of the test.
#[derive(Clone, Copy)]
pub struct Chip(&'static RefCell<State>);

impl Chip {
    pub fn new() -> Self {
        Self(Box::leak(Box::default()))
    }

    pub fn with<R>(self, access: impl FnOnce(&mut State) -> R) -> R {
        access(&mut self.0.borrow_mut())
    }
}

pub struct Short(Chip, usize);
pub struct Long(Chip, usize);

impl IndexedCounter for Short {
    type Count = u16;

    /// The counter at the start of the program: a tick reads what was latched.
    fn count(&self) -> u16 {
        0
    }

    fn latched(&self) -> u16 {
        self.0.with(|state| u16::try_from(state.counts[self.1]).unwrap())
    }

    fn take_index(&self) -> Option<u16> {
        self.0.with(|state| state.indexes[self.1].take().map(|count| u16::try_from(count).unwrap()))
    }
}

impl IndexedCounter for Long {
    type Count = u32;

    /// The counter at the start of the program: a tick reads what was latched.
    fn count(&self) -> u32 {
        0
    }

    fn latched(&self) -> u32 {
        self.0.with(|state| state.counts[self.1])
    }

    fn take_index(&self) -> Option<u32> {
        self.0.with(|state| state.indexes[self.1].take())
    }
}

impl Counters for Chip {
    type X = Short;
    type Y = Short;
    type XScale = Long;
    type YScale = Short;
}

pub const fn timers(chip: Chip) -> Timers<Chip> {
    Timers { x: Short(chip, 0), y: Short(chip, 1), x_scale: Long(chip, 2), y_scale: Short(chip, 3) }
}

impl Registers for Chip {
    type Counters = Self;

    const WIRING: &'static Wiring = &WIRING;

    fn acknowledge_tick(&mut self) {}

    fn tick_is_due(&self) -> bool {
        false
    }

    fn started_at(&self) -> u32 {
        0
    }

    fn levels(&self) -> Levels {
        self.with(|state| state.levels)
    }

    fn conversions(&self) -> Conversions {
        self.with(|state| state.conversions)
    }

    fn set_directions(&mut self, reverse: [bool; AXES]) {
        self.with(|state| state.directions = reverse);
    }

    fn set_compare(&mut self, axis: usize, counts: u16) {
        self.with(|state| state.compares[axis] = counts);
    }

    fn set_analog(&mut self, axis: usize, counts: u16) {
        self.with(|state| state.analog[axis] = Some(counts));
    }

    fn set_outputs(&mut self, on: bool) {
        self.with(|state| state.outputs.push(on));
    }

    fn set_brakes_open(&mut self, open: bool) {
        self.with(|state| state.are_brakes_open = open);
    }

    fn take_stop(&mut self) -> bool {
        false
    }

    fn set_light(&mut self, _: bool) {}
}
