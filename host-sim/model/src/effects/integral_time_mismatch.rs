//! Integral time mismatch: the integral time of the velocity loop deviates from the declared one.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectContext, EffectModel, Misplaced, Neighbours, Occurrence, Parameter,
    Placement, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

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
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("percent", Unit::Percent, Range::Above(-100.0))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        let has_integral = axis.controller.velocity_integral_time_s.is_some();
        Prerequisite::needs(has_integral, "velocity_integral_time_s in the machine file")
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let what = "this effect only where velocity_integral_time_s is given";
        place.axis.controller.velocity_integral_time_s.is_none().then(|| Misplaced::name(what))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let has_integral = context.axis.controller.velocity_integral_time_s.is_some();
        if context.has(Stage::Motor) && has_integral { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::between(self.percent, 0.5, -90.0, 400.0)]
    }

    /// The slow part of the force, on which Ti acts, also contains the lag of the drive and friction near standstill, which
    /// resemble 1 to 2 % of Ti.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.percent.abs() > 3.0
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { percent: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.percent]
    }

    fn sentence(&self, wording: &Wording) -> String {
        let how = wording.by_sign("above", "below");
        format!("the integral time of the velocity loop is {} {how} the declared one", wording.size(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
