//! The blocks that a controller gets: in the axes of a machine, in m and s.

use shared::interpolate::block::ShapeOf;
use shared::interpolate::{Block, BlockOf, Joint, Ramps};
use shared::link::message::PerAxis;

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
        self.with_end(|to_m| to_m.try_into().ok())
    }

    /// The block as a board takes it; `None` for more coordinates than a board has axes.
    #[must_use]
    pub fn for_board(&self) -> Option<BlockOf<PerAxis<f64>>> {
        self.with_end(|to_m| PerAxis::from_slice(to_m).ok())
    }

    /// The block with the end point of a line in another form.
    fn with_end<P>(&self, end: impl FnOnce(&[f64]) -> Option<P>) -> Option<BlockOf<P>> {
        let shape = match &self.shape {
            PathShape::Dwell { seconds } => ShapeOf::Dwell { seconds: *seconds },
            PathShape::Line { to_m } => ShapeOf::Line { to_m: end(to_m)? },
            PathShape::Arc { plane, centre_m, turns } => {
                ShapeOf::Arc { plane: *plane, centre_m: *centre_m, turns: *turns }
            }
            PathShape::ArcTo { plane, centre_m, to_m, positive } => {
                ShapeOf::ArcTo { plane: *plane, centre_m: *centre_m, to_m: *to_m, positive: *positive }
            }
        };
        Some(BlockOf {
            shape,
            feed_m_per_s: self.feed_m_per_s,
            acceleration_m_per_s2: self.acceleration_m_per_s2,
            ramps: self.ramps,
            joint: self.joint,
        })
    }
}
