//! The blocks that a controller gets: in the axes of a machine, in m and s.

use shared::interpolate::block::Shape;
use shared::interpolate::{Block, Joint, Ramps};

/// Maximum number of axes of a path.
pub const MAX_AXES: usize = 3;

/// A block of the path for any number of axes; see [`shared::interpolate::Block`].
#[derive(Clone, Debug, PartialEq)]
pub struct PathBlock {
    /// Geometry.
    pub shape: PathShape,
    /// Speed along the path, m/s.
    pub feed_m_per_s: f64,
    /// Acceleration along the path, m/s².
    pub acceleration_m_per_s2: f64,
    /// Profile of the speed at start and end.
    pub ramps: Ramps,
    /// Transition to the next block.
    pub joint: Joint,
}

/// Geometry of a [`PathBlock`].
#[derive(Clone, Debug, PartialEq)]
pub enum PathShape {
    /// Standstill.
    Dwell {
        /// Duration, s.
        seconds: f64,
    },
    /// A straight line to a point.
    Line {
        /// End point, one coordinate per axis, m.
        to_m: Vec<f64>,
    },
    /// An arc about a centre.
    Arc {
        /// Indices of the two axes.
        plane: [u8; 2],
        /// Centre in those axes, m.
        centre_m: [f64; 2],
        /// Number of turns, positive from the first axis to the second.
        turns: f64,
    },
    /// An arc about a centre to a point on its circle.
    ArcTo {
        /// Indices of the two axes.
        plane: [u8; 2],
        /// Centre in those axes, m.
        centre_m: [f64; 2],
        /// End point in those axes, m.
        to_m: [f64; 2],
        /// Whether it turns from the first axis to the second.
        positive: bool,
    },
}

impl PathBlock {
    /// A shape with trapezoidal ramps, from rest to rest.
    #[must_use]
    pub const fn new(shape: PathShape, feed_m_per_s: f64, acceleration_m_per_s2: f64) -> Self {
        Self { shape, feed_m_per_s, acceleration_m_per_s2, ramps: Ramps::Trapezoid, joint: Joint::Stop }
    }

    /// A standstill of some seconds.
    #[must_use]
    pub const fn dwell(seconds: f64) -> Self {
        Self::new(PathShape::Dwell { seconds }, 0.0, 0.0)
    }

    /// The block for a machine of `N` axes; `None` if the number of coordinates differs.
    #[must_use]
    pub fn for_axes<const N: usize>(&self) -> Option<Block<N>> {
        let shape = match &self.shape {
            PathShape::Dwell { seconds } => Shape::Dwell { seconds: *seconds },
            PathShape::Line { to_m } => Shape::Line { to_m: to_m.as_slice().try_into().ok()? },
            PathShape::Arc { plane, centre_m, turns } => {
                Shape::Arc { plane: *plane, centre_m: *centre_m, turns: *turns }
            }
            PathShape::ArcTo { plane, centre_m, to_m, positive } => {
                Shape::ArcTo { plane: *plane, centre_m: *centre_m, to_m: *to_m, positive: *positive }
            }
        };
        Some(Block {
            shape,
            feed_m_per_s: self.feed_m_per_s,
            acceleration_m_per_s2: self.acceleration_m_per_s2,
            ramps: self.ramps,
            joint: self.joint,
        })
    }
}
