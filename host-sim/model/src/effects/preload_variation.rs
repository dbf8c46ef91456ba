//! Preload variation: friction that varies along the travel.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Neighbours, Occurrence, Parameter,
    Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Adds slope·(x − centre) + curvature·(x − centre)² to the sliding level: the preload between screw and nut, or between
/// guide and carriage, depends on the position.
///
/// x is the reading of the motor encoder. If the encoder's zero shifts between recordings, `centre_mm` shifts with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreloadVariation {
    /// Position at which friction is the declared one. Not fitted: the middle of the logged travel.
    pub centre_mm: f64,
    /// Slope; positive: friction increases in + direction.
    pub slope_n_per_m: f64,
    /// Curvature; positive: friction increases towards both ends.
    pub curvature_n_per_m2: f64,
}

impl PreloadVariation {
    /// Change of the sliding level, N, at a position.
    #[must_use]
    #[inline]
    pub fn rise_n(&self, position_m: f64) -> f64 {
        let from_centre_m = position_m - 1e-3 * self.centre_mm;
        from_centre_m * (self.slope_n_per_m + from_centre_m * self.curvature_n_per_m2)
    }

    /// Whether slope or curvature is not zero.
    #[must_use]
    #[inline]
    pub fn varies(&self) -> bool {
        self.slope_n_per_m != 0.0 || self.curvature_n_per_m2 != 0.0
    }
}

impl EffectModel for PreloadVariation {
    const NAME: &'static str = "preload_variation";
    const SUMMARY: &'static str = "friction changes by slope·(x − c) + curvature·(x − c)²; c is not fitted and shifts with the encoder's zero";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("centre_mm", Unit::Millimetre, Range::Signed),
        Parameter::new("slope_n_per_m", Unit::NewtonPerMetre, Range::Signed),
        Parameter::new("curvature_n_per_m2", Unit::NewtonPerSquareMetre, Range::Signed),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];

    fn prerequisite(_axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::WITHOUT_TABLE
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let [least, most] = context.travel_mm;
        let centre_mm = 0.5 * (least + most);
        if context.shows_friction_alone() { vec![Self { centre_mm, ..Self::default() }] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::signed(self.slope_n_per_m, 1.0, 1e6),
            Coordinate::signed(self.curvature_n_per_m2, 10.0, 1e8),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { slope_n_per_m: x[0], curvature_n_per_m2: x[1], ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.centre_mm, self.slope_n_per_m, self.curvature_n_per_m2]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::FRICTION
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "friction varies along the travel about {}: slope {}, curvature {}",
            wording.value(0),
            wording.value(1),
            wording.value(2)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Position
    }
}
