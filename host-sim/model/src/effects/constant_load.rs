//! Constant load: gravity, a counterbalance, or Coulomb friction that differs between the directions of motion.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Draw, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext,
    Neighbours, Occurrence, Parameter, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// A constant force F on the table against motion in the + direction.
///
/// The force needed to move is Coulomb friction + F in + direction and Coulomb friction − F in − direction. While the
/// axis moves, the load is therefore equivalent to a difference of 2F between the Coulomb friction of both directions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantLoad {
    /// F. Positive: the drive force is higher in + direction.
    pub force_n: f64,
}

impl EffectModel for ConstantLoad {
    const NAME: &'static str = "constant_load";
    const SUMMARY: &'static str = "constant force F against motion in + direction; friction is Coulomb + F in + direction, Coulomb − F in − direction";
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

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        // An offset of the log does not act on the machine: the loop would need no force against it.
        if context.has(Stage::Motor) { Vec::new() } else { vec![Imitation::FORCE_OFFSET] }
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::LOAD
    }

    fn sentence(&self, wording: &Wording) -> String {
        let direction = wording.by_sign("+", "−");
        format!("a constant load of {} opposes motion in {direction} direction", wording.size(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { force_n: draw.signed(100.0, 300.0) })
    }
}
