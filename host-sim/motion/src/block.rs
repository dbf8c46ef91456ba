//! A motion and its blocks.

use indexmap::IndexMap;
use serde::Deserialize;
use shared::interpolate::Ramps;

/// A checked motion: each block can be run from the end of the previous block.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Name for reports and file names.
    pub name: String,
    /// Initial positions of all axes, in the order of the file.
    pub start_mm: IndexMap<String, f64>,
    /// Blocks in the order of execution.
    pub blocks: Vec<Block>,
}

/// One block.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// Standstill.
    Dwell {
        /// Duration.
        seconds: f64,
    },
    /// A straight line of all axes.
    Line {
        /// End position of each axis, including axes that do not move.
        to_mm: IndexMap<String, f64>,
        /// Feed, acceleration and ramps.
        pace: Pace,
    },
    /// An arc of two axes about a centre, from the current position.
    Arc {
        /// First and second axis. Counter-clockwise is the rotation from + of the first to + of the second.
        plane: [String; 2],
        /// Centre, in the order of the plane.
        centre_mm: [f64; 2],
        /// End of the arc.
        sweep: Sweep,
        /// Feed, acceleration and ramps.
        pace: Pace,
    },
}

/// End of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sweep {
    /// Number of turns; positive: counter-clockwise.
    Turns(f64),
    /// A point on the circle.
    To {
        /// End point, in the order of the plane.
        to_mm: [f64; 2],
        /// Sense of rotation.
        direction: Direction,
    },
}

/// Sense of rotation of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Counter-clockwise: from + of the first axis of the plane to + of the second.
    Positive,
    /// Clockwise.
    Negative,
}

/// Feed, acceleration, ramps and joint of a line or an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Path speed.
    pub feed_mm_per_min: f64,
    /// Path acceleration.
    pub acceleration_m_per_s2: f64,
    /// Shape of acceleration and deceleration.
    pub ramps: Ramps,
    /// Largest deviation from the corner at the end of the block; 0: exact stop.
    pub joint_tolerance_um: f64,
}

impl Pace {
    /// A speed, mm/s, and acceleration, m/s², with trapezoidal ramps and an exact stop.
    #[must_use]
    pub const fn with_exact_stop(mm_per_s: f64, acceleration_m_per_s2: f64) -> Self {
        let feed_mm_per_min = 60.0 * mm_per_s;
        Self { feed_mm_per_min, acceleration_m_per_s2, ramps: Ramps::Trapezoid, joint_tolerance_um: 0.0 }
    }
}
