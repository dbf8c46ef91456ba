//! The settings of a homing in SI.

use super::HomingError;
use crate::units::{Position, TRAVEL_LIMIT_M};

/// A direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Direction {
    /// Towards smaller positions.
    Negative,
    /// Towards greater positions.
    Positive,
}

impl Direction {
    /// −1 or 1.
    #[must_use]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Negative => -1.0,
            Self::Positive => 1.0,
        }
    }

    /// The other direction.
    #[must_use]
    pub const fn reversed(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Positive => Self::Negative,
        }
    }
}

/// The mark that gives the position of the axis.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Mark {
    /// The edge of the home switch, as passed in the approach. Repeatable to the switch and to approach speed × tick.
    SwitchEdge,
    /// The first index pulse of the motor encoder after that edge.
    MotorIndex {
        /// Distance between index pulses, m of table travel: the lead for an encoder on the screw.
        spacing_m: f64,
    },
    /// The single index pulse of the linear scale after that edge.
    ScaleIndex {
        /// Greatest distance from the edge to the pulse, m.
        within_m: f64,
    },
}

impl Mark {
    /// Greatest distance from the edge to the index pulse, m; 0 without an index.
    #[must_use]
    pub const fn index_distance_m(self) -> f64 {
        match self {
            Self::SwitchEdge => 0.0,
            Self::MotorIndex { spacing_m: m } | Self::ScaleIndex { within_m: m } => m,
        }
    }
}

/// What a limit switch does during the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum AtLimit {
    /// The axis started beyond the home switch: it turns round and searches in the other direction.
    TurnRound,
    /// The homing fails.
    Fail,
}

/// How an axis is homed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HomingSettings {
    /// Direction in which the home switch is approached.
    pub direction: Direction,
    /// The mark that gives the position.
    pub mark: Mark,
    /// Position of the axis at the mark, m.
    pub mark_position_m: f64,
    /// Speed of the search for the switch, and of backing off, m/s.
    pub search_speed_m_per_s: f64,
    /// Speed of the approach to switch and mark, m/s.
    pub approach_speed_m_per_s: f64,
    /// Acceleration of these motions, m/s².
    pub acceleration_m_per_s2: f64,
    /// Greatest distance of the search: the length of the travel, m.
    pub search_distance_m: f64,
    /// Greatest distance of backing off, m: more than the width of the switch and the braking distance from search speed.
    pub back_off_distance_m: f64,
    /// What a limit switch does during the search.
    pub at_limit: AtLimit,
    /// Greatest duration, s.
    pub timeout_s: f64,
}

impl HomingSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`HomingError::Setting`] with the name of the setting.
    pub fn check(&self) -> Result<(), HomingError> {
        let index = match self.mark {
            // Above 0, so that it passes.
            Mark::SwitchEdge => ("", 1.0),
            Mark::MotorIndex { spacing_m } => ("spacing_m", spacing_m),
            Mark::ScaleIndex { within_m } => ("within_m", within_m),
        };
        let distances = [
            ("search_distance_m", self.search_distance_m),
            ("back_off_distance_m", self.back_off_distance_m),
            index,
        ];
        let rates = [
            ("search_speed_m_per_s", self.search_speed_m_per_s),
            ("approach_speed_m_per_s", self.approach_speed_m_per_s),
            ("acceleration_m_per_s2", self.acceleration_m_per_s2),
            ("timeout_s", self.timeout_s),
        ];
        // A NaN is neither above 0 nor below the limit.
        for (name, value) in distances {
            if !(value > 0.0 && value <= TRAVEL_LIMIT_M) {
                return Err(HomingError::Setting(name));
            }
        }
        for (name, value) in rates {
            if !(value > 0.0 && value < f64::INFINITY) {
                return Err(HomingError::Setting(name));
            }
        }
        if Position::from_m(self.mark_position_m).is_none() {
            return Err(HomingError::Setting("mark_position_m"));
        }
        let braking_m =
            self.search_speed_m_per_s * self.search_speed_m_per_s / 2.0 / self.acceleration_m_per_s2;
        if braking_m > self.back_off_distance_m {
            return Err(HomingError::Setting("back_off_distance_m"));
        }
        Ok(())
    }
}
