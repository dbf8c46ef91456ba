//! Second-order error of a rotary encoder: the motor reading wobbles twice a turn.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Distinction, EffectContext, EffectModel, Neighbours, Occurrence, Parameter,
    Prerequisite, Range, Stage, Unit, Wording, harmonic,
};
use crate::axis::Settings;

/// Motor reading = motor + amplitude·sin(2π·motor/period + phase): an oval disc, or a bearing that runs out twice a turn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EncoderEllipticity {
    /// Half of peak to peak.
    pub amplitude_um: f64,
    /// Half of the lead.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
}

impl EncoderEllipticity {
    /// Reading − true motor position, m.
    #[must_use]
    pub fn error_m(&self, motor_m: f64) -> f64 {
        1e-6 * self.amplitude_um * harmonic::wave(1e3 * motor_m, self.period_mm, self.phase_rad)
    }
}

/// The dividing error of a resolver with one or two pole pairs has this period, too, and is called that.
fn is_a_resolvers(axis: &Settings) -> bool {
    matches!(axis.sensors.resolver_pole_pairs, Some(1 | 2))
}

impl EffectModel for EncoderEllipticity {
    const NAME: &'static str = "encoder_ellipticity";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("amplitude_um", Unit::Micrometre, Range::Signed),
        Parameter::new("period_mm", Unit::Millimetre, Range::Positive),
        Parameter::phase("phase_rad"),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        if is_a_resolvers(axis) { Prerequisite::NotApplicable } else { Prerequisite::lead(axis) }
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_tried = context.has(Stage::Table) && !is_a_resolvers(context.axis);
        let lead = context.axis.mechanics.lead_mm.filter(|_| is_tried);
        let guess = |lead_mm| Self { amplitude_um: 0.0, period_mm: 0.5 * lead_mm, phase_rad: 0.0 };
        lead.map(guess).into_iter().collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        harmonic::parts(self.amplitude_um, self.phase_rad, 0.1, 1e3)
    }

    fn at(&self, x: &[f64]) -> Self {
        let (amplitude_um, phase_rad) = harmonic::polar(x);
        Self { amplitude_um, phase_rad, ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.amplitude_um, self.period_mm, self.phase_rad]
    }

    fn distinction(&self) -> Distinction<'_> {
        Distinction::Period(self.period_mm)
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the encoder reads {} (amplitude) too much and too little every {}",
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::WithinPeriod(self.period_mm)
    }
}
