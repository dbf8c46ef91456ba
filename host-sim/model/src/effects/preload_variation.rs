//! Preload variation: friction that changes along the travel.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectContext, EffectModel, Neighbours, Occurrence, Parameter, Prerequisite, Range,
    Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Adds slope·(x − centre) + curvature·(x − centre)² to the sliding level: screw and nut or guide and
/// carriage are tighter at one place than at another.
///
/// Place is what the motor's encoder reads: where its zero moves between recordings, `centre_mm` moves
/// with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreloadVariation {
    /// Where the declared level holds; not fitted: the middle of the travel that was logged.
    pub centre_mm: f64,
    /// Towards + direction.
    pub slope_n_per_m: f64,
    /// Towards both ends.
    pub curvature_n_per_m2: f64,
}

impl PreloadVariation {
    /// Change of the sliding level (N) at a place.
    #[must_use]
    #[inline]
    pub fn rise_n(&self, place_m: f64) -> f64 {
        let from_centre_m = place_m - 1e-3 * self.centre_mm;
        from_centre_m * (self.slope_n_per_m + from_centre_m * self.curvature_n_per_m2)
    }

    /// Whether there is any.
    #[must_use]
    #[inline]
    pub fn varies(&self) -> bool {
        self.slope_n_per_m != 0.0 || self.curvature_n_per_m2 != 0.0
    }
}

impl EffectModel for PreloadVariation {
    const NAME: &'static str = "preload_variation";
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

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "friction changes along the travel, from the middle at {} by {} and {}",
            wording.value(0),
            wording.value(1),
            wording.value(2)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Position
    }
}
