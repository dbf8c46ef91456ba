//! Friction map: friction over the position.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, KeptPart, Misplaced, Neighbours,
    Occurrence, Parameter, Placement, Prerequisite, Range, Stage, Unit, Wording, knots,
};
use crate::axis::Settings;
use crate::position_curve::PositionCurve;

/// Adds a force to the sliding level that is given at positions: a natural cubic spline between them, constant beyond
/// them. Cause: a guide or screw that is worn, dirty or misaligned over a part of the travel.
///
/// The mean over the knots is not fitted, as it is that of Coulomb friction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionMap {
    /// Positions of the table, increasing.
    pub positions_mm: Vec<f64>,
    /// Change of friction at each position.
    pub friction_n: Vec<f64>,
}

impl FrictionMap {
    /// Change of the sliding level (N) over the position (m).
    #[must_use]
    pub fn curve(&self) -> PositionCurve {
        PositionCurve::over_mm(&self.positions_mm, &self.friction_n, 1.0)
    }
}

impl EffectModel for FrictionMap {
    const NAME: &'static str = "friction_map";
    const SUMMARY: &'static str = "change of friction, given at positions with a natural cubic spline between them and constant beyond; its mean is not fitted";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::list("positions_mm", Unit::Millimetre, Range::Signed),
        Parameter::list("friction_n", Unit::Newton, Range::Signed),
    ];
    const IS_LINEAR: bool = true;
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::masses(axis)
    }

    fn misplaced(&self, _place: &Placement<'_>) -> Option<Misplaced> {
        let refused = knots::refused(&self.positions_mm, &[("friction_n", &self.friction_n)]);
        refused.map(|(key, expected)| Misplaced { key, expected })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let knots = context.residual.friction_knots.filter(|_| context.axis.has_mass());
        let guess = |count| {
            let positions_mm = knots::positions_mm(context.travel_mm, count);
            Self { friction_n: vec![0.0; positions_mm.len()], positions_mm }
        };
        knots.into_iter().map(guess).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let coordinate = |&value: &f64| Coordinate::signed(value, 2.0, 1e5);
        KeptPart::Mean.free(&self.friction_n).iter().map(coordinate).collect()
    }

    fn at(&self, x: &[f64]) -> Self {
        let friction_n = KeptPart::Mean.with(&self.positions_mm, &self.friction_n, x);
        Self { friction_n, ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        [&self.positions_mm[..], &self.friction_n].concat()
    }

    fn lengths(&self) -> Vec<usize> {
        vec![self.positions_mm.len(), self.friction_n.len()]
    }

    /// Zero, with a standard deviation of the Coulomb friction: a fit without a fold knows nothing of positions that only this fold
    /// contains.
    fn prior(&self, declared: &Settings) -> Option<[f64; 2]> {
        let coulomb_n = declared.mechanics.coulomb_n.filter(|force_n| *force_n > 0.0)?;
        Some([0.0, coulomb_n])
    }

    fn over_position(&self) -> Option<&[f64]> {
        Some(&self.positions_mm)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::FRICTION
    }

    fn sentence(&self, wording: &Wording) -> String {
        let count = self.positions_mm.len();
        format!(
            "friction varies over the position by {} peak to peak from {} to {} ({count} knots)",
            wording.peak_to_peak(count..2 * count),
            wording.value(0),
            wording.value(count - 1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Position
    }
}
