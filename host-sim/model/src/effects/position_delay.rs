//! Position delay: the position feedback of the position loop is late.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{Abscissa, EffectCompensation, EffectModel, Wording, delay};
use crate::axis::Settings;

/// The position loop uses a position that is `ms` old, as over a slow bus or through a filter. The velocity loop is not
/// affected, nor is the logged position.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionDelay {
    /// Age of the position.
    pub ms: f64,
}

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

    delay!(longest 20.0, guesses [0.5, 3.0]);

    /// The instants at which channels are read are known to a tenth of a sample.
    fn exceeds_tolerance(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms * rates.velocity_loop_hz > 0.1 * f64::from(rates.position_loop_divider)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::DELAY
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the position loop uses a position that is {} old", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }
}
