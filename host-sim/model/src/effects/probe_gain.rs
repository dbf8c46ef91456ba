//! Gain of the probe: its reading is a constant factor too large or too small.

use serde::{Deserialize, Serialize};

use super::declaration::{EffectCompensation, EffectContext, EffectModel, SlopeOf, Stage, Wording, slope};

/// Reading = tool + gain × table position.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeGain {
    /// Relative error of the reading, µm per m (ppm).
    pub um_per_m: f64,
}

impl ProbeGain {
    /// Reading − tool, m, at a table position of the same axis.
    #[must_use]
    pub fn offset_m(&self, table_m: f64) -> f64 {
        1e-6 * self.um_per_m * table_m
    }
}

impl EffectModel for ProbeGain {
    const NAME: &'static str = "probe_gain";
    const SUMMARY: &'static str = "the reading of the tool-point probe += gain × table position";
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

    slope!(um_per_m);

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(_context: &EffectContext<'_>) -> Vec<Self> {
        vec![Self::default()]
    }

    fn slope(&self) -> Option<SlopeOf> {
        Some(SlopeOf::Probe)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::PROBE
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the probe reads {} {} than the table moves (alignment)",
            wording.size(0),
            wording.by_sign("more", "less")
        )
    }
}
