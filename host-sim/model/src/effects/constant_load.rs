//! Constant load: gravity, a counterbalance, or a difference of Coulomb friction while moving.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Draw, EffectContext, EffectModel, Neighbours, Occurrence, Parameter, Prerequisite,
    Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// A constant force on the table that opposes motion in the + direction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantLoad {
    /// Positive: the drive pushes harder in the + direction.
    pub force_n: f64,
}

impl EffectModel for ConstantLoad {
    const NAME: &'static str = "constant_load";
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("force_n", Unit::Newton, Range::Signed)];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force, Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(7);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::masses(axis)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if context.axis.has_mass() { vec![Self { force_n: 0.0 }] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.force_n, 1.0, 1e5)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { force_n: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.force_n]
    }

    fn sentence(&self, wording: &Wording) -> String {
        let direction = wording.by_sign("+", "−");
        format!("a constant load of {} against motion in {direction} direction", wording.size(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { force_n: draw.signed(100.0, 300.0) })
    }
}
