//! Velocity gain mismatch: the velocity gain in the drive deviates from the declared one.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext, Stage, Wording,
    relative_deviation,
};
use crate::axis::{Drive, Settings};

/// True Kv = declared Kv · (1 + percent/100). The logged force of the last velocity tick contains Kv as well.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VelocityGainMismatch {
    /// Relative deviation of the true gain from the declared one.
    pub percent: f64,
}

/// Smallest deviation that is told from the masses, percent: the response to a force depends on Kv divided by the mass, which is
/// known to 1 %; twice as much is required.
const MIN_PERCENT: f64 = 2.0;

impl VelocityGainMismatch {
    /// True gain divided by the declared one.
    #[must_use]
    pub fn factor(&self) -> f64 {
        1.0 + 0.01 * self.percent
    }
}

impl EffectModel for VelocityGainMismatch {
    const NAME: &'static str = "velocity_gain_mismatch";
    const SUMMARY: &'static str = "deviation of the true Kv from the declared one";
    const DRIVES: &'static [Drive] = &[Drive::Torque];

    relative_deviation!(step 0.5, limits [-90.0, 400.0]);

    /// None where the setting has a tolerance: it is then fitted as a declared value.
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_exact = context.axis.tolerance("velocity_gain_n_s_per_m") == 0.0;
        if context.has(Stage::Motor) && is_exact { vec![Self::default()] } else { Vec::new() }
    }

    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.percent.abs() > MIN_PERCENT
    }

    /// The loop shows Kv relative to the masses. Without a force, a factor of masses, friction and Kv is not known; with one, they
    /// all contain the error of its scale. An interval that reaches the smallest deviation leaves the masses open.
    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        if !context.has(Stage::Force) {
            return vec![Imitation {
                name: "motor_mass_kg",
                clause: "masses, friction and stiffness deviate from the declared ones by a common factor",
                decided_by: "a force channel",
            }];
        }
        let half_width = context.half_widths.first().copied().unwrap_or(0.0);
        if self.percent.abs() - half_width < MIN_PERCENT {
            return vec![Imitation {
                name: "motor_mass_kg",
                clause: "the masses deviate from the fitted ones by as much as they are uncertain",
                decided_by: "logs with less noise or more acceleration",
            }];
        }
        if context.allows_force_scale(self.factor()) { vec![Imitation::FORCE_GAIN] } else { Vec::new() }
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the setting of Kv is changed so that the drive has the declared one")
    }

    fn sentence(&self, wording: &Wording) -> String {
        let how = wording.by_sign("above", "below");
        format!("the velocity gain is {} {how} the declared one", wording.size(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
