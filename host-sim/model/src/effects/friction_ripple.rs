//! Friction ripple: friction that changes over a turn of the screw.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings, harmonic};

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

impl Kind for FrictionRipple {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let lead = around.axis.mechanics.lead_mm.filter(|_| around.shows_friction_alone());
        let orders = |lead: f64| {
            let period = move |order| lead / f64::from(order);
            (1..=HIGHEST_ORDER).map(move |order| Self {
                amplitude_n: 0.0,
                period_mm: period(order),
                phase_rad: 0.0,
            })
        };
        lead.into_iter().flat_map(orders).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        harmonic::parts(self.amplitude_n, self.phase_rad, 1.0, 1e5)
    }

    fn at(&self, x: &[f64]) -> Self {
        let (amplitude_n, phase_rad) = harmonic::polar(x);
        Self { amplitude_n, phase_rad, ..self.clone() }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("amplitude_n", self.amplitude_n), ("period_mm", self.period_mm), ("phase_rad", self.phase_rad)]
    }
}
