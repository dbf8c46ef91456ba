//! Torque ripple: a force on the motor that is periodic in the motor angle.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Draw, EffectContext, EffectModel, Neighbours, Prerequisite, Stage, Unit, Wording, harmonic,
    harmonic_effect,
};
use crate::axis::Settings;

/// Highest order of a screw turn that is searched for.
const HIGHEST_ORDER: u32 = 12;

/// Adds amplitude·sin(2π·motor/period + phase) to the drive's force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueRipple {
    /// Half of the peak-to-peak value.
    pub amplitude_n: f64,
    /// The lead divided by a whole number.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
}

impl TorqueRipple {
    /// Force on the motor in addition to the commanded drive force, N.
    #[must_use]
    pub fn force_n(&self, motor_m: f64) -> f64 {
        self.amplitude_n * harmonic::wave(1e3 * motor_m, self.period_mm, self.phase_rad)
    }
}

impl EffectModel for TorqueRipple {
    const NAME: &'static str = "torque_ripple";
    const SUMMARY: &'static str = "periodic force on the motor, a whole number of periods per lead";
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];
    const DRAW_NUMBER: Option<u32> = Some(6);

    harmonic_effect!(amplitude_n, Unit::Newton, step 1.0, limit 1e5);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::lead(axis).and(Prerequisite::masses(axis))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let lead = context.axis.mechanics.lead_mm.filter(|_| context.axis.has_mass());
        let guess = |period_mm| Self { amplitude_n: 0.0, period_mm, phase_rad: 0.0 };
        lead.into_iter().flat_map(|lead_mm| harmonic::periods(lead_mm, HIGHEST_ORDER)).map(guess).collect()
    }

    fn sentence(&self, wording: &Wording) -> String {
        let force = wording.by_axis("force", "torque");
        format!("the drive {force} has a ripple: amplitude {}, period {}", wording.value(0), wording.value(1))
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        let period_mm = draw.lead_mm() / draw.between(2.0, 7.0).floor();
        Some(Self { amplitude_n: draw.between(30.0, 80.0), period_mm, phase_rad: draw.phase_rad })
    }
}
