//! Straightness: the guide of another axis is bent.

use files::format::significant;
use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Distinction, Draw, EffectCompensation, EffectContext, EffectModel, Neighbours,
    Occurrence, Parameter, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Tool += coefficient × (table position of the source axis)².
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Straightness {
    /// Coefficient, µm per m².
    pub um_per_m2: f64,
    /// The axis whose guide is bent.
    pub source: String,
}

impl Straightness {
    /// Tool − table, m, at a table position of the source axis.
    #[must_use]
    pub fn offset_m(&self, source_table_m: f64) -> f64 {
        1e-6 * self.um_per_m2 * source_table_m * source_table_m
    }
}

impl EffectModel for Straightness {
    const NAME: &'static str = "straightness";
    const SUMMARY: &'static str = "tool += coefficient × (position of the source axis)²";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("um_per_m2", Unit::MicrometrePerSquareMetre, Range::Signed)];
    const NAMED_KEYS: &'static [(&'static str, &'static str)] = &[("source", "name of another axis")];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];
    const DRAW_NUMBER: Option<u32> = Some(11);

    fn prerequisite(_axis: &Settings, neighbours: Neighbours) -> Prerequisite {
        Prerequisite::another_axis(neighbours)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let start = |source: &String| Self { um_per_m2: 0.0, source: source.clone() };
        context.others.iter().map(start).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_per_m2, 20.0, 1e7)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_per_m2: x[0], ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.um_per_m2]
    }

    fn distinction(&self) -> Distinction<'_> {
        Distinction::Source(&self.source)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::OVER_OTHER_POSITION
    }

    fn sentence(&self, wording: &Wording) -> String {
        let near = significant(0.01 * self.um_per_m2.abs(), 2);
        format!(
            "the guide of axis {} is bent: the tool is displaced by {} ({near} {})",
            self.source,
            wording.value(0),
            wording.by_axis("µm at 100 mm", "mdeg at 100°")
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::OtherPosition(Some(self.source.clone()))
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { um_per_m2: draw.signed(200.0, 600.0), source: draw.other.to_owned() })
    }
}
