//! Progressive pitch error: the mean lead of the screw deviates from the nominal lead.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Draw, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext, SlopeOf, Stage,
    Wording, slope,
};

/// Table = (1 + slope) · motor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchProgressive {
    /// Relative deviation of the lead.
    pub slope_um_per_m: f64,
}

impl PitchProgressive {
    /// Deviation of the table position from the nominal one, m.
    #[must_use]
    #[inline]
    pub fn error_m(&self, motor_m: f64) -> f64 {
        1e-6 * self.slope_um_per_m * motor_m
    }
}

impl EffectModel for PitchProgressive {
    const NAME: &'static str = "pitch_progressive";
    const SUMMARY: &'static str = "displacement of the table = (1 + slope) × displacement of the motor";
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(1);

    slope!(slope_um_per_m);

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if context.has(Stage::Table) { vec![Self::default()] } else { Vec::new() }
    }

    /// A wave of the scale that is longer than the travel has a slope, too; the probe then does not follow the scale.
    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let is_contradicted = context.has(Stage::Tool) && !context.tool_follows_scale;
        if is_contradicted { vec![Imitation::SCALE] } else { Vec::new() }
    }

    fn slope(&self) -> Option<SlopeOf> {
        Some(SlopeOf::Screw)
    }

    fn over_position(&self) -> Option<&[f64]> {
        Some(&[])
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::OVER_POSITION
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the {} moves the table {} {} than its nominal {}",
            wording.by_axis("screw", "gear"),
            wording.size(0),
            wording.by_sign("more", "less"),
            wording.by_axis("lead", "ratio")
        )
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { slope_um_per_m: draw.signed(30.0, 120.0) })
    }
}
