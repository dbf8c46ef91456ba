//! A status light for the drives: off, on or blinking.
//!
//! | light | state |
//! |---|---|
//! | off | no fault and no warning |
//! | on | a fault, or the path is stopping because of one |
//! | blinking | the drives are on with a warning |

use crate::safety::{Fault, Power};

/// State of the light.
#[derive(Clone, Copy, Debug)]
pub struct StatusLight {
    half_period_ticks: u32,
    ticks: u32,
}

impl StatusLight {
    /// A light with this half period of blinking, at least one tick.
    #[must_use]
    pub const fn new(half_period_ticks: u32) -> Self {
        Self { half_period_ticks, ticks: 0 }
    }

    /// Whether the light is on in this tick.
    pub const fn is_lit(&mut self, power: Power, warning: Option<Fault>) -> bool {
        self.ticks += 1;
        if self.ticks >= 2 * self.half_period_ticks {
            self.ticks = 0;
        }
        power.fault().is_some() || warning.is_some() && self.ticks < self.half_period_ticks
    }
}
