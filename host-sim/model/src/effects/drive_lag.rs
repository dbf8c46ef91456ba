//! Drive lag: the force of the drive follows its command with a delay.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{Abscissa, EffectCompensation, EffectModel, Timing, Wording, delay};

use crate::axis::Settings;

/// The acting force follows the commanded one as a first-order lag, as that of a current loop: τ·F' = command − F. It
/// replaces `drive_time_constant_ms` of the instruments. The logged force is the commanded one, F + τ·F'.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveLag {
    /// τ.
    pub ms: f64,
}

impl DriveLag {
    /// τ, s. Finite differences at zero evaluate a negative lag, which counts as none.
    #[must_use]
    pub fn time_constant_s(&self) -> f64 {
        1e-3 * self.ms.max(0.0)
    }
}

impl EffectModel for DriveLag {
    const NAME: &'static str = "drive_lag";
    const SUMMARY: &'static str =
        "time constant of a first-order lag between the commanded and the acting force";

    // A slower drive could not be controlled.
    delay!(longest 10.0, guesses [0.3, 1.5]);

    /// Current loops have time constants of about 0.1 ms, which no machine file declares.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.ms > 0.15
    }

    fn timing(&self) -> Option<Timing> {
        Some(Timing::DriveLag)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the lag is in the drive's current loop",
            "tune the current loop of the drive",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the force of the drive follows its command with a time constant of {}", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
