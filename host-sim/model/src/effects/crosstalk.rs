//! Cross-talk: displacement of the tool proportional to the acceleration of another axis.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Distinction, Draw, EffectCompensation, EffectContext, EffectModel, Imitation,
    ImitationContext, Neighbours, Occurrence, Parameter, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Tool − table = coefficient · acceleration of another axis; Nguyen, Weikert, Wegener, equations (7) to (9).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crosstalk {
    /// Coefficient, µm per m/s².
    pub um_s2_per_m: f64,
    /// The axis whose table accelerates.
    pub source: String,
}

impl Crosstalk {
    /// Tool − table, m, at an acceleration of the source axis's table.
    #[must_use]
    pub fn offset_m(&self, source_acceleration_m_per_s2: f64) -> f64 {
        1e-6 * self.um_s2_per_m * source_acceleration_m_per_s2
    }
}

impl EffectModel for Crosstalk {
    const NAME: &'static str = "crosstalk";
    const SUMMARY: &'static str = "tool − table, proportional to the acceleration of the source axis";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("um_s2_per_m", Unit::MicrometrePerAcceleration, Range::Signed)];
    const NAMED_KEYS: &'static [(&'static str, &'static str)] = &[("source", "name of another axis")];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];
    const DRAW_NUMBER: Option<u32> = Some(9);

    fn prerequisite(_axis: &Settings, neighbours: Neighbours) -> Prerequisite {
        Prerequisite::another_axis(neighbours)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let start = |source: &String| Self { um_s2_per_m: 0.0, source: source.clone() };
        context.others.iter().map(start).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_s2_per_m, 0.1, 1e3)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_s2_per_m: x[0], ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.um_s2_per_m]
    }

    fn distinction(&self) -> Distinction<'_> {
        Distinction::Source(&self.source)
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        // Twice, as modes displace the tool by more near their frequencies.
        let is_turned = self.offset_m(1.0).abs() <= 2.0 * context.turned_s2;
        context.displaced_head(None).into_iter().chain(is_turned.then_some(Imitation::TURN)).collect()
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the displacement by the other axis's commanded acceleration is subtracted")
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the tool is displaced by {} of the acceleration of axis {}", wording.value(0), self.source)
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::OtherAcceleration(Some(self.source.clone()))
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { um_s2_per_m: draw.signed(0.8, 3.0), source: draw.other.to_owned() })
    }
}
