//! Dividing error of the resolver: an error of the motor reading that repeats with every electrical period.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Draw, EffectContext, EffectModel, Neighbours, PeriodicError, Prerequisite, Stage, Unit, WaveOf, Wording,
    harmonic, harmonic_effect,
};
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
    /// Lead / pole pairs, divided by a whole number.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
}

impl ResolverDividing {
    /// Reading − true motor position, at the true motor position.
    #[must_use]
    pub const fn error(&self) -> PeriodicError {
        let Self { amplitude_um, period_mm, phase_rad } = *self;
        PeriodicError { amplitude_um, period_mm, phase_rad }
    }
}

impl EffectModel for ResolverDividing {
    const NAME: &'static str = "resolver_dividing";
    const SUMMARY: &'static str = "periodic error of the motor reading, a whole number of periods per electrical period (lead / pole pairs)";
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(3);

    harmonic_effect!(amplitude_um, Unit::Micrometre, step 0.1, limit 1e3);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        let poles = axis.sensors.resolver_pole_pairs.is_some();
        Prerequisite::lead(axis).and(Prerequisite::needs(poles, "resolver_pole_pairs in the machine file"))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let lead = context.axis.mechanics.lead_mm.filter(|_| context.has(Stage::Table));
        let electrical_mm = lead.zip(context.axis.sensors.resolver_pole_pairs);
        let electrical_mm = electrical_mm.map(|(lead_mm, pole_pairs)| lead_mm / f64::from(pole_pairs));
        let guess = |period_mm| Self { amplitude_um: 0.0, period_mm, phase_rad: 0.0 };
        let orders = |mm: f64| {
            let guesses = harmonic::guesses(context, WaveOf::Table, Some(mm), HIGHEST_ORDER).into_iter();
            guesses.filter(|guess| guess.fitted_period_mm.is_none()).map(|guess| guess.period_mm)
        };
        electrical_mm.into_iter().flat_map(orders).map(guess).collect()
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
        Some(Self { amplitude_um: draw.between(1.5, 4.0), period_mm, phase_rad })
    }
}
