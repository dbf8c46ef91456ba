//! Why a block was rejected.

/// Why a block was rejected. The path is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum PathError {
    /// A number of the block is not finite.
    NotFinite(Field),
    /// A number of the block is not positive, or too small to be resolved at the tick rate.
    NotPositive(Field),
    /// A number of the block exceeds the range of the integer format.
    TooLarge(Field),
    /// Start and end point coincide.
    ZeroLength,
    /// The centre lies less than 1 µm from the start of the arc.
    ZeroRadius,
    /// The plane of an arc names an axis that the machine does not have, or the same axis twice.
    BadPlane,
    /// The end point of an arc is its start point, which could mean a full circle or none: give the number of
    /// turns instead.
    CoincidentEndPoints,
    /// The end point of an arc lies off its circle by more than [`END_TOLERANCE_NM`](super::arc::END_TOLERANCE_NM)
    /// or by more than 1/1024 of the arc length.
    EndOffArc,
    /// The block would take more ticks than the counters hold.
    TooLong,
    /// The queue of blocks is full.
    QueueFull,
    /// The drives are off after an interruption, or the path is stopping: it will be discarded.
    Interrupted,
    /// An axis follows a counter.
    Following,
    /// The machine has no settings yet.
    NotConfigured,
    /// The block leaves the travel of an axis, or leads further out where the axis is outside already.
    BeyondTravel {
        /// Axis, counted from 0.
        axis: u8,
    },
    /// The block moves an axis further onto a limit switch that is active.
    LimitSwitch {
        /// Axis, counted from 0.
        axis: u8,
    },
    /// The block moves an axis with soft limits that has not been homed: its positions are unknown.
    NotHomed {
        /// Axis, counted from 0.
        axis: u8,
    },
    /// The block moves the second motor of a gantry, which has the command of the first.
    SecondMotor {
        /// Axis, counted from 0.
        axis: u8,
    },
}

/// The number of a block that a [`PathError`] refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Field {
    /// End point.
    EndPoint,
    /// Centre of an arc.
    Centre,
    /// Number of turns of an arc.
    Turns,
    /// Feed rate along the path.
    Feed,
    /// Acceleration along the path.
    Acceleration,
    /// Jerk along the path.
    Jerk,
    /// Corner tolerance of a joint.
    Tolerance,
    /// Duration of a dwell.
    Dwell,
    /// Time constants of an axis filter.
    Smoothing,
}

impl core::fmt::Display for PathError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotFinite(field) => write!(f, "{field:?}: expected a finite number"),
            Self::NotPositive(field) => {
                write!(f, "{field:?}: expected a number above 0 that lasts at least one unit a tick")
            }
            Self::TooLarge(field) => write!(f, "{field:?}: larger than the controller can hold"),
            Self::ZeroLength => write!(f, "the block ends where it starts"),
            Self::ZeroRadius => write!(f, "the arc's radius is below 1 µm"),
            Self::BadPlane => write!(f, "the arc's plane must name two different axes of the machine"),
            Self::CoincidentEndPoints => {
                write!(f, "the arc ends where it starts: a full circle is to be given in turns")
            }
            Self::EndOffArc => write!(f, "the arc's end point lies off its circle"),
            Self::TooLong => write!(f, "the block lasts longer than the controller can count"),
            Self::QueueFull => write!(f, "the queue of blocks is full"),
            Self::BeyondTravel { axis } => write!(f, "axis {axis}: the block leads out of the travel"),
            Self::LimitSwitch { axis } => {
                write!(f, "axis {axis}: the block leads onto an active limit switch")
            }
            Self::NotHomed { axis } => write!(f, "axis {axis}: it has to be homed before a program moves it"),
            Self::SecondMotor { axis } => {
                write!(f, "axis {axis}: it is the second motor of a gantry, and moves with the first")
            }
            Self::NotConfigured => write!(f, "the machine has no settings yet"),
            Self::Following => write!(f, "an axis follows a counter"),
            Self::Interrupted => {
                write!(f, "the drives have gone off, or stop the path: it is forgotten")
            }
        }
    }
}

impl core::error::Error for PathError {}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString;

    use super::*;

    /// Each error has words of its own, and names what it is about.
    #[test]
    fn each_error_has_its_own_words() {
        let errors = [
            PathError::NotFinite(Field::Feed),
            PathError::NotPositive(Field::Feed),
            PathError::TooLarge(Field::Feed),
            PathError::ZeroLength,
            PathError::ZeroRadius,
            PathError::BadPlane,
            PathError::CoincidentEndPoints,
            PathError::EndOffArc,
            PathError::TooLong,
            PathError::QueueFull,
            PathError::Interrupted,
            PathError::Following,
            PathError::NotConfigured,
            PathError::BeyondTravel { axis: 7 },
            PathError::LimitSwitch { axis: 7 },
            PathError::NotHomed { axis: 7 },
            PathError::SecondMotor { axis: 7 },
        ];
        let mut words: std::vec::Vec<_> = errors.iter().map(ToString::to_string).collect();
        assert!(words[..3].iter().all(|words| words.starts_with("Feed: ")));
        assert!(words[13..].iter().all(|words| words.starts_with("axis 7: ")));
        words.sort();
        words.dedup();
        assert_eq!(words.len(), errors.len(), "{words:?}");
    }
}
