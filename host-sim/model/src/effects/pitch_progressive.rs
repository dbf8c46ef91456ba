//! Progressive pitch error: the mean lead of the screw deviates from the nominal lead.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, Draw, EffectContext, EffectModel, LEAST_SLOPE_UM_PER_M, Occurrence, Parameter,
    Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Table = (1 + slope) · motor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchProgressive {
    /// Relative deviation of the lead.
    pub slope_um_per_m: f64,
}

impl PitchProgressive {
    /// Deviation of the table position from the nominal one, m.
    #[must_use]
    #[inline]
    pub fn error_m(&self, motor_m: f64) -> f64 {
        1e-6 * self.slope_um_per_m * motor_m
    }
}

impl EffectModel for PitchProgressive {
    const NAME: &'static str = "pitch_progressive";
    const SUMMARY: &'static str = "displacement of the table = (1 + slope) × displacement of the motor";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("slope_um_per_m", Unit::MicrometrePerMetre, Range::Signed)];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(1);

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if context.has(Stage::Table) { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.slope_um_per_m, 5.0, 1e5)]
    }

    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.slope_um_per_m.abs() > LEAST_SLOPE_UM_PER_M
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { slope_um_per_m: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.slope_um_per_m]
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the {} moves the table {} {} than its nominal {}",
            wording.by_axis("screw", "gear"),
            wording.size(0),
            wording.by_sign("more", "less"),
            wording.by_axis("lead", "ratio")
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Position
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { slope_um_per_m: draw.signed(30.0, 120.0) })
    }
}
