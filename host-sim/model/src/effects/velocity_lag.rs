//! Velocity lag: the speed that the velocity loop sees is late.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::{Coordinate, Kind, Stage, Surroundings};
use crate::axis::Settings;

/// The drive averages or filters its velocity reading; the loop acts on a speed that is `ms` old.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VelocityLag {
    /// Mean age of the reading beyond that of a plain difference; at most one period of the loop.
    pub ms: f64,
}

impl VelocityLag {
    /// Oldest speed that a loop of these rates can act on, ms: that of one of its periods before. It differences two
    /// readings and knows of none before them. Machine files are held to it, and so is the tracer.
    #[must_use]
    pub fn longest_ms(rates: Rates) -> f64 {
        1e3 / rates.velocity_loop_hz
    }

    /// The number to fit on an axis with these loops.
    #[must_use]
    pub fn within(&self, rates: Rates) -> Coordinate {
        let longest_ms = Self::longest_ms(rates);
        // Within the range on one side of any value.
        Coordinate::between(self.ms, STEP_MS.min(0.25 * longest_ms), 0.0, longest_ms)
    }
}

/// A change that shows, ms.
const STEP_MS: f64 = 0.02;

impl Kind for VelocityLag {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let sees_motor = around.stages.contains(&Stage::Motor);
        if sees_motor { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        // How far it may go is a matter of the loops: see [`Self::within`].
        vec![Coordinate::between(self.ms, STEP_MS, 0.0, f64::INFINITY)]
    }

    /// A quarter of a tick: a machine file does not say how the drive steps its filters, and the choices
    /// differ by that much.
    fn is_material(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms * rates.velocity_loop_hz > 0.25
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { ms: x[0] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("ms", self.ms)]
    }
}
