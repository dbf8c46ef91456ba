//! In-talk: displacement of the tool proportional to the acceleration of the same axis.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Draw, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext,
    Occurrence, Parameter, Range, Stage, Unit, Wording,
};

/// Tool − table = coefficient · acceleration of the same axis; Nguyen, Weikert, Wegener, equations (7) to (9).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intalk {
    /// Coefficient, µm per m/s².
    pub um_s2_per_m: f64,
}

impl Intalk {
    /// Tool − table, m, at an acceleration of the table.
    #[must_use]
    pub fn offset_m(&self, acceleration_m_per_s2: f64) -> f64 {
        1e-6 * self.um_s2_per_m * acceleration_m_per_s2
    }
}

impl EffectModel for Intalk {
    const NAME: &'static str = "intalk";
    const SUMMARY: &'static str = "tool − table, proportional to the acceleration of the same axis";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("um_s2_per_m", Unit::MicrometrePerAcceleration, Range::Signed)];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];
    const DRAW_NUMBER: Option<u32> = Some(8);

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(_context: &EffectContext<'_>) -> Vec<Self> {
        vec![Self::default()]
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_s2_per_m, 0.1, 1e3)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_s2_per_m: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.um_s2_per_m]
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let stretch = context.hides_stretch().then_some(Imitation::STRETCH);
        stretch.into_iter().chain(context.displaced_head(Some(self.offset_m(1.0)))).collect()
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the displacement by the commanded acceleration is subtracted")
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the tool is displaced by {} of the axis's own acceleration", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { um_s2_per_m: draw.signed(0.8, 3.0) })
    }
}
