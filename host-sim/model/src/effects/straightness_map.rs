//! Straightness map: the guide of another axis deviates from a straight line in any way.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, AnyEffect, Coordinate, Distinction, EffectCompensation, EffectContext, EffectModel, KeptPart,
    Misplaced, Neighbours, Occurrence, Parameter, Placement, Prerequisite, Range, ResidualShape, Stage, Unit,
    Wording, knots,
};
use super::squareness::Squareness;
use crate::axis::Settings;
use crate::position_curve::PositionCurve;

/// Tool += error(table position of the source axis): the error is given at positions of the source, with a natural cubic spline
/// between them, and is constant beyond them.
///
/// The mean over the knots is not fitted, as it is the zero of the tool. Nor is the slope where an angle describes it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StraightnessMap {
    /// The axis whose guide is bent.
    pub source: String,
    /// Positions of the source axis, increasing.
    pub positions_mm: Vec<f64>,
    /// Tool − table at each position.
    pub error_um: Vec<f64>,
    /// What describes the slope in a fit. Not in files.
    #[serde(skip)]
    pub slope: SlopeOfMap,
}

/// Maps are equal if they displace the tool equally. What a fit changes of them is no part of that.
impl PartialEq for StraightnessMap {
    fn eq(&self, other: &Self) -> bool {
        let curve = |map: &Self| (map.source.clone(), map.positions_mm.clone(), map.error_um.clone());
        curve(self) == curve(other)
    }
}

/// What describes the slope of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlopeOfMap {
    /// An effect of the model, or it is known: a fit keeps it.
    #[default]
    Kept,
    /// The squareness of the axes, which is added with the map.
    Squareness,
    /// The map itself: no other effect of this axis does.
    Fitted,
}

impl StraightnessMap {
    /// A map of zeros with evenly spaced knots over the travel of the source (mm).
    #[must_use]
    pub fn without_error(source: &str, travel_mm: [f64; 2], count: u32, slope: SlopeOfMap) -> Self {
        let positions_mm = knots::positions_mm(travel_mm, count);
        Self { source: source.to_owned(), error_um: vec![0.0; positions_mm.len()], positions_mm, slope }
    }

    /// Tool − table, m, over the table position of the source, m.
    #[must_use]
    pub fn curve(&self) -> PositionCurve {
        PositionCurve::over_mm(&self.positions_mm, &self.error_um, 1e-6)
    }

    /// This curve with another number of evenly spaced knots.
    #[must_use]
    pub fn with_knots(&self, count: u32) -> Self {
        let [Some(&first), Some(&last)] = [self.positions_mm.first(), self.positions_mm.last()] else {
            return self.clone();
        };
        let positions_mm = knots::positions_mm([first, last], count);
        let error_um = knots::resampled(&self.positions_mm, &self.error_um, &positions_mm);
        Self { positions_mm, error_um, ..self.clone() }
    }

    const fn kept(&self) -> KeptPart {
        match self.slope {
            SlopeOfMap::Fitted => KeptPart::Mean,
            SlopeOfMap::Kept | SlopeOfMap::Squareness => KeptPart::Line,
        }
    }
}

