//! Velocity lag: the velocity used by the velocity loop is delayed.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Misplaced, Occurrence, Parameter,
    Placement, Range, Stage, Timing, Unit, Wording,
};

use super::latency::LONGEST_LATENCY_MS;
use crate::axis::{Drive, Settings};

/// The drive averages its velocity reading: the loop uses a velocity that is `ms` older than a backward difference, which is half
/// a period of the loop old itself. A negative value is a fresher velocity, as that of a tachometer or an observer.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VelocityLag {
    /// Mean age of the velocity in addition to that of a backward difference; at most one period of the loop, either way.
    pub ms: f64,
}

impl VelocityLag {
    /// Largest size with these loop rates, ms: one period of the velocity loop, as the simulated loop computes the
    /// velocity from three readings. It limits the value in machine files and the search of the tracer.
    #[must_use]
    pub fn longest_ms(rates: Rates) -> f64 {
        1e3 / rates.velocity_loop_hz
    }

    /// The coordinate to fit on an axis with these loop rates.
    #[must_use]
    pub fn within(&self, rates: Rates) -> Coordinate {
        let longest_ms = Self::longest_ms(rates);
        // The step fits into the range on at least one side of any value.
        Coordinate::between(self.ms, STEP_MS.min(0.25 * longest_ms), -longest_ms, longest_ms)
    }
}

/// Step of the finite difference, ms.
const STEP_MS: f64 = 0.02;

impl EffectModel for VelocityLag {
    const NAME: &'static str = "velocity_lag";
    const SUMMARY: &'static str = "age of the velocity that the velocity loop uses beyond that of a backward difference, at most one period of the \
         loop (`ms` below 0: fresher)";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("ms", Unit::Millisecond, Range::Within(LONGEST_LATENCY_MS))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];
    const DRIVES: &'static [Drive] = &[Drive::Torque];

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let range = Range::Within(Self::longest_ms(place.rates));
        (!range.contains(self.ms)).then(|| Misplaced { key: "ms", expected: range.description() })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if context.has(Stage::Motor) { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        // The upper bound depends on the loop rates: see [`Self::within`].
        vec![Coordinate::signed(self.ms, STEP_MS, f64::INFINITY)]
    }

    /// The discretization of a drive's filters is not declared; the choices differ by a quarter of a tick.
    fn exceeds_tolerance(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms.abs() * rates.velocity_loop_hz > 0.25
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

    fn hides_friction() -> Option<Self> {
        Some(Self::default())
    }

    fn timing(&self) -> Option<Timing> {
        Some(Timing::VelocityAge)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::VELOCITY_READING
    }

    fn sentence(&self, wording: &Wording) -> String {
        let how = wording.by_sign("older", "fresher");
        format!(
            "the velocity loop uses a velocity that is {} {how} than a backward difference",
            wording.size(0)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
