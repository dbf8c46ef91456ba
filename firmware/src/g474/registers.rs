//! The registers that a tick accesses.

use super::bus::Bus;
use super::counters::ChipCounters;
use super::tick::TickTimer;
use super::{converter, dac, pins, stage};
use crate::setup::AXES;
use crate::two_drives::switches::{Levels, Wiring};
use crate::two_drives::{Conversions, Registers};

/// What a tick accesses, beside the counters.
#[derive(Clone, Copy, Debug)]
pub struct ChipRegisters<B> {
    /// The bus.
    pub bus: B,
    /// The timer of the ticks.
    pub tick_timer: TickTimer<B>,
}

impl<B: Bus> Registers for ChipRegisters<B> {
    type Counters = ChipCounters<B>;

    const WIRING: &'static Wiring = &pins::WIRING;

    fn acknowledge_tick(&mut self) {
        self.tick_timer.acknowledge();
    }

    fn tick_is_due(&self) -> bool {
        self.tick_timer.is_due()
    }

    fn started_at(&self) -> u32 {
        self.tick_timer.started_at()
    }

    fn levels(&self) -> Levels {
        pins::levels(self.bus)
    }

    fn conversions(&self) -> Conversions {
        converter::read(self.bus)
    }

    fn set_directions(&mut self, reverse: [bool; AXES]) {
        pins::set_directions(self.bus, reverse);
    }

    fn set_compare(&mut self, axis: usize, counts: u16) {
        stage::set_compare(self.bus, axis, counts);
    }

    fn set_analog(&mut self, axis: usize, counts: u16) {
        dac::set(self.bus, axis, counts);
    }

    fn set_outputs(&mut self, on: bool) {
        stage::set_outputs(self.bus, on);
    }

    fn set_brakes_open(&mut self, open: bool) {
        pins::set_brakes_open(self.bus, open);
    }

    fn take_stop(&mut self) -> bool {
        stage::take_stop(self.bus)
    }

    fn set_light(&mut self, lit: bool) {
        pins::set_light(self.bus, lit);
    }
}
