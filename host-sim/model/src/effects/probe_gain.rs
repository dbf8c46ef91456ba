//! Gain of the probe: its reading is a constant factor too large or too small.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectContext, EffectModel, LEAST_SLOPE_UM_PER_M, Occurrence, Parameter, Range,
    Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Reading = tool + gain × table position.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeGain {
    /// Relative error of the reading, µm per m (ppm).
    pub um_per_m: f64,
}

impl ProbeGain {
    /// Reading − tool, m, at a table position of the same axis.
    #[must_use]
    pub fn offset_m(&self, table_m: f64) -> f64 {
        1e-6 * self.um_per_m * table_m
    }
}

impl EffectModel for ProbeGain {
    const NAME: &'static str = "probe_gain";
    const SUMMARY: &'static str = "the reading of the tool-point probe += gain × table position";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("um_per_m", Unit::MicrometrePerMetre, Range::Signed)];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(_context: &EffectContext<'_>) -> Vec<Self> {
        vec![Self::default()]
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_per_m, 5.0, 1e5)]
    }

    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.um_per_m.abs() > LEAST_SLOPE_UM_PER_M
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_per_m: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.um_per_m]
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the probe reads {} {} than the table moves (alignment)",
            wording.size(0),
            wording.by_sign("more", "less")
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Position
    }
}
