//! Drive lag: the force of the drive follows its command with a delay.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectContext, EffectModel, Occurrence, Parameter, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// The acting force follows the commanded one as a first-order lag, as that of a current loop: τ·F' = command − F. It
/// replaces `drive_time_constant_ms` of the instruments. The logged force is the commanded one, F + τ·F'.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveLag {
    /// τ.
    pub ms: f64,
}

/// Longest lag, ms. A slower drive could not be controlled.
const LONGEST_MS: f64 = 10.0;

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
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("ms", Unit::Millisecond, Range::UpTo(LONGEST_MS))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let times_ms: &[f64] = if context.has(Stage::Motor) { &[0.3, 1.5] } else { &[] };
        times_ms.iter().map(|&ms| Self { ms }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::between(self.ms, 0.02, 0.0, LONGEST_MS)]
    }

    /// Current loops have time constants of about 0.1 ms, which no machine file declares.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.ms > 0.15
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { ms: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.ms]
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the force of the drive follows its command with a time constant of {}", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
