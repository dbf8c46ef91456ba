//! Velocity lag: the speed that the velocity loop sees is late.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectContext, EffectModel, Misplaced, Occurrence, Parameter, Placement, Range,
    Stage, Unit, Wording,
};
use super::latency::LONGEST_LATENCY_MS;
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

impl EffectModel for VelocityLag {
    const NAME: &'static str = "velocity_lag";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("ms", Unit::Millisecond, Range::Within(LONGEST_LATENCY_MS))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let range = Range::UpTo(Self::longest_ms(place.rates));
        (!range.contains(self.ms)).then(|| Misplaced { key: "ms", expected: range.description() })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let sees_motor = context.has(Stage::Motor);
        if sees_motor { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        // How far it may go is a matter of the loops: see [`Self::within`].
        vec![Coordinate::between(self.ms, STEP_MS, 0.0, f64::INFINITY)]
    }

    /// A quarter of a tick: a machine file does not say how the drive steps its filters, and the choices
    /// differ by that much.
    fn exceeds_tolerance(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms * rates.velocity_loop_hz > 0.25
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { ms: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.ms]
    }

    fn coordinates_at(&self, rates: Rates) -> Vec<Coordinate> {
        vec![self.within(rates)]
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the velocity loop acts on a speed that is {} old", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
