//! Torque ripple: a force on the motor that repeats with its angle.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings, harmonic};

/// Highest order of a screw turn that is looked for.
const HIGHEST_ORDER: u32 = 12;

/// Adds amplitude·sin(2π·motor/period + phase) to the drive's force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueRipple {
    /// Half of peak to peak.
    pub amplitude_n: f64,
    /// A whole fraction of the lead.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
}

impl TorqueRipple {
    /// Force on the motor, N, on top of what the drive was asked for.
    #[must_use]
    pub fn force_n(&self, motor_m: f64) -> f64 {
        self.amplitude_n * harmonic::wave(1e3 * motor_m, self.period_mm, self.phase_rad)
    }
}

impl Kind for TorqueRipple {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let lead = around.axis.mechanics.lead_mm.filter(|_| around.axis.has_mass());
        let orders = |lead: f64| {
            (1..=HIGHEST_ORDER).map(move |order| Self {
                amplitude_n: 0.0,
                period_mm: lead / f64::from(order),
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
