//! Cyclic pitch error: a periodic error of the screw's pitch, or of a belt or gear between motor and table.

use serde::{Deserialize, Serialize};

use super::declaration::{
    AnyEffect, Draw, EffectCompensation, EffectContext, EffectModel, Found, Imitation, ImitationContext,
    Neighbours, PeriodicError, Prerequisite, Stage, Substitute, Unit, WaveOf, Wording, harmonic,
    harmonic_effect,
};
use super::scale_cyclic::ScaleCyclic;
use crate::axis::Settings;

/// Highest order of a screw turn that is tried in any case: runout of nut or bearing (1), ovality (2). Higher orders and
/// other periods are tried if the residual has them: balls that pass, a belt, a gear.
const HIGHEST_ORDER: u32 = 2;

/// Table = motor + amplitude·sin(2π·motor/period + phase).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchCyclic {
    /// Half of the peak-to-peak value.
    pub amplitude_um: f64,
    /// The lead of the screw divided by a whole number, or the period of another part.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
    /// The range in which a fit changes the period, mm; `None`: the period is known. Not in files: a period that was found
    /// is kept.
    #[serde(skip)]
    pub fitted_period_mm: Option<[f64; 2]>,
}

impl PitchCyclic {
    /// Deviation of the table position from the nominal one, at a motor position.
    #[must_use]
    pub const fn error(&self) -> PeriodicError {
        let Self { amplitude_um, period_mm, phase_rad, .. } = *self;
        PeriodicError { amplitude_um, period_mm, phase_rad }
    }

    const fn of(guess: harmonic::HarmonicGuess) -> Self {
        Self {
            amplitude_um: guess.amplitude,
            period_mm: guess.period_mm,
            phase_rad: guess.phase_rad,
            fitted_period_mm: guess.fitted_period_mm,
        }
    }
}

impl EffectModel for PitchCyclic {
    const NAME: &'static str = "pitch_cyclic";
    const SUMMARY: &'static str = "periodic error of the screw's pitch, with a whole number of periods per lead or any other period (belt, gear, balls)";
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(2);

    harmonic_effect!(amplitude_um, Unit::Micrometre, step 0.1, limit 1e3, period fitted_period_mm);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::lead(axis)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if !context.has(Stage::Table) {
            return Vec::new();
        }
        let lead_mm = context.axis.mechanics.lead_mm;
        harmonic::guesses(context, WaveOf::Table, lead_mm, HIGHEST_ORDER).into_iter().map(Self::of).collect()
    }

    fn in_place_of(found: &Found<'_>) -> Option<Substitute<Self>> {
        let lead_mm = found.axis.mechanics.lead_mm.filter(|_| found.name == "resolver_dividing")?;
        harmonic::of_other_part(found, lead_mm).map(|wave| Substitute::alone(Self::of(wave)))
    }

    /// An error of the motor's reading repeats with each turn of the motor.
    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let repeats_with_motor = context.axis.mechanics.lead_mm.is_some_and(|lead_mm| {
            let periods = lead_mm / self.period_mm;
            periods > 0.5 && (periods - periods.round()).abs() < 0.01
        });
        if repeats_with_motor { context.rival_wave(Imitation::READING_WAVE) } else { Vec::new() }
    }

    fn wave(&self) -> Option<PeriodicError> {
        Some(self.error())
    }

    fn of_scale(&self) -> Option<AnyEffect> {
        Some(AnyEffect::new(ScaleCyclic::of(self.error(), self.fitted_period_mm)))
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the periodic error is subtracted from the command")
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
        Some(Self { amplitude_um: draw.between(2.0, 6.0), period_mm, phase_rad, fitted_period_mm: None })
    }
}
