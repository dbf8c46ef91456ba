//! Resonance: the tool swings behind the table.

use serde::{Deserialize, Serialize};

use super::latency::Channel;
use super::{Coordinate, Kind, Stage, Surroundings};

/// The channel follows the table as ω²/(s² + 2ζωs + ω²).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resonance {
    /// Which signal swings; only the tool is modelled.
    #[serde(default = "tool")]
    pub channel: Channel,
    /// ω/2π.
    pub frequency_hz: f64,
    /// ζ.
    pub damping_ratio: f64,
}

fn tool() -> Channel {
    Channel::Tool
}

impl Kind for Resonance {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn starts(_around: &Surroundings<'_>) -> Vec<Self> {
        [15.0, 30.0, 60.0, 120.0]
            .map(|frequency_hz| Self { channel: tool(), frequency_hz, damping_ratio: 0.05 })
            .to_vec()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate { step: 0.1, ..Coordinate::scale(self.frequency_hz, 1.0, 400.0) },
            // A structure rings; what is damped by more is late.
            Coordinate::scale(self.damping_ratio, 0.001, 0.3),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { frequency_hz: x[0], damping_ratio: x[1], ..self.clone() }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("frequency_hz", self.frequency_hz), ("damping_ratio", self.damping_ratio)]
    }
}
