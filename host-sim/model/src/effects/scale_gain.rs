//! Gain of the linear scale: its grating is too long or too short.

use serde::{Deserialize, Serialize};

use super::declaration::{EffectCompensation, EffectContext, EffectModel, SlopeOf, Stage, Wording, slope};

/// Reading of the scale = (1 + gain) × table position.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScaleGain {
    /// Relative error of the reading, µm per m (ppm).
    pub um_per_m: f64,
}

impl ScaleGain {
    /// Reading − table, m.
    #[must_use]
    #[inline]
    pub fn error_m(&self, table_m: f64) -> f64 {
        1e-6 * self.um_per_m * table_m
    }
}

impl EffectModel for ScaleGain {
    const NAME: &'static str = "scale_gain";
    const SUMMARY: &'static str = "reading of the linear scale = (1 + gain) × table position; a tool-point probe distinguishes it from `pitch_progressive`";
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

    slope!(um_per_m);

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Tool]
    }

    /// A `pitch_progressive` has the same regressor in the table stage, where it is searched; the tool stage decides between them.
    fn initial_guesses(_context: &EffectContext<'_>) -> Vec<Self> {
        Vec::new()
    }

    fn slope(&self) -> Option<SlopeOf> {
        Some(SlopeOf::Scale)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::SCALE
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the linear scale reads {} {} than the table moves",
            wording.size(0),
            wording.by_sign("more", "less")
        )
    }
}
