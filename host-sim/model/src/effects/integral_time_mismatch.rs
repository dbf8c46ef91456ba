//! Integral time mismatch: the integral time of the velocity loop deviates from the declared one.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, EffectCompensation, EffectContext, EffectModel, Misplaced, Neighbours, Placement, Prerequisite,
    Stage, Wording, relative_deviation,
};
use crate::axis::{Drive, Settings};

/// True Ti = declared Ti · (1 + percent/100). The logged force of the last velocity tick contains Ti as well.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IntegralTimeMismatch {
    /// Relative deviation of the true time from the declared one.
    pub percent: f64,
}

impl IntegralTimeMismatch {
    /// True time divided by the declared one.
    #[must_use]
    pub fn factor(&self) -> f64 {
        1.0 + 0.01 * self.percent
    }
}

impl EffectModel for IntegralTimeMismatch {
    const NAME: &'static str = "integral_time_mismatch";
    const SUMMARY: &'static str = "deviation of the true Ti from the declared one";
    const DRIVES: &'static [Drive] = &[Drive::Torque];

    relative_deviation!(step 0.5, limits [-90.0, 400.0]);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        let has_integral = axis.controller.velocity_integral_time_s.is_some();
        Prerequisite::needs(has_integral, "velocity_integral_time_s in the machine file")
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let what = "this effect only where velocity_integral_time_s is given";
        place.axis.controller.velocity_integral_time_s.is_none().then(|| Misplaced::name(what))
    }

    /// None where the setting has a tolerance: it is then fitted as a declared value.
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let has_integral = context.axis.controller.velocity_integral_time_s.is_some();
        let is_exact = context.axis.tolerance("velocity_integral_time_s") == 0.0;
        if context.has(Stage::Motor) && has_integral && is_exact { vec![Self::default()] } else { Vec::new() }
    }

    /// The slow part of the force, on which Ti acts, also contains the lag of the drive and friction near standstill, which
    /// resemble 1 to 2 % of Ti.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.percent.abs() > 3.0
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the setting of Ti is changed so that the drive has the declared one")
    }

    fn sentence(&self, wording: &Wording) -> String {
        let how = wording.by_sign("above", "below");
        format!("the integral time of the velocity loop is {} {how} the declared one", wording.size(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
