//! Quadratic drag: air that way covers, bellows or a fast rotor press out or stir.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Neighbours, Occurrence, Parameter,
    Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// A force on the table against its motion that grows with the square of the velocity: turbulent flow.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuadraticDrag {
    /// Force at 1 m/s; of a rotary axis at 1000°/s.
    pub force_n: f64,
}

impl QuadraticDrag {
    /// Force against the motion, N, at a velocity: c·v·|v|.
    #[must_use]
    #[inline]
    pub fn resistance_n(&self, velocity_m_per_s: f64) -> f64 {
        self.force_n * velocity_m_per_s * velocity_m_per_s.abs()
    }
}

impl EffectModel for QuadraticDrag {
    const NAME: &'static str = "quadratic_drag";
    const SUMMARY: &'static str = "force against the motion that grows with the square of the velocity, given at 1 m/s (rotary: 1000°/s)";
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("force_n", Unit::Newton, Range::NotNegative)];
    // The derivative of the force is v·|v|, whatever the force.
    const IS_LINEAR: bool = true;
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];

    fn prerequisite(_axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::WITHOUT_TABLE
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if context.shows_friction_alone() { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::between(self.force_n, 1.0, 0.0, 1e6)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { force_n: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.force_n]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the force feed-forward has no force that grows with the square of the velocity",
            "vent the way covers, or move more slowly",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "a drag grows with the square of the velocity: {} at {}",
            wording.value(0),
            wording.by_axis("1 m/s", "1000°/s")
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }
}
