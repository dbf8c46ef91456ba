//! Pitch map: any error of the screw over the position.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, AnyEffect, Coordinate, EffectCompensation, EffectContext, EffectModel, Imitation,
    ImitationContext, KeptPart, Misplaced, Occurrence, Parameter, PeriodicError, Placement, Range,
    ResidualShape, Stage, Unit, Wording, knots,
};
use super::pitch_progressive::PitchProgressive;
use crate::position_curve::PositionCurve;

/// Table = motor + error(motor): the error is given at positions of the motor, with a natural cubic spline between them,
/// and is constant beyond them.
///
/// If the ways differ, `error_um` is that of motion in + direction and `error_negative_um` that in − direction. The table
/// then follows the mean of both with a gap of the width w = `error_negative_um` − `error_um`, in addition to that of a
/// [`Backlash`](super::Backlash): in + direction the table lags the mean by w/2, in − direction it leads by w/2. After a
/// reversal the motor crosses the gap, so that the position remains continuous. A width below zero counts as zero.
///
/// Mean and slope of the mean error over the knots are not fitted, as they are the zero of the scale and a
/// [`PitchProgressive`]; nor is the mean width, which is that of the backlash.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchMap {
    /// Positions of the motor, increasing.
    pub positions_mm: Vec<f64>,
    /// Table − motor at each position, in + direction.
    pub error_um: Vec<f64>,
    /// The error in − direction, µm; absent: as in + direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_negative_um: Option<Vec<f64>>,
}

/// Largest amplitude of a remainder, as a fraction of the map's peak-to-peak error. A cubic spline with knots at the distance h
/// leaves at most 5/384·(2πh/P)⁴ of a wave of the period P (C. A. Hall and W. W. Meyer, 1976): 8 % with four knots a wave.
const MAX_REMAINDER: f64 = 0.02;

impl PitchMap {
    /// A map of zeros with evenly spaced knots over a travel (mm), with one curve or one for each direction.
    #[must_use]
    pub fn without_error(travel_mm: [f64; 2], knots: u32, differ: bool) -> Self {
        let positions_mm = knots::positions_mm(travel_mm, knots);
        let error_um = vec![0.0; positions_mm.len()];
        Self { error_negative_um: differ.then(|| error_um.clone()), error_um, positions_mm }
    }

    /// Mean error of both directions, m, over the position, m.
    #[must_use]
    pub fn mean_error(&self) -> PositionCurve {
        PositionCurve::over_mm(&self.positions_mm, &self.mean_um(), 1e-6)
    }

    /// Width of the gap, m, over the position, m; empty if the directions do not differ.
    #[must_use]
    pub fn width(&self) -> PositionCurve {
        self.width_um().map_or_else(PositionCurve::default, |width_um| {
            PositionCurve::over_mm(&self.positions_mm, &width_um, 1e-6)
        })
    }

    /// These curves with this number of evenly spaced knots.
    #[must_use]
    pub fn with_knots(&self, count: u32) -> Self {
        let [Some(&first), Some(&last)] = [self.positions_mm.first(), self.positions_mm.last()] else {
            return self.clone();
        };
        let positions_mm = knots::positions_mm([first, last], count);
        let resampled = |values: &Vec<f64>| knots::resampled(&self.positions_mm, values, &positions_mm);
        let error_um = resampled(&self.error_um);
        Self { error_negative_um: self.error_negative_um.as_ref().map(resampled), error_um, positions_mm }
    }

    fn mean_um(&self) -> Vec<f64> {
        match &self.error_negative_um {
            None => self.error_um.clone(),
            Some(negative) => self.error_um.iter().zip(negative).map(|(a, b)| 0.5 * (a + b)).collect(),
        }
    }

    fn width_um(&self) -> Option<Vec<f64>> {
        let negative = self.error_negative_um.as_ref()?;
        Some(negative.iter().zip(&self.error_um).map(|(negative, positive)| negative - positive).collect())
    }
}

