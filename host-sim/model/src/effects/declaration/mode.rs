//! A mode in which the tool oscillates.

use serde::{Deserialize, Serialize};

/// Against what the damper of a mode acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DampedAgainst {
    /// Against the ground: H = ω²/(s² + 2ζωs + ω²). At a steady speed the tool lags by 2ζ/ω.
    #[default]
    Ground,
    /// Against the table that carries the tool: H = (2ζωs + ω²)/(s² + 2ζωs + ω²). At a steady speed the tool does not lag.
    Table,
}

impl DampedAgainst {
    /// Whether the damper acts against the ground.
    #[must_use]
    pub const fn is_ground(&self) -> bool {
        matches!(self, Self::Ground)
    }

    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Ground => Self::Table,
            Self::Table => Self::Ground,
        }
    }

    /// Speed of the end of the damper that is not at the tool, over that of the table: 0 or 1.
    #[must_use]
    pub const fn share_of_table(self) -> f64 {
        match self {
            Self::Ground => 0.0,
            Self::Table => 1.0,
        }
    }
}

/// A second-order mode: H of the table's motion, less that motion, times the participation; see [`DampedAgainst`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// ω/2π.
    pub frequency_hz: f64,
    /// ζ.
    pub damping_ratio: f64,
    /// Displacement of the tool in the mode, relative to that of the mass which the table drives.
    pub participation: f64,
    /// Against what its damper acts.
    pub damped_against: DampedAgainst,
}

impl Mode {
    /// Time by which the tool lags behind a table at a steady speed, s.
    #[must_use]
    pub fn lag_s(&self) -> f64 {
        let of_ground = self.damping_ratio / (std::f64::consts::PI * self.frequency_hz);
        self.participation * (1.0 - self.damped_against.share_of_table()) * of_ground
    }
}
