//! Friction ripple: friction that changes over a turn of the screw.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, Distinction, EffectContext, EffectModel, Neighbours, Occurrence, Parameter,
    Prerequisite, Range, Stage, Unit, Wording, harmonic,
};
use crate::axis::Settings;

/// Highest order of a screw turn that is looked for.
const HIGHEST_ORDER: u32 = 4;

/// Adds amplitude·sin(2π·x/period + phase) to the sliding level: a screw that runs out, or is bent, is
/// tighter once a turn. Unlike torque ripple it turns with the direction of travel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionRipple {
    /// Half of peak to peak.
    pub amplitude_n: f64,
    /// A whole fraction of the lead.
    pub period_mm: f64,
    /// Phase at position zero.
    #[serde(default)]
    pub phase_rad: f64,
}

impl FrictionRipple {
    /// Change of the sliding level (N) at a place.
    #[must_use]
    pub fn rise_n(&self, place_m: f64) -> f64 {
        self.amplitude_n * harmonic::wave(1e3 * place_m, self.period_mm, self.phase_rad)
    }
}

impl EffectModel for FrictionRipple {
    const NAME: &'static str = "friction_ripple";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("amplitude_n", Unit::Newton, Range::Signed),
        Parameter::new("period_mm", Unit::Millimetre, Range::Positive),
        Parameter::phase("phase_rad"),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];

    fn prerequisite(_axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::WITHOUT_TABLE
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let lead = context.axis.mechanics.lead_mm.filter(|_| context.shows_friction_alone());
        let guess = |period_mm| Self { amplitude_n: 0.0, period_mm, phase_rad: 0.0 };
        lead.into_iter().flat_map(|lead_mm| harmonic::periods(lead_mm, HIGHEST_ORDER)).map(guess).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        harmonic::parts(self.amplitude_n, self.phase_rad, 1.0, 1e5)
    }

    fn at(&self, x: &[f64]) -> Self {
        let (amplitude_n, phase_rad) = harmonic::polar(x);
        Self { amplitude_n, phase_rad, ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.amplitude_n, self.period_mm, self.phase_rad]
    }

    fn distinction(&self) -> Distinction<'_> {
        Distinction::Period(self.period_mm)
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("friction goes up and down by {} (amplitude) every {}", wording.value(0), wording.value(1))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::WithinPeriod(self.period_mm)
    }
}
