//! Viscous friction that depends on the direction of motion.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Draw, EffectCompensation, EffectContext, EffectModel, Neighbours, Occurrence,
    Parameter, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Viscous friction b + h for v > 0 and b − h for v < 0.
///
/// A difference of Coulomb friction between the directions is equivalent to a constant load while the axis moves, and is
/// reported as [`ConstantLoad`](super::ConstantLoad).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionAsymmetry {
    /// h.
    pub half_difference_n_s_per_m: f64,
}

impl FrictionAsymmetry {
    /// Force added to symmetric viscous friction, N: h·|v|, with the same sign for both directions.
    #[must_use]
    #[inline]
    pub fn force_n(&self, velocity_m_per_s: f64) -> f64 {
        self.half_difference_n_s_per_m * velocity_m_per_s.abs()
    }
}

impl EffectModel for FrictionAsymmetry {
    const NAME: &'static str = "friction_asymmetry";
    const SUMMARY: &'static str = "viscous friction b + h for v > 0, b − h for v < 0";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("half_difference_n_s_per_m", Unit::NewtonSecondPerMetre, Range::Signed)];
    const PART_OF_DECLARED: &'static [&'static str] = &["constant_load"];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force, Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(5);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::masses(axis)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if context.axis.has_mass() { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.half_difference_n_s_per_m, 5.0, 1e5)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { half_difference_n_s_per_m: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.half_difference_n_s_per_m]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::FRICTION
    }

    fn sentence(&self, wording: &Wording) -> String {
        let [higher, lower] = if self.half_difference_n_s_per_m >= 0.0 { ["+", "−"] } else { ["−", "+"] };
        let size = wording.size(0);
        format!(
            "viscous friction is {size} higher in {higher} direction and lower by the same amount in {lower} direction"
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { half_difference_n_s_per_m: draw.signed(150.0, 350.0) })
    }
}
