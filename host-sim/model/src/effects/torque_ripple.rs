//! Torque ripple: a force on the motor that is periodic in the motor angle.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Draw, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext, Neighbours,
    Prerequisite, Stage, Unit, WaveOf, Wording, harmonic, harmonic_effect,
};
use crate::axis::Settings;

/// Highest order of a screw turn that is tried in any case. Higher orders and other periods are tried if the residual has
/// them.
const HIGHEST_ORDER: u32 = 12;

/// Adds amplitude·sin(2π·motor/period + phase) to the drive's force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueRipple {
    /// Half of the peak-to-peak value.
    pub amplitude_n: f64,
    /// The lead divided by a whole number, or the period of another part.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
    /// The range in which a fit changes the period, mm; `None`: the period is known. Not in files: a period that was found
    /// is kept.
    #[serde(skip)]
    pub fitted_period_mm: Option<[f64; 2]>,
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
    const SUMMARY: &'static str =
        "periodic force on the motor: a whole number of periods per lead, or a period of its own";
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];
    const DRAW_NUMBER: Option<u32> = Some(6);

    harmonic_effect!(amplitude_n, Unit::Newton, step 1.0, limit 1e5, period fitted_period_mm);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::lead(axis).and(Prerequisite::masses(axis))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if !context.axis.has_mass() {
            return Vec::new();
        }
        // The residual is the force of the drive, which balances the ripple.
        let guess = |guess: harmonic::HarmonicGuess| Self {
            amplitude_n: -guess.amplitude,
            period_mm: guess.period_mm,
            phase_rad: guess.phase_rad,
            fitted_period_mm: guess.fitted_period_mm,
        };
        let lead_mm = context.axis.mechanics.lead_mm;
        harmonic::guesses(context, WaveOf::Force, lead_mm, HIGHEST_ORDER).into_iter().map(guess).collect()
    }

    /// A periodic error of the screw or of the motor's reading accelerates the table, which needs a periodic force.
    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let is_table_seen = context.has(Stage::Table) || context.has(Stage::Tool);
        let screw = Imitation {
            name: "pitch_cyclic",
            clause: "the screw or the motor encoder has a periodic error, with which the table accelerates",
            decided_by: "the readings of a linear scale or a probe",
        };
        if is_table_seen { Vec::new() } else { vec![screw] }
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the periodic force is subtracted from the force")
    }

    fn sentence(&self, wording: &Wording) -> String {
        let force = wording.by_axis("force", "torque");
        format!("the drive {force} has a ripple: amplitude {}, period {}", wording.value(0), wording.value(1))
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        let period_mm = draw.lead_mm() / draw.between(2.0, 7.0).floor();
        let amplitude_n = draw.between(30.0, 80.0);
        Some(Self { amplitude_n, period_mm, phase_rad: draw.phase_rad, fitted_period_mm: None })
    }
}
