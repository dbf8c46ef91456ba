//! Cyclic pitch error: the screw wobbles once a turn.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings, harmonic};

/// The screw carries the table amplitude·sin(2π·motor/period + phase) further than its lead says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PitchCyclic {
    /// Half of peak to peak.
    pub amplitude_um: f64,
    /// The screw's lead.
    pub period_mm: f64,
    /// Phase at motor position zero.
    #[serde(default)]
    pub phase_rad: f64,
}

impl PitchCyclic {
    /// How much further than nominal the screw carries the table, m.
    #[must_use]
    pub fn error_m(&self, motor_m: f64) -> f64 {
        1e-6 * self.amplitude_um * harmonic::wave(1e3 * motor_m, self.period_mm, self.phase_rad)
    }
}

impl Kind for PitchCyclic {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let lead = around.axis.mechanics.lead_mm.filter(|_| around.stages.contains(&Stage::Table));
        let start = |period_mm| Self { amplitude_um: 0.0, period_mm, phase_rad: 0.0 };
        lead.into_iter().map(start).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        harmonic::parts(self.amplitude_um, self.phase_rad, 0.1, 1e3)
    }

    fn at(&self, x: &[f64]) -> Self {
        let (amplitude_um, phase_rad) = harmonic::polar(x);
        Self { amplitude_um, phase_rad, ..self.clone() }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![
            ("amplitude_um", self.amplitude_um),
            ("period_mm", self.period_mm),
            ("phase_rad", self.phase_rad),
        ]
    }
}
