//! What a motion consists of.

use indexmap::IndexMap;
use serde::Deserialize;
use shared::interpolate::Ramps;

/// A motion that has been checked: every block can be run from where the one before it ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// For people and file names.
    pub name: String,
    /// Where the axes stand at the beginning; names all axes, in the order of the file.
    pub start_mm: IndexMap<String, f64>,
    /// What they do, one after the other.
    pub blocks: Vec<Block>,
}

/// One block.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// Standstill.
    Dwell {
        /// How long.
        seconds: f64,
    },
    /// A straight line of all axes.
    Line {
        /// Target of every axis, also of those that stay.
        to_mm: IndexMap<String, f64>,
        /// How fast.
        pace: Pace,
    },
    /// An arc of two axes about a centre, starting where they stand.
    Arc {
        /// First and second axis: counter-clockwise leads from the first's + to the second's +.
        plane: [String; 2],
        /// Centre, in the order of the plane.
        centre_mm: [f64; 2],
        /// How far round.
        sweep: Sweep,
        /// How fast.
        pace: Pace,
    },
}

/// Where an arc ends. Positive is counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sweep {
    /// By signed turns.
    Turns(f64),
    /// To a point on the circle.
    To {
        /// In the order of the plane.
        to_mm: [f64; 2],
        /// Sense of rotation.
        direction: Direction,
    },
}

/// Sense of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// From the plane's first axis to its second.
    Positive,
    /// The other way.
    Negative,
}

/// How a line or an arc is travelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Path speed.
    pub feed_mm_per_min: f64,
    /// Path acceleration.
    pub acceleration_m_per_s2: f64,
    /// How the speed rises and falls.
    pub ramps: Ramps,
    /// Largest distance from the corner at the end of the block; 0: exact stop.
    pub joint_tolerance_um: f64,
}
