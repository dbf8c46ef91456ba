//! Position delay: the position feedback of the position loop is late.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectContext, EffectModel, Occurrence, Parameter, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// The position loop uses a position that is `ms` old, as over a slow bus or through a filter. The velocity loop is not
/// affected, nor is the logged position.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionDelay {
    /// Age of the position.
    pub ms: f64,
}

/// Longest delay, ms.
const LONGEST_MS: f64 = 20.0;

impl PositionDelay {
    /// The age of the position, s. Finite differences at zero evaluate a negative one, which counts as none.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        1e-3 * self.ms.max(0.0)
    }
}

impl EffectModel for PositionDelay {
    const NAME: &'static str = "position_delay";
    const SUMMARY: &'static str =
        "age of the position that the position loop uses; the velocity loop is not late";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("ms", Unit::Millisecond, Range::UpTo(LONGEST_MS))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let times_ms: &[f64] = if context.has(Stage::Motor) { &[0.5, 3.0] } else { &[] };
        times_ms.iter().map(|&ms| Self { ms }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::between(self.ms, 0.02, 0.0, LONGEST_MS)]
    }

    /// The instants at which channels are read are known to a tenth of a sample.
    fn exceeds_tolerance(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms * rates.velocity_loop_hz > 0.1 * f64::from(rates.position_loop_divider)
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { ms: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.ms]
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the position loop uses a position that is {} old", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }
}
