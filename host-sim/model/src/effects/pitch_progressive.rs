//! Progressive pitch error: the screw's mean lead is not the nominal one.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, Draw, EffectContext, EffectModel, Occurrence, Parameter, Range, Stage, Unit,
    Wording,
};
use crate::axis::Settings;

/// The screw moves the table (1 + slope) times the motor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchProgressive {
    /// Slope.
    pub slope_um_per_m: f64,
}

impl PitchProgressive {
    /// How much further than nominal the screw carries the table, m.
    #[must_use]
    #[inline]
    pub fn error_m(&self, motor_m: f64) -> f64 {
        1e-6 * self.slope_um_per_m * motor_m
    }
}

impl EffectModel for PitchProgressive {
    const NAME: &'static str = "pitch_progressive";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("slope_um_per_m", Unit::MicrometrePerMetre, Range::Signed)];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(1);

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let sees_table = context.has(Stage::Table);
        if sees_table { vec![Self::default()] } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.slope_um_per_m, 5.0, 1e5)]
    }

    /// A twentieth of a degree makes half a micrometre of a metre of steel.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        const LEAST_UM_PER_M: f64 = 0.5;
        self.slope_um_per_m.abs() > LEAST_UM_PER_M
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { slope_um_per_m: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.slope_um_per_m]
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the {} carries the table {} {} than its nominal {}",
            wording.by_axis("screw", "gear"),
            wording.size(0),
            wording.by_sign("further", "less far"),
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
