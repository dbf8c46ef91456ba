//! The registers that a tick accesses.

use stm32f4xx_hal::gpio::{Output, PC13};

use super::converter::Converters;
use super::quadrature::BoardCounters;
use super::stage::Stages;
use super::supply::SupplyDetector;
use super::switches;
use super::tick::TickTimer;
use crate::setup::AXES;
use crate::two_drives::switches::{Levels, Wiring};
use crate::two_drives::{Conversions, Registers};

/// What a tick accesses, beside the counters.
pub struct ChipRegisters {
    /// Power stages.
    pub stages: Stages,
    /// Detector of a low supply of the chip.
    pub supply: SupplyDetector,
    /// Converters.
    pub converters: Converters,
    /// The fault light.
    pub fault_light: PC13<Output>,
    /// The timer of the ticks.
    pub tick_timer: TickTimer,
}

impl Registers for ChipRegisters {
    type Counters = BoardCounters;

    const WIRING: &'static Wiring = &switches::WIRING;

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
        switches::levels()
    }

    fn conversions(&self) -> Conversions {
        self.converters.read()
    }

    fn set_directions(&mut self, reverse: [bool; AXES]) {
        self.stages.set_directions(reverse);
    }

    fn set_compare(&mut self, axis: usize, counts: u16) {
        self.stages.set_compare(axis, counts);
    }

    fn set_analog(&mut self, axis: usize, counts: u16) {
        self.stages.set_analog(axis, counts);
    }

    fn set_outputs(&mut self, on: bool) {
        self.stages.set_outputs(on);
    }

    fn set_brakes_open(&mut self, open: bool) {
        self.stages.set_brakes_open(open);
    }

    fn take_stop(&mut self) -> bool {
        self.stages.take_stop() | self.supply.is_low()
    }

    fn set_light(&mut self, lit: bool) {
        // The light is connected between the pin and the supply: active low.
        self.fault_light.set_state((!lit).into());
    }
}
