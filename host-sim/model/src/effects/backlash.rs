//! Backlash: a dead zone between screw and table.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, AnyEffect, Coordinate, Draw, EffectCompensation, EffectContext, EffectModel, Imitation,
    ImitationContext, Occurrence, Parameter, Range, ResidualShape, Stage, Unit, Wording,
};
use super::pitch_map::PitchMap;

/// A gap between screw nut and table. The spring of the screw acts only while the gap is closed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Backlash {
    /// Total width of the gap.
    pub width_um: f64,
}

impl Backlash {
    /// Half of the gap, m.
    #[must_use]
    #[inline]
    pub fn half_m(&self) -> f64 {
        0.5e-6 * self.width_um
    }
}

/// Widths with which a fit starts.
pub const GUESSED_WIDTHS_UM: [f64; 4] = [2.0, 8.0, 25.0, 80.0];

impl EffectModel for Backlash {
    const NAME: &'static str = "backlash";
    const SUMMARY: &'static str = "dead zone between screw and table, given by its total width";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("width_um", Unit::Micrometre, Range::NotNegative)];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(0);

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_shown = context.has(Stage::Table) && !context.hides_windup();
        let widths: &[f64] = if is_shown { &GUESSED_WIDTHS_UM } else { &[] };
        widths.iter().map(|&width_um| Self { width_um }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::between(self.width_um, 0.2, 0.0, 1000.0)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { width_um: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.width_um]
    }

    /// Reversed friction stretches the drive train by 2·F/k, as a gap of this width would. The force channel tells nothing of it.
    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let stretch =
            Imitation { decided_by: "stiffness_n_per_um in the machine file", ..Imitation::STRETCH };
        if context.axis.is_rigid() { vec![stretch] } else { Vec::new() }
    }

    /// A gap that varies along the travel is a backlash, its mean, with a map whose curves for both directions differ. Where it varies by
    /// a large part of its mean, a constant one makes some logs worse and is refused.
    fn variation(&self, residual: &dyn Fn() -> ResidualShape, travel_mm: [f64; 2]) -> Option<AnyEffect> {
        let knots = residual().pitch_knots_each_way?;
        Some(AnyEffect::new(PitchMap::without_error(travel_mm, knots, true)))
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::REVERSAL
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("{} backlash between screw and table", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { width_um: draw.between(4.0, 15.0) })
    }
}
