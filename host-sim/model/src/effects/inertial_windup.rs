//! Wind-up under acceleration, for an axis whose masses, stiffness and force are not known.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext,
    Misplaced, Neighbours, Occurrence, Parameter, Placement, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Motor − table = stretch · acceleration of the motor: the mass that is moved, divided by the stiffness of the drive train. Of a
/// stepper motor without an encoder, its load angle under acceleration is part of it. In machine files the name is `windup` as well;
/// the key `um_s2_per_m` distinguishes this effect.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InertialWindup {
    /// Lag of the table per acceleration.
    pub um_s2_per_m: f64,
}

impl InertialWindup {
    /// Lag of the table per acceleration, m per m/s².
    #[must_use]
    pub fn stretch_s2(&self) -> f64 {
        1e-6 * self.um_s2_per_m
    }
}

impl EffectModel for InertialWindup {
    const NAME: &'static str = "windup";
    const DISTINGUISHING_KEY: Option<&'static str> = Some("um_s2_per_m");
    const SUMMARY: &'static str = "deflection of the drive train in proportion to the acceleration, where masses, stiffness and force are not known";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("um_s2_per_m", Unit::MicrometrePerAcceleration, Range::NotNegative)];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        if axis.has_drive_train() { Prerequisite::NotApplicable } else { Prerequisite::Met }
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let expected = "no such key, as masses or stiffness are given".to_owned();
        place.axis.has_drive_train().then_some(Misplaced { key: "um_s2_per_m", expected })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_shown = context.has(Stage::Table) && context.hides_windup();
        let sizes: &[f64] = if is_shown { &[0.0, 0.5, 2.0, 8.0] } else { &[] };
        sizes.iter().map(|&um_s2_per_m| Self { um_s2_per_m }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        // The lower bound is not a limit of the search: at zero there is no effect.
        let free = Coordinate::between(self.um_s2_per_m, 0.05, 0.0, 1e5);
        vec![Coordinate { limits: [f64::NEG_INFINITY, 1e5], ..free }]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_s2_per_m: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.um_s2_per_m]
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        context.displaced_head(Some(self.stretch_s2())).into_iter().collect()
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the stretch follows the acceleration, for which the model has neither masses nor stiffness",
            "declare the masses and the stiffness and trace again",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the table lags the motor by {} under acceleration", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
