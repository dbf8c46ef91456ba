//! Thermal drift rate: the tool is displaced evenly relative to the table, over a time that does not show where the drift ends.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Occurrence, Parameter, Range,
    Stage, Unit, Wording,
};

/// Tool − table = rate·t, where t is the time on the session clock.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThermalRate {
    /// Rate, µm per minute.
    pub um_per_min: f64,
}

impl ThermalRate {
    /// Tool − table, m, at a time on the session clock.
    #[must_use]
    pub fn offset_m(&self, time_s: f64) -> f64 {
        1e-6 * self.um_per_min * time_s / 60.0
    }
}

impl EffectModel for ThermalRate {
    const NAME: &'static str = "thermal_rate";
    const SUMMARY: &'static str =
        "tool − table = rate·t, t on the session clock; a drift whose time constant the logs do not hold";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("um_per_min", Unit::MicrometrePerMinute, Range::Signed)];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(_context: &EffectContext<'_>) -> Vec<Self> {
        vec![Self::default()]
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_per_min, 0.1, 1e4)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { um_per_min: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.um_per_min]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the logs show neither the time constant nor the end of the drift, so that it cannot be continued",
            "record until the drift ends, or warm the machine up",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the tool drifts by {} during the logs, which do not show where it ends", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Time
    }
}
