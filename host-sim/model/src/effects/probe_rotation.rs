//! Rotation of the probe: its axes are turned about the third axis against those of the machine.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, LEAST_SLOPE_UM_PER_M, Misplaced,
    Neighbours, Occurrence, Parameter, Placement, Prerequisite, Range, SlopeOf, Stage, Unit, Wording,
};

use crate::axis::Settings;
use shared::config::Rates;

/// Reading of x += angle × table y, reading of y −= angle × table x (x: the first of two axes). One angle of the probe appears
/// on both axes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeRotation {
    /// Angle, µm per m (µrad).
    pub um_per_m: f64,
}

impl ProbeRotation {
    /// Reading − tool, m, of an axis by its number, at a table position of the other axis.
    #[must_use]
    pub fn offset_m(&self, axis: usize, other_table_m: f64) -> f64 {
        let sign = if axis == 0 { 1.0 } else { -1.0 };
        sign * 1e-6 * self.um_per_m * other_table_m
    }
}

impl EffectModel for ProbeRotation {
    const NAME: &'static str = "probe_rotation";
    const SUMMARY: &'static str = "the probe is turned: reading of x += angle × table y, reading of y −= angle × table x (x: the first of two axes)";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("um_per_m", Unit::MicrometrePerMetre, Range::Signed)];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

    fn prerequisite(_axis: &Settings, neighbours: Neighbours) -> Prerequisite {
        Prerequisite::needs(neighbours.others == 1, "one of two axes")
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        (place.axes != 2).then(|| Misplaced::name("this effect only on a machine with two axes"))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    /// On the first axis, a squareness has the same regressor; what both axes show decides between them.
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if !context.first && context.others.len() == 1 { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_per_m, 5.0, 1e5)]
    }

    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.um_per_m.abs() > LEAST_SLOPE_UM_PER_M
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_per_m: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.um_per_m]
    }

    fn slope(&self) -> Option<SlopeOf> {
        Some(SlopeOf::ProbeAngle)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::PROBE
    }

    fn sentence(&self, wording: &Wording) -> String {
        let unit = wording.by_axis("µm per m", "ppm");
        format!("the probe is turned against the axes by {} {unit} (alignment)", wording.number(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::OtherPosition(None)
    }
}
