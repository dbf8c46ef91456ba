//! One light for the state of the drives: dark, lit, or blinking.
//!
//! | light | state |
//! |---|---|
//! | dark | all is well, drives on or off |
//! | lit | a fault stands, or the path stops because of one |
//! | blinking | the drives are on, and go on with a warning |

use crate::safety::{Fault, Power};

/// What the light remembers.
#[derive(Clone, Copy, Debug)]
pub struct StatusLight {
    half_period_ticks: u32,
    ticks: u32,
}

impl StatusLight {
    /// A light that blinks with this half period, at least one tick.
    #[must_use]
    pub const fn new(half_period_ticks: u32) -> Self {
        Self { half_period_ticks, ticks: 0 }
    }

    /// Whether it is lit in this tick.
    pub const fn is_lit(&mut self, power: Power, warning: Option<Fault>) -> bool {
        self.ticks += 1;
        if self.ticks >= 2 * self.half_period_ticks {
            self.ticks = 0;
        }
        match power {
            Power::Faulted(_) | Power::Stopping(_) => true,
            Power::On | Power::Off => warning.is_some() && self.ticks < self.half_period_ticks,
        }
    }
}