impl EffectModel for PitchMap {
    const NAME: &'static str = "pitch_map";
    const SUMMARY: &'static str = "error of the screw at given positions, with a natural cubic spline between them and constant beyond; where the directions of travel differ, a gap of width error_negative − error; mean, slope and mean width are not fitted";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::list("positions_mm", Unit::Millimetre, Range::Signed),
        Parameter::list("error_um", Unit::Micrometre, Range::Signed),
        Parameter::list("error_negative_um", Unit::Micrometre, Range::Signed),
    ];
    const IS_LINEAR: bool = true;
    const CONTAINS: &'static [&'static str] = &["pitch_progressive"];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];

    fn misplaced(&self, _place: &Placement<'_>) -> Option<Misplaced> {
        let negative = self.error_negative_um.as_deref().map(|negative| ("error_negative_um", negative));
        let lists: Vec<_> = std::iter::once(("error_um", &self.error_um[..])).chain(negative).collect();
        let refused = knots::refused(&self.positions_mm, &lists);
        refused.map(|(key, expected)| Misplaced { key, expected })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if !context.has(Stage::Table) {
            return Vec::new();
        }
        let guess = |count: u32, differ: bool| Self::without_error(context.travel_mm, count, differ);
        // A gap of varying width needs a backlash: its own mean width is zero.
        let each_way = context.residual.pitch_knots_each_way.filter(|_| context.count("backlash") > 0);
        let both = context.residual.pitch_knots.map(|count| guess(count, false));
        both.into_iter().chain(each_way.map(|count| guess(count, true))).collect()
    }

    /// Mean error, and width if the ways differ.
    fn coordinates(&self) -> Vec<Coordinate> {
        let coordinate = |&value: &f64| Coordinate::signed(value, 0.2, 1e5);
        let (mean_um, width_um) = (self.mean_um(), self.width_um().unwrap_or_default());
        let free = [KeptPart::Line.free(&mean_um), KeptPart::Mean.free(&width_um)].concat();
        free.iter().map(coordinate).collect()
    }

    fn at(&self, x: &[f64]) -> Self {
        let positions = &self.positions_mm;
        let mean_um = self.mean_um();
        let (mean, width) = x.split_at(KeptPart::Line.free(&mean_um).len().min(x.len()));
        let mean_um = KeptPart::Line.with(positions, &mean_um, mean);
        let Some(width_um) = self.width_um() else { return Self { error_um: mean_um, ..self.clone() } };
        let width_um = KeptPart::Mean.with(positions, &width_um, width);
        let edge =
            |sign: f64| mean_um.iter().zip(&width_um).map(move |(mean, width)| mean + sign * 0.5 * width);
        Self {
            positions_mm: positions.clone(),
            error_um: edge(-1.0).collect(),
            error_negative_um: Some(edge(1.0).collect()),
        }
    }

    /// Motor and scale alone do not tell an error of the screw from one of the scale. The latter is the same both ways.
    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let is_one_curve = self.error_negative_um.is_none();
        if is_one_curve && !context.tool_follows_scale { vec![Imitation::SCALE] } else { Vec::new() }
    }

    fn values(&self) -> Vec<f64> {
        let negative = self.error_negative_um.as_deref().unwrap_or_default();
        [&self.positions_mm[..], &self.error_um, negative].concat()
    }

    fn lengths(&self) -> Vec<usize> {
        let negative = self.error_negative_um.as_ref().map_or(0, Vec::len);
        vec![self.positions_mm.len(), self.error_um.len(), negative]
    }

    /// A map has no slope of its own, and a screw with an error over the position rarely has none. The slope is dropped again if its
    /// interval contains zero.
    fn added_with(&self) -> Option<AnyEffect> {
        Some(AnyEffect::new(PitchProgressive::default()))
    }

    fn refined(&self, residual: &dyn Fn() -> ResidualShape) -> Option<Self> {
        let count = knots::refined(self.positions_mm.len(), || residual().pitch_knots)?;
        Some(self.with_knots(count))
    }

    fn describes_any_shape_of(&self) -> Option<Stage> {
        Some(Stage::Table)
    }

    fn depends_on_direction(&self) -> bool {
        self.error_negative_um.is_some()
    }

    /// A wave, longer than half the distance of the knots, that is no larger than what the map leaves between its knots: a remainder
    /// that is zero at the knots, with the period of their distance, times the wave of the screw.
    fn leaves(&self, wave: PeriodicError) -> bool {
        let spacing_mm = self.positions_mm.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        let size_um = numerics::peak_to_peak(self.error_um.iter().copied());
        wave.period_mm > 0.5 * spacing_mm && wave.amplitude_um.abs() < MAX_REMAINDER * size_um
    }

    fn over_position(&self) -> Option<&[f64]> {
        Some(&self.positions_mm)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::OVER_POSITION
    }

    fn sentence(&self, wording: &Wording) -> String {
        let count = self.positions_mm.len();
        let size = match self.error_negative_um {
            None => wording.peak_to_peak(count..2 * count),
            Some(_) => format!(
                "{} in + and {} in − direction,",
                wording.peak_to_peak(count..2 * count),
                wording.peak_to_peak(2 * count..3 * count)
            ),
        };
        format!(
            "the {} has an error over position: {size} peak to peak from {} to {} ({count} knots)",
            wording.by_axis("screw's pitch", "gear's transmission"),
            wording.value(0),
            wording.value(count - 1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Position
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4 knots and half as many are 6; 30 and half as many would be 45.
    #[test]
    fn a_map_is_refined_by_half_as_many_knots_up_to_the_finest() {
        let refined = |knots: u32, asked| {
            let residual = || ResidualShape { pitch_knots: asked, ..ResidualShape::default() };
            let map = PitchMap::without_error([0.0, 100.0], knots, false);
            map.refined(&residual).map(|map| map.positions_mm.len())
        };
        assert_eq!(refined(4, None), None);
        assert_eq!(refined(4, Some(3)), Some(6));
        assert_eq!(refined(4, Some(12)), Some(12));
        assert_eq!(refined(30, Some(12)), None);
    }

    /// A straight line is its own spline: 0, 2, 4 µm at −10, 0, 10 mm are 0, 1, 2, 3, 4 µm at five knots.
    #[test]
    fn a_map_keeps_its_curves_with_other_knots() {
        let map = PitchMap {
            positions_mm: vec![-10.0, 0.0, 10.0],
            error_um: vec![0.0, 2.0, 4.0],
            error_negative_um: Some(vec![1.0, 1.0, 1.0]),
        };
        let finer = map.with_knots(5);
        assert_eq!(finer.positions_mm, [-10.0, -5.0, 0.0, 5.0, 10.0]);
        let deviation = finer.error_um.iter().zip([0.0, 1.0, 2.0, 3.0, 4.0]).map(|(a, b)| (a - b).abs());
        assert!(deviation.fold(0.0, f64::max) < 1e-12);
        assert!(finer.error_negative_um.unwrap().iter().all(|value| (value - 1.0).abs() < 1e-12));
    }
}
