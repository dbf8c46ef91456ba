//! Feed-forward mismatch: the share of the velocity that is fed forward deviates from the declared one.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext,
    Misplaced, Occurrence, Parameter, Placement, Range, Stage, Unit, Wording,
};
use crate::axis::{Drive, Settings};

/// True Kf = declared Kf + percent, both in percent of the velocity.
///
/// At a constant velocity v the motor lags by v·(1 − Kf)/Kp: there, a deviation of Kf is equivalent to one of Kp
/// ([`ServoMismatch`](super::ServoMismatch)). Accelerations tell both apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FeedforwardMismatch {
    /// True Kf less the declared one, percentage points.
    pub percent: f64,
}

impl FeedforwardMismatch {
    /// Largest Kf of the controller, percent.
    pub const LARGEST_PERCENT: f64 = 200.0;
}

impl EffectModel for FeedforwardMismatch {
    const NAME: &'static str = "feedforward_mismatch";
    const SUMMARY: &'static str = "true Kf less the declared one, percentage points";
    const DRIVES: &'static [Drive] = &[Drive::Torque, Drive::Velocity];
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("percent", Unit::Percent, Range::Within(Self::LARGEST_PERCENT))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let declared = place.axis.controller.feedforward_percent.unwrap_or(0.0);
        let is_possible = Range::UpTo(Self::LARGEST_PERCENT).contains(declared + self.percent);
        let what =
            format!("a number that makes Kf 0 to {} %; {declared} % are declared", Self::LARGEST_PERCENT);
        (!is_possible).then_some(Misplaced { key: "percent", expected: what })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    /// None where the setting has a tolerance: it is then fitted as a declared value.
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_exact = context.axis.tolerance("feedforward_percent") == 0.0;
        if context.has(Stage::Motor) && is_exact { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.percent, 0.2, 150.0)]
    }

    /// The unknown discretization of a drive's filters has an effect of 0.25 %, a command whose instant is known to a tenth of a sample
    /// one of 0.1·Kp/rate, 0.5 % with Kp = 50 1/s at 1 kHz.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.percent.abs() > 0.5
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { percent: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.percent]
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        context.rival_gain(Imitation::POSITION_GAIN)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the setting of Kf is changed so that the drive has the declared one")
    }

    fn sentence(&self, wording: &Wording) -> String {
        let how = wording.by_sign("above", "below");
        format!(
            "the feed-forward of the velocity is {} percentage points {how} the declared one",
            wording.magnitude(0)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }
}
