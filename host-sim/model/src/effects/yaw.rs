//! Yaw: the carriage turns as the axis moves, and the position of another axis is the lever.

use files::format::significant;
use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Distinction, EffectCompensation, EffectContext, EffectModel, Neighbours,
    Occurrence, Parameter, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Tool += coefficient × table position × table position of the source axis.
///
/// The carriage turns by coefficient × table position, and the tool is as far from the centre as the source axis is from its zero. An
/// axis whose gain depends on the position of the other one does the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Yaw {
    /// Coefficient, µm per m of travel and m of lever, which is µrad per m of travel.
    pub um_per_m2: f64,
    /// The axis whose position is the lever.
    pub source: String,
}

impl Yaw {
    /// Tool − table, m, at table positions of the axis itself and of the source axis.
    #[must_use]
    pub fn offset_m(&self, table_m: f64, source_table_m: f64) -> f64 {
        1e-6 * self.um_per_m2 * table_m * source_table_m
    }
}

impl EffectModel for Yaw {
    const NAME: &'static str = "yaw";
    const SUMMARY: &'static str = "tool += coefficient × table position × position of the source axis, the lever of a carriage that turns as it moves";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("um_per_m2", Unit::MicrometrePerSquareMetre, Range::Signed)];
    const NAMED_KEYS: &'static [(&'static str, &'static str)] = &[("source", "name of another axis")];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

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
        EffectCompensation::by(
            "the displacement by the product of both positions is subtracted from the command",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        let near = significant(0.01 * self.um_per_m2.abs(), 2);
        format!(
            "the carriage turns as it moves (yaw), with the position of axis {} as the lever: the tool is displaced by {} ({near} {})",
            self.source,
            wording.value(0),
            wording.by_axis("µm where both are at 100 mm", "mdeg where both are at 100°")
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::OtherPosition(Some(self.source.clone()))
    }
}
