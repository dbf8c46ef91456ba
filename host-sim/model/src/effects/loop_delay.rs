//! Loop delay: the velocity command reaches the velocity loop late.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{Abscissa, EffectCompensation, EffectModel, Wording, delay};
use crate::axis::Settings;

/// Time between the readings of the position loop and the velocity command that follows from them: a cycle of the control or of
/// the bus between control and drive. It delays command and feedback of the position loop alike; the velocity loop is not late.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopDelay {
    /// Delay in addition to the hold of one sample.
    pub ms: f64,
}

impl LoopDelay {
    /// The delay, s. Finite differences at zero evaluate a negative one, which counts as none.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        1e-3 * self.ms.max(0.0)
    }
}

impl EffectModel for LoopDelay {
    const NAME: &'static str = "loop_delay";
    const SUMMARY: &'static str = "delay of the velocity command between position loop and velocity loop";

    delay!(longest 20.0, guesses [0.5, 2.0]);

    /// Delays of this kind are cycles of a control or a bus. A smaller fraction of a sample is not told from the age of the velocity
    /// (EMPS: 0.17 samples beside a mean of two readings).
    fn exceeds_tolerance(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms * rates.velocity_loop_hz > 0.3 * f64::from(rates.position_loop_divider)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::DELAY
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the velocity command reaches the velocity loop {} late", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
