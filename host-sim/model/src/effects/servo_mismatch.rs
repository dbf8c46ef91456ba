//! Servo mismatch: the position gain in the drive deviates from the declared one.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Draw, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext, Stage,
    Wording, relative_deviation,
};
use crate::axis::{Drive, Settings};

/// True Kp = declared Kp · (1 + percent/100).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoMismatch {
    /// Relative deviation of the true gain from the declared one.
    pub percent: f64,
}

impl ServoMismatch {
    /// True gain divided by declared gain.
    #[must_use]
    pub fn factor(&self) -> f64 {
        1.0 + 0.01 * self.percent
    }
}

impl EffectModel for ServoMismatch {
    const NAME: &'static str = "servo_mismatch";
    const SUMMARY: &'static str = "deviation of the true Kp from the declared one";
    const DRIVES: &'static [Drive] = &[Drive::Torque, Drive::Velocity];
    const DRAW_NUMBER: Option<u32> = Some(12);

    relative_deviation!(step 0.2, limits [-80.0, 300.0]);

    /// None where the setting has a tolerance: it is then fitted as a declared value.
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_exact = context.axis.tolerance("position_gain_per_s") == 0.0;
        if context.has(Stage::Motor) && is_exact { vec![Self::default()] } else { Vec::new() }
    }

    /// The unknown discretization of a drive's filters has an effect of 0.25 %.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.percent.abs() > 0.25
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        context.rival_gain(Imitation::FEEDFORWARD)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the setting of Kp is changed so that the drive has the declared one")
    }

    fn sentence(&self, wording: &Wording) -> String {
        let how = wording.by_sign("above", "below");
        format!("the position gain is {} {how} the declared one", wording.size(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { percent: draw.signed(3.0, 8.0) })
    }
}