impl EffectModel for StraightnessMap {
    const NAME: &'static str = "straightness_map";
    const SUMMARY: &'static str = "tool += error at given positions of the source axis, with a natural cubic spline between them and constant beyond; the mean is not fitted, nor the slope that a squareness describes";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::list("positions_mm", Unit::Millimetre, Range::Signed),
        Parameter::list("error_um", Unit::Micrometre, Range::Signed),
    ];
    const NAMED_KEYS: &'static [(&'static str, &'static str)] = &[("source", "name of another axis")];
    const IS_LINEAR: bool = true;
    const CONTAINS: &'static [&'static str] = &["straightness"];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

    fn prerequisite(_axis: &Settings, neighbours: Neighbours) -> Prerequisite {
        Prerequisite::another_axis(neighbours)
    }

    fn misplaced(&self, _place: &Placement<'_>) -> Option<Misplaced> {
        let refused = knots::refused(&self.positions_mm, &[("error_um", &self.error_um)]);
        refused.map(|(key, expected)| Misplaced { key, expected })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let slope = if context.first && context.others.len() == 1 {
            SlopeOfMap::Squareness
        } else if context.count("probe_rotation") > 0 {
            SlopeOfMap::Kept
        } else {
            SlopeOfMap::Fitted
        };
        let over = &context.residual.tool_over_others;
        over.iter().map(|one| Self::without_error(&one.source, one.travel_mm, one.knots, slope)).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        self.kept().free(&self.error_um).iter().map(|&value| Coordinate::signed(value, 0.2, 1e5)).collect()
    }

    fn at(&self, x: &[f64]) -> Self {
        let error_um = self.kept().with(&self.positions_mm, &self.error_um, x);
        Self { error_um, ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        [&self.positions_mm[..], &self.error_um].concat()
    }

    fn lengths(&self) -> Vec<usize> {
        vec![self.positions_mm.len(), self.error_um.len()]
    }

    fn added_with(&self) -> Option<AnyEffect> {
        (self.slope == SlopeOfMap::Squareness).then(|| AnyEffect::new(Squareness::default()))
    }

    fn refined(&self, residual: &dyn Fn() -> ResidualShape) -> Option<Self> {
        let asked = || {
            let over = residual().tool_over_others;
            over.iter().find(|one| one.source == self.source).map(|one| one.knots)
        };
        Some(self.with_knots(knots::refined(self.positions_mm.len(), asked)?))
    }

    fn distinction(&self) -> Distinction<'_> {
        Distinction::Source(&self.source)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::OVER_OTHER_POSITION
    }

    fn sentence(&self, wording: &Wording) -> String {
        let count = self.positions_mm.len();
        format!(
            "the guide of axis {} is not straight: the tool is displaced by {} peak to peak from {} to {} of its travel ({count} knots)",
            self.source,
            wording.peak_to_peak(count..2 * count),
            wording.value(0),
            wording.value(count - 1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::OtherPosition(Some(self.source.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(slope: SlopeOfMap) -> StraightnessMap {
        StraightnessMap {
            source: "y".to_owned(),
            positions_mm: vec![-10.0, 0.0, 10.0],
            error_um: vec![2.0, -1.0, -1.0],
            slope,
        }
    }

    /// Three knots with the sum 0 and the first moment −30 µm·mm. The middle one at −3 µm, with both kept: e₁ + e₃ = 3 and e₃ − e₁ = −3,
    /// so that the ends are 3 and 0. With a free slope the last one alone follows: 0 − 4 + 3 = −1.
    #[test]
    fn what_describes_the_slope_is_not_fitted_twice() {
        let kept = map(SlopeOfMap::Squareness);
        assert_eq!(kept.coordinates().len(), 1);
        let moved = kept.at(&[-3.0]).error_um;
        assert!(moved.iter().zip([3.0, -3.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{moved:?}");
        assert!(kept.added_with().is_some());
        let fitted = map(SlopeOfMap::Fitted);
        assert_eq!(fitted.coordinates().len(), 2);
        assert_eq!(fitted.at(&[4.0, -3.0]).error_um, [4.0, -3.0, -1.0]);
        assert!(fitted.added_with().is_none());
    }

    /// A straight line is its own spline, and the value beyond the ends is that of the end.
    #[test]
    fn the_curve_goes_through_the_knots_in_metres() {
        let curve = map(SlopeOfMap::Kept).curve();
        assert!((curve.value(-0.01) - 2e-6).abs() < 1e-18 && (curve.value(0.1) + 1e-6).abs() < 1e-18);
        assert_eq!(map(SlopeOfMap::Kept).with_knots(5).positions_mm, [-10.0, -5.0, 0.0, 5.0, 10.0]);
    }
}
