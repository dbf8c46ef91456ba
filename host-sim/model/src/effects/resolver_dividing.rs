//! Dividing error of the resolver: an error of the motor reading that repeats with every electrical period.

use serde::{Deserialize, Serialize};

use super::declaration::{
    AnyEffect, Draw, EffectCompensation, EffectContext, EffectModel, Found, Imitation, ImitationContext,
    Neighbours, PeriodicError, Prerequisite, Stage, Substitute, Unit, WaveOf, Wording, harmonic,
    harmonic_effect,
};
use super::scale_cyclic::ScaleCyclic;
use crate::axis::Settings;

/// Highest order of an electrical period that is tried in any case. Offsets of sine and cosine cause order 1, a
/// difference of their amplitudes order 2. Higher orders are tried if the residual has them.
const HIGHEST_ORDER: u32 = 2;

/// Motor reading = motor + amplitude·sin(2π·motor/period + phase); Soeda, section (D).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResolverDividing {
    /// Half of the peak-to-peak value.
    pub amplitude_um: f64,
    /// Lead / pole pairs, divided by a whole number, or a period of its own if the declared lead is not that of the screw.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
    /// The range in which a fit changes the period, mm; `None`: the period is known. Not in files: a period that was found
    /// is kept.
    #[serde(skip)]
    pub fitted_period_mm: Option<[f64; 2]>,
}

impl ResolverDividing {
    /// Reading − true motor position, at the true motor position.
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

    /// Length of an electrical period on the axis, mm; `None`: not declared.
    fn electrical_mm(axis: &Settings) -> Option<f64> {
        Some(axis.mechanics.lead_mm? / f64::from(axis.sensors.resolver_pole_pairs?))
    }
}

impl EffectModel for ResolverDividing {
    const NAME: &'static str = "resolver_dividing";
    const SUMMARY: &'static str = "periodic error of the motor reading, a whole number of periods per electrical period (lead / pole pairs)";
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(3);

    harmonic_effect!(amplitude_um, Unit::Micrometre, step 0.1, limit 1e3, period fitted_period_mm);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        let poles = axis.sensors.resolver_pole_pairs.is_some();
        Prerequisite::lead(axis).and(Prerequisite::needs(poles, "resolver_pole_pairs in the machine file"))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let lead = context.axis.mechanics.lead_mm.filter(|_| context.has(Stage::Table));
        let electrical_mm = lead.and_then(|_| Self::electrical_mm(context.axis));
        // A resolver has at least one electrical period per turn; a longer wave is not its.
        let is_possible =
            |guess: &harmonic::HarmonicGuess| lead.is_some_and(|lead_mm| guess.period_mm <= lead_mm);
        let guesses = |mm: f64| {
            harmonic::guesses(context, WaveOf::Table, Some(mm), HIGHEST_ORDER).into_iter().filter(is_possible)
        };
        electrical_mm.into_iter().flat_map(guesses).map(Self::of).collect()
    }

    fn in_place_of(found: &Found<'_>) -> Option<Substitute<Self>> {
        let electrical_mm = Self::electrical_mm(found.axis).filter(|_| found.name == "pitch_cyclic")?;
        harmonic::of_other_part(found, electrical_mm).map(|wave| Substitute::alone(Self::of(wave)))
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        context.rival_wave(Imitation::SCREW_WAVE)
    }

    fn wave(&self) -> Option<PeriodicError> {
        Some(self.error())
    }

    fn of_scale(&self) -> Option<AnyEffect> {
        Some(AnyEffect::new(ScaleCyclic::of(self.error().reversed(), self.fitted_period_mm)))
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::READING_WAVE
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the resolver has a periodic error: amplitude {}, period {}",
            wording.value(0),
            wording.value(1)
        )
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        let pole_pairs = draw.axis.sensors.resolver_pole_pairs.unwrap_or(1);
        let (period_mm, phase_rad) = (draw.lead_mm() / f64::from(pole_pairs), draw.phase_rad);
        Some(Self { amplitude_um: draw.between(1.5, 4.0), period_mm, phase_rad, fitted_period_mm: None })
    }
}
