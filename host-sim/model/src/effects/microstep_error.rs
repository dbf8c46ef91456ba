//! Microstep error: a stepper motor stands beside its command, with a period of four full steps.

use serde::{Deserialize, Serialize};

use super::declaration::{
    EffectCompensation, EffectContext, EffectModel, Misplaced, Neighbours, PeriodicError, Placement,
    Prerequisite, Stage, Unit, WaveOf, Wording, harmonic, harmonic_effect,
};
use crate::axis::{Drive, Settings};

/// Highest order of four full steps that is tried in any case: offsets of the phase currents (1), their difference (2), and the detent
/// torque, once per full step (4). Order 3 and orders above 4 are tried if the residual has them.
const HIGHEST_ORDER: u32 = 4;

/// Motor = command + amplitude·sin(2π·command/period + phase).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MicrostepError {
    /// Half of the peak-to-peak value.
    pub amplitude_um: f64,
    /// Travel of four full steps, divided by a whole number.
    pub period_mm: f64,
    /// Phase at command zero.
    #[serde(default)]
    pub phase_rad: f64,
}

impl MicrostepError {
    /// Deviation of the motor from its command, at the command.
    #[must_use]
    pub const fn error(&self) -> PeriodicError {
        let Self { amplitude_um, period_mm, phase_rad } = *self;
        PeriodicError { amplitude_um, period_mm, phase_rad }
    }

    const fn of(guess: harmonic::HarmonicGuess) -> Self {
        Self { amplitude_um: guess.amplitude, period_mm: guess.period_mm, phase_rad: guess.phase_rad }
    }
}

impl EffectModel for MicrostepError {
    const NAME: &'static str = "microstep_error";
    const SUMMARY: &'static str =
        "periodic error of a stepper motor, a whole number of periods in four full steps";
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor, Stage::Table];
    const DRIVES: &'static [Drive] = &[Drive::Stepper];

    harmonic_effect!(amplitude_um, Unit::Micrometre, step 0.1, limit 1e3);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::lead(axis)
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        Misplaced::unless_stepper(place)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let four_steps_mm = context.axis.four_full_steps_mm().filter(|_| context.has(Stage::Motor));
        let Some(four_steps_mm) = four_steps_mm else { return Vec::new() };
        let guesses = harmonic::guesses(context, WaveOf::Table, Some(four_steps_mm), HIGHEST_ORDER);
        guesses.into_iter().filter(|guess| guess.fitted_period_mm.is_none()).map(Self::of).collect()
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the motor stands beside its command",
            "change the current of the driver, or use one that corrects its microsteps",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the stepper motor has a periodic error of its microsteps: amplitude {}, period {}",
            wording.value(0),
            wording.value(1)
        )
    }
}
