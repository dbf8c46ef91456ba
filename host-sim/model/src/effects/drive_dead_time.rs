//! Dead time of the drive: the force acts some time after it was commanded.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectContext, EffectModel, Occurrence, Parameter, Range, Stage, Unit, Wording,
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

/// Longest delay, ms. A slower drive could not be controlled.
const LONGEST_MS: f64 = 10.0;

impl DriveDeadTime {
    /// The dead time, s. Finite differences at zero evaluate a negative one, which counts as none.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        1e-3 * self.ms.max(0.0)
    }
}

impl EffectModel for DriveDeadTime {
    const NAME: &'static str = "drive_dead_time";
    const SUMMARY: &'static str = "dead time between the commanded and the acting force";
    const SPECIAL_FORM_OF: Option<&'static str> = Some("drive_lag");
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("ms", Unit::Millisecond, Range::UpTo(LONGEST_MS))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let times_ms: &[f64] = if context.has(Stage::Motor) { &[0.25, 1.0] } else { &[] };
        times_ms.iter().map(|&ms| Self { ms }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::between(self.ms, 0.02, 0.0, LONGEST_MS)]
    }

    /// The instants within a tick at which a drive reads and acts are not declared.
    fn exceeds_tolerance(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms * rates.velocity_loop_hz > 0.25
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { ms: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.ms]
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the force of the drive acts {} after its command", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
