//! Stiffness map: stiffness between motor and table over the position.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext,
    KeptPart, Misplaced, Neighbours, Occurrence, Parameter, Placement, Prerequisite, Range, Stage, Unit,
    Wording, knots,
};
use crate::axis::Settings;
use crate::position_curve::PositionCurve;

/// Least compliance that a map leaves, as a part of the declared one. A spline may undershoot between its knots.
const LEAST_COMPLIANCE: f64 = 0.1;

/// Standard deviation of the compliance that is assumed where nothing is known, %.
const USUAL_PERCENT: f64 = 50.0;

/// Changes the compliance between motor and table, 1/k of the declared stiffness or of a wind-up, by a part of it that is given at
/// positions: a natural cubic spline between them, constant beyond them. Cause: the length of the screw between nut and bearing. A screw with one fixed bearing is
/// softer by 1/(E·A) per metre of that length; one with two is softest in the middle.
///
/// The mean over the knots between the outermost ones is not fitted, as it is that of the declared stiffness.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StiffnessMap {
    /// Positions of the motor, increasing.
    pub positions_mm: Vec<f64>,
    /// Change of the compliance at each position; positive: softer.
    pub compliance_percent: Vec<f64>,
}

impl StiffnessMap {
    /// The map of a compliance that is the same everywhere.
    #[must_use]
    pub fn constant(travel_mm: [f64; 2], knots: u32) -> Self {
        let positions_mm = knots::positions_mm(travel_mm, knots);
        Self { compliance_percent: vec![0.0; positions_mm.len()], positions_mm }
    }

    /// Change of the compliance, as a part of the declared one, over the position (m).
    #[must_use]
    pub fn curve(&self) -> PositionCurve {
        PositionCurve::over_mm(&self.positions_mm, &self.compliance_percent, 1e-2)
    }

    /// Compliance as a part of the declared one, for a change of it.
    #[must_use]
    #[inline]
    pub fn compliance(change: f64) -> f64 {
        (1.0 + change).max(LEAST_COMPLIANCE)
    }
}

impl EffectModel for StiffnessMap {
    const NAME: &'static str = "stiffness_map";
    const SUMMARY: &'static str = "change of the compliance between motor and table, given at positions with a natural cubic spline between them and constant beyond; its mean between the ends is not fitted";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::list("positions_mm", Unit::Millimetre, Range::Signed),
        Parameter::list("compliance_percent", Unit::Percent, Range::Signed),
    ];
    const IS_LINEAR: bool = true;
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        if !axis.has_mass() {
            return Prerequisite::NotApplicable;
        }
        Prerequisite::elastic(axis)
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        if place.axis.is_rigid() && !place.has_structure {
            let what = "this effect only where stiffness_n_per_um is given: a rigid axis has no compliance";
            return Some(Misplaced::name(what));
        }
        let refused = knots::refused(&self.positions_mm, &[("compliance_percent", &self.compliance_percent)]);
        refused.map(|(key, expected)| Misplaced { key, expected })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_elastic = context.axis.has_mass() && context.axis.mechanics.stiffness_n_per_um.is_some();
        let knots = context.residual.stiffness_knots.filter(|_| is_elastic);
        knots.into_iter().map(|count| Self::constant(context.travel_mm, count)).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let coordinate = |&value: &f64| Coordinate::signed(value, 2.0, 1e4);
        KeptPart::InnerMean.free(&self.compliance_percent).iter().map(coordinate).collect()
    }

    fn at(&self, x: &[f64]) -> Self {
        let compliance_percent = KeptPart::InnerMean.with(&self.positions_mm, &self.compliance_percent, x);
        Self { compliance_percent, ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        [&self.positions_mm[..], &self.compliance_percent].concat()
    }

    fn lengths(&self) -> Vec<usize> {
        vec![self.positions_mm.len(), self.compliance_percent.len()]
    }

    /// A fit without a fold knows nothing of positions that only this fold contains.
    fn prior(&self, _declared: &Settings) -> Option<[f64; 2]> {
        Some([0.0, USUAL_PERCENT])
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        context.has_varying_gap.then_some(Imitation::VARYING_GAP).into_iter().collect()
    }

    fn over_position(&self) -> Option<&[f64]> {
        Some(&self.positions_mm)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the stretch that the controller adds to the command is that of one stiffness",
            "close the loop by the scale",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        let count = self.positions_mm.len();
        format!(
            "the compliance between motor and table varies over the position by {} of its mean peak to peak from {} to {} \
             ({count} knots)",
            wording.peak_to_peak(count..2 * count),
            wording.value(0),
            wording.value(count - 1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Position
    }
}
