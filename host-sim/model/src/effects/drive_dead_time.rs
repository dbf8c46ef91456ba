//! Dead time of the drive: the force acts some time after it was commanded.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, EffectCompensation, EffectModel, Imitation, ImitationContext, Stage, Wording, delay,
};
use crate::axis::Settings;

/// Dead time between the commanded force and the acting one, as of a bus cycle or of the pulse width modulation. The logged
/// force is the commanded one, which is ahead of the acting one by this time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveDeadTime {
    /// Dead time in addition to the hold of one tick.
    pub ms: f64,
}

impl DriveDeadTime {
    /// The dead time, s. Finite differences at zero evaluate a negative one, which counts as none.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        1e-3 * self.ms.max(0.0)
    }
}

const COMPUTATION: Imitation = Imitation {
    name: "computation_delay",
    clause: "the velocity loop outputs its force this time after its readings",
    decided_by: "a force channel",
};

impl EffectModel for DriveDeadTime {
    const NAME: &'static str = "drive_dead_time";
    const SUMMARY: &'static str = "dead time between the commanded and the acting force";
    const SPECIAL_FORM_OF: Option<&'static str> = Some("drive_lag");

    // A slower drive could not be controlled.
    delay!(longest 10.0, guesses [0.25, 1.0]);

    /// The instants within a tick at which a drive reads and acts are not declared.
    fn exceeds_tolerance(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms * rates.velocity_loop_hz > 0.25
    }

    /// Only the force tells whether it is logged as computed or as output.
    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        if context.has(Stage::Force) { Vec::new() } else { vec![COMPUTATION] }
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::DELAY
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the force of the drive acts {} after its command", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
