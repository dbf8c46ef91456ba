//! Cyclic pitch error: an error of the screw's pitch with one or two periods per turn.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Draw, EffectContext, EffectModel, Neighbours, PeriodicError, Prerequisite, Stage, Unit, Wording,
    harmonic, harmonic_effect,
};
use crate::axis::Settings;

/// Highest order of a screw turn that is searched for: runout of nut or bearing (1), ovality (2).
const HIGHEST_ORDER: u32 = 2;

/// Table = motor + amplitude·sin(2π·motor/period + phase).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchCyclic {
    /// Half of the peak-to-peak value.
    pub amplitude_um: f64,
    /// The lead of the screw, or half of it.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
}

impl PitchCyclic {
    /// Deviation of the table position from the nominal one, at a motor position.
    #[must_use]
    pub const fn error(&self) -> PeriodicError {
        let Self { amplitude_um, period_mm, phase_rad } = *self;
        PeriodicError { amplitude_um, period_mm, phase_rad }
    }
}

impl EffectModel for PitchCyclic {
    const NAME: &'static str = "pitch_cyclic";
    const SUMMARY: &'static str = "periodic error of the screw's pitch, one or two periods per lead";
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(2);

    harmonic_effect!(amplitude_um, Unit::Micrometre, step 0.1, limit 1e3);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::lead(axis)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let lead = context.axis.mechanics.lead_mm.filter(|_| context.has(Stage::Table));
        let guess = |period_mm| Self { amplitude_um: 0.0, period_mm, phase_rad: 0.0 };
        lead.into_iter().flat_map(|lead_mm| harmonic::periods(lead_mm, HIGHEST_ORDER)).map(guess).collect()
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the {} has a periodic error: amplitude {}, period {}",
            wording.by_axis("screw's pitch", "gear's transmission"),
            wording.value(0),
            wording.value(1)
        )
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        let (period_mm, phase_rad) = (draw.lead_mm(), draw.phase_rad);
        Some(Self { amplitude_um: draw.between(2.0, 6.0), period_mm, phase_rad })
    }
}
