//! Thermal drift: the tool is displaced relative to the table while the machine warms up.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, AnyEffect, Coordinate, Distinction, Draw, EffectCompensation, EffectContext, EffectModel,
    Occurrence, Parameter, Range, Stage, Unit, Wording,
};
use super::thermal_rate::ThermalRate;

/// Tool − table = amplitude·(1 − exp(−t/τ)), where t is the time on the session clock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThermalDrift {
    /// Final value of the drift.
    pub amplitude_um: f64,
    /// τ.
    pub time_constant_s: f64,
}

impl ThermalDrift {
    /// Tool − table, m, at a time on the session clock.
    #[must_use]
    pub fn offset_m(&self, time_s: f64) -> f64 {
        -1e-6 * self.amplitude_um * libm::expm1(-time_s / self.time_constant_s)
    }
}

impl EffectModel for ThermalDrift {
    const NAME: &'static str = "thermal_drift";
    const SUMMARY: &'static str = "tool − table = amplitude·(1 − exp(−t/τ)), t on the session clock";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("amplitude_um", Unit::Micrometre, Range::Signed),
        Parameter::new("time_constant_s", Unit::Second, Range::Positive),
    ];
    const CONTAINS: &'static [&'static str] = &["thermal_rate"];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];
    const DRAW_NUMBER: Option<u32> = Some(13);

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(_context: &EffectContext<'_>) -> Vec<Self> {
        [5.0, 20.0, 80.0, 320.0].map(|time_constant_s| Self { amplitude_um: 0.0, time_constant_s }).to_vec()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::signed(self.amplitude_um, 0.1, 1e4),
            Coordinate::scale(self.time_constant_s, 0.5, 5e3),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { amplitude_um: x[0], time_constant_s: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.amplitude_um, self.time_constant_s]
    }

    fn distinction(&self) -> Distinction<'_> {
        Distinction::TimeConstant(self.time_constant_s)
    }

    /// Over a time that is short beside its time constant, a drift is a straight line: its mean rate.
    fn within_logs(&self, half_widths: &[f64], end_s: f64) -> Option<AnyEffect> {
        let half_width_s = half_widths.get(1).copied().unwrap_or(0.0);
        let rate = || AnyEffect::new(ThermalRate { um_per_min: 60e6 * self.offset_m(end_s) / end_s });
        (self.time_constant_s + half_width_s > end_s).then(rate)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the drift over the time of the session is subtracted from the command")
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the tool drifts by {} while the machine warms up, with a time constant of {}",
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Time
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { amplitude_um: draw.signed(5.0, 12.0), time_constant_s: draw.between(15.0, 60.0) })
    }
}
