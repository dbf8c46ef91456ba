//! Squareness: the angle between two axes is not a right angle.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Draw, EffectCompensation, EffectContext, EffectModel, Misplaced, Neighbours,
    Occurrence, Parameter, Placement, Prerequisite, Range, SlopeOf, Stage, Unit, Wording,
};

use crate::axis::Settings;

/// Tool x += coefficient × table y. Reported for x, the machine's first axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Squareness {
    /// Coefficient, µm of x per m of y.
    pub um_per_m: f64,
}

impl Squareness {
    /// Tool − table, m, at a table position of the other axis.
    #[must_use]
    pub fn offset_m(&self, other_table_m: f64) -> f64 {
        1e-6 * self.um_per_m * other_table_m
    }
}

impl EffectModel for Squareness {
    const NAME: &'static str = "squareness";
    const SUMMARY: &'static str = "tool x += coefficient × table y (x: the first of two axes)";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("um_per_m", Unit::MicrometrePerMetre, Range::Signed)];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];
    const DRAW_NUMBER: Option<u32> = Some(10);

    fn prerequisite(_axis: &Settings, neighbours: Neighbours) -> Prerequisite {
        let is_first_of_two = neighbours.is_first && neighbours.others == 1;
        Prerequisite::needs(is_first_of_two, "the first of two axes")
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        (place.axes < 2).then(|| Misplaced::name("this effect only on a machine with another axis"))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if context.first && context.others.len() == 1 { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_per_m, 5.0, 1e5)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_per_m: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.um_per_m]
    }

    fn slope(&self) -> Option<SlopeOf> {
        Some(SlopeOf::Axes)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::OVER_OTHER_POSITION
    }

    fn sentence(&self, wording: &Wording) -> String {
        let unit = wording.by_axis("µm per m", "ppm");
        format!(
            "the axes are out of square: the tool is displaced by {} {unit} of the other axis's travel",
            wording.number(0)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::OtherPosition(None)
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { um_per_m: draw.signed(40.0, 120.0) })
    }
}
