//! Friction ripple: friction that varies periodically over a turn of the screw.

use serde::{Deserialize, Serialize};

use super::declaration::{
    EffectCompensation, EffectContext, EffectModel, Neighbours, Prerequisite, Stage, Unit, WaveOf, Wording,
    harmonic, harmonic_effect,
};
use crate::axis::Settings;

/// Highest order of a screw turn that is tried in any case. Higher orders and other periods are tried if the residual has
/// them.
const HIGHEST_ORDER: u32 = 4;

/// Adds amplitude·sin(2π·x/period + phase) to the sliding level. Cause: a bent screw, or one with runout, has higher
/// friction once per turn. Unlike torque ripple, the force changes its sign with the direction of motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionRipple {
    /// Half of the peak-to-peak value.
    pub amplitude_n: f64,
    /// The lead divided by a whole number, or the period of another part.
    pub period_mm: f64,
    /// Phase at position zero.
    #[serde(default)]
    pub phase_rad: f64,
    /// The range in which a fit changes the period, mm; `None`: the period is known. Not in files: a period that was found
    /// is kept.
    #[serde(skip)]
    pub fitted_period_mm: Option<[f64; 2]>,
}

impl FrictionRipple {
    /// Change of the sliding level, N, at a position.
    #[must_use]
    pub fn rise_n(&self, position_m: f64) -> f64 {
        self.amplitude_n * harmonic::wave(1e3 * position_m, self.period_mm, self.phase_rad)
    }
}

impl EffectModel for FrictionRipple {
    const NAME: &'static str = "friction_ripple";
    const SUMMARY: &'static str =
        "periodic variation of friction, with a whole number of periods per lead or any other period";
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];

    harmonic_effect!(amplitude_n, Unit::Newton, step 1.0, limit 1e5, period fitted_period_mm);

    fn prerequisite(_axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::WITHOUT_TABLE
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if !context.shows_friction_alone() {
            return Vec::new();
        }
        let guess = |guess: harmonic::HarmonicGuess| Self {
            amplitude_n: guess.amplitude,
            period_mm: guess.period_mm,
            phase_rad: guess.phase_rad,
            fitted_period_mm: guess.fitted_period_mm,
        };
        let lead_mm = context.axis.mechanics.lead_mm;
        harmonic::guesses(context, WaveOf::Friction, lead_mm, HIGHEST_ORDER).into_iter().map(guess).collect()
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::FRICTION
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("friction varies periodically: amplitude {}, period {}", wording.value(0), wording.value(1))
    }
}
