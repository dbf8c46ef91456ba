//! Periodic error of the linear scale: of its interpolation, its mounting or its grating.

use serde::{Deserialize, Serialize};

use super::declaration::{
    EffectCompensation, EffectContext, EffectModel, PeriodicError, Stage, Unit, Wording, harmonic_effect,
};

/// Reading of the scale = table + amplitude·sin(2π·table/period + phase).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScaleCyclic {
    /// Half of the peak-to-peak value.
    pub amplitude_um: f64,
    /// Period.
    pub period_mm: f64,
    /// Phase at table position zero.
    #[serde(default)]
    pub phase_rad: f64,
    /// The range in which a fit changes the period, mm; `None`: the period is known. Not in files.
    #[serde(skip)]
    pub fitted_period_mm: Option<[f64; 2]>,
}

impl ScaleCyclic {
    /// The effect with a given error, whose period is fitted within a range (mm) or known.
    #[must_use]
    pub const fn of(error: PeriodicError, fitted_period_mm: Option<[f64; 2]>) -> Self {
        let PeriodicError { amplitude_um, period_mm, phase_rad } = error;
        Self { amplitude_um, period_mm, phase_rad, fitted_period_mm }
    }

    /// Reading − table, at a table position.
    #[must_use]
    pub const fn error(&self) -> PeriodicError {
        let Self { amplitude_um, period_mm, phase_rad, .. } = *self;
        PeriodicError { amplitude_um, period_mm, phase_rad }
    }
}

impl EffectModel for ScaleCyclic {
    const NAME: &'static str = "scale_cyclic";
    const SUMMARY: &'static str = "periodic error of the linear scale's reading; a tool-point probe distinguishes it from `pitch_cyclic`";
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

    harmonic_effect!(amplitude_um, Unit::Micrometre, step 0.1, limit 1e3, period fitted_period_mm);

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Tool]
    }

    /// A `pitch_cyclic` is the same in the table stage, where it is searched; the tool stage decides between them.
    fn initial_guesses(_context: &EffectContext<'_>) -> Vec<Self> {
        Vec::new()
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::SCALE
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the linear scale has a periodic error: amplitude {}, period {}",
            wording.value(0),
            wording.value(1)
        )
    }
}
