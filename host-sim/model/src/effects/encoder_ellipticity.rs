//! Second-order error of a rotary encoder: an error of the motor reading with two periods per turn.

use serde::{Deserialize, Serialize};

use super::declaration::{
    AnyEffect, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext, Neighbours,
    PeriodicError, Prerequisite, Stage, Unit, Wording, harmonic_effect,
};
use super::scale_cyclic::ScaleCyclic;
use crate::axis::Settings;

/// Motor reading = motor + amplitude·sin(2π·motor/period + phase). Causes: an oval disc, or a bearing with a second-order
/// runout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EncoderEllipticity {
    /// Half of the peak-to-peak value.
    pub amplitude_um: f64,
    /// Half of the lead.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
}

impl EncoderEllipticity {
    /// Reading − true motor position, at the true motor position.
    #[must_use]
    pub const fn error(&self) -> PeriodicError {
        let Self { amplitude_um, period_mm, phase_rad } = *self;
        PeriodicError { amplitude_um, period_mm, phase_rad }
    }
}

/// Whether the dividing error of the axis's resolver has the same period. The error is then reported as that effect.
fn is_resolver_order(axis: &Settings) -> bool {
    matches!(axis.sensors.resolver_pole_pairs, Some(1 | 2))
}

impl EffectModel for EncoderEllipticity {
    const NAME: &'static str = "encoder_ellipticity";
    const SUMMARY: &'static str = "periodic error of the motor reading, two periods per turn";
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];

    harmonic_effect!(amplitude_um, Unit::Micrometre, step 0.1, limit 1e3);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        if is_resolver_order(axis) { Prerequisite::NotApplicable } else { Prerequisite::lead(axis) }
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_tried = context.has(Stage::Table) && !is_resolver_order(context.axis);
        let lead = context.axis.mechanics.lead_mm.filter(|_| is_tried);
        let guess = |lead_mm| Self { amplitude_um: 0.0, period_mm: 0.5 * lead_mm, phase_rad: 0.0 };
        lead.map(guess).into_iter().collect()
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        context.rival_wave(Imitation::SCREW_WAVE)
    }

    fn wave(&self) -> Option<PeriodicError> {
        Some(self.error())
    }

    fn of_scale(&self) -> Option<AnyEffect> {
        Some(AnyEffect::new(ScaleCyclic::of(self.error().reversed(), None)))
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::READING_WAVE
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the encoder has a periodic error: amplitude {}, period {}",
            wording.value(0),
            wording.value(1)
        )
    }
}
