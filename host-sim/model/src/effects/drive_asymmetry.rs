//! Drive asymmetry: the drive gives more force in one direction than in the other.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Occurrence, Parameter, Range,
    Stage, Unit, Wording,
};
use crate::axis::Settings;

/// In one direction the acting force is percent/100 below the commanded one: amplifiers whose gain differs between directions,
/// or a current sensor with unequal halves. The logged force is the commanded one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveAsymmetry {
    /// Part of the force that is missing: positive in + direction, negative in − direction.
    pub percent: f64,
}

impl DriveAsymmetry {
    /// Acting force, N, under a commanded one.
    #[must_use]
    #[inline]
    pub fn acting_n(&self, commanded_n: f64) -> f64 {
        commanded_n * self.part(commanded_n)
    }

    /// Commanded force, N, of an acting one.
    #[must_use]
    #[inline]
    pub fn commanded_n(&self, acting_n: f64) -> f64 {
        acting_n / self.part(acting_n)
    }

    /// Part of the commanded force that acts in the direction of a force.
    fn part(&self, force_n: f64) -> f64 {
        if force_n * self.percent > 0.0 { 1.0 - 0.01 * self.percent.abs() } else { 1.0 }
    }
}

impl EffectModel for DriveAsymmetry {
    const NAME: &'static str = "drive_asymmetry";
    const SUMMARY: &'static str =
        "force that is missing in one direction: + direction if positive, − direction if negative";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("percent", Unit::Percent, Range::Within(LIMIT_PERCENT))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_shown = context.axis.has_mass() && context.has(Stage::Force);
        let guesses: &[f64] = if is_shown { &[4.0, -4.0] } else { &[] };
        guesses.iter().map(|&percent| Self { percent }).collect()
    }

    /// The direction is that of the initial guess: the law has a kink at zero.
    fn coordinates(&self) -> Vec<Coordinate> {
        let [least, most] = if self.percent < 0.0 { [-LIMIT_PERCENT, 0.0] } else { [0.0, LIMIT_PERCENT] };
        vec![Coordinate::between(self.percent, 0.5, least, most)]
    }

    /// The gains of both directions of a drive agree to one percent.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.percent.abs() > 0.5
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { percent: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.percent]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the gains of the drive differ between both directions",
            "adjust the current measurement of the drive",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        let direction = wording.by_sign("+", "−");
        format!("the force of the drive is {} below its command in {direction} direction", wording.size(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Force
    }
}

/// Largest asymmetry, percent.
const LIMIT_PERCENT: f64 = 50.0;
