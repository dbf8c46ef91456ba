//! Gravity: the load of a rotary axis that turns a mass about a horizontal line.

use files::format::significant;
use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Misplaced, Neighbours, Occurrence,
    Parameter, Placement, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::{KeyNames, Settings};

/// A torque sine·sin q + cosine·cos q on the table of a rotary axis against motion in the + direction, q its position.
///
/// Of a mass m at a distance r whose arm is horizontal at q₀, it is m·g·r·cos(q − q₀): sine = m·g·r·sin q₀, cosine = m·g·r·cos q₀.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gravity {
    /// Torque at 90°.
    pub sine_n: f64,
    /// Torque at 0°.
    pub cosine_n: f64,
}

impl Gravity {
    /// Torque, N·m, at a position in 1000°, the metre of a rotary axis.
    #[must_use]
    #[inline]
    pub fn force_n(&self, position_kdeg: f64) -> f64 {
        let (sine, cosine) = libm::sincos((1e3 * position_kdeg).to_radians());
        self.sine_n * sine + self.cosine_n * cosine
    }
}

impl EffectModel for Gravity {
    const NAME: &'static str = "gravity";
    const SUMMARY: &'static str = "torque sine·sin q + cosine·cos q of a rotary axis against motion in + direction, q the position of the table";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("sine_n", Unit::Newton, Range::Signed),
        Parameter::new("cosine_n", Unit::Newton, Range::Signed),
    ];
    const IS_LINEAR: bool = true;
    const CONTAINS: &'static [&'static str] = &["constant_load", "position_load"];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force, Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        if axis.names == KeyNames::Rotary { Prerequisite::masses(axis) } else { Prerequisite::NotApplicable }
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let is_linear = place.axis.names == KeyNames::Linear;
        is_linear.then(|| Misplaced::name("this effect only on a rotary axis"))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let may_be = context.axis.names == KeyNames::Rotary && context.axis.has_mass();
        if may_be { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        [self.sine_n, self.cosine_n].map(|value| Coordinate::signed(value, 1.0, 1e5)).to_vec()
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { sine_n: x[0], cosine_n: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.sine_n, self.cosine_n]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::LOAD
    }

    fn sentence(&self, wording: &Wording) -> String {
        let most = libm::hypot(self.sine_n, self.cosine_n);
        let at_deg = libm::atan2(self.sine_n, self.cosine_n).to_degrees();
        format!(
            "gravity loads the axis with {} N·m at 90° and {} N·m at 0°: at most {} N·m, at {}°",
            wording.number(0),
            wording.number(1),
            significant(most, 3),
            significant(at_deg, 3)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Position
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arm that is horizontal at 30°: m·g·r·cos(q − 30°) of 10 N·m is 5·sin q + 8.66·cos q; 10 at 30°, none at 120° and −10 at 210°.
    #[test]
    fn the_load_is_that_of_an_arm() {
        let gravity = Gravity { sine_n: 5.0, cosine_n: 10.0 * 0.75f64.sqrt() };
        for (deg, expected) in [(30.0, 10.0), (120.0, 0.0), (210.0, -10.0), (-60.0, 0.0)] {
            assert!((gravity.force_n(1e-3 * deg) - expected).abs() < 1e-12, "{deg}");
        }
    }
}
