//! Blocks: the segments of a path in SI, as a program or a host gives them.

use serde::{Deserialize, Serialize};

/// One segment of a path of `N` axes.
pub type Block<const N: usize> = BlockOf<[f64; N]>;

/// One segment of a path whose end points are of a type: an array of as many axes as the path has, or a list in a message. It starts at the
/// end of the previous block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlockOf<P> {
    /// Geometry.
    pub shape: ShapeOf<P>,
    /// Greatest speed along the path, m/s. Ignored by a dwell.
    pub feed_m_per_s: f64,
    /// Greatest acceleration, m/s²: on an arc, of the tangential and centripetal components together. Ignored by a dwell.
    pub acceleration_m_per_s2: f64,
    /// Shape of the speed ramps. Ignored by a dwell.
    pub ramps: Ramps,
    /// Transition to the next block.
    pub joint: Joint,
}

/// The shape of the speed ramps of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Ramps {
    /// Constant acceleration, which jumps.
    #[default]
    Trapezoid,
    /// Limited jerk.
    SCurve {
        /// Greatest jerk, m/s³.
        jerk_m_per_s3: f64,
    },
    /// A first-order lag, whose greatest acceleration is that of the block. The block starts and ends at rest.
    Exponential,
    /// No ramps: constant feed from start to end, smoothed by the axis filters behind the path
    /// ([`super::smooth::Smoothing`]). The feed is lowered if the filters would exceed the acceleration of the block.
    AfterInterpolation,
}

/// The transition from one block to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Joint {
    /// Stop at the end of the block.
    #[default]
    Stop,
    /// Pass at the greatest speed that keeps acceleration, jerk and, behind the axis filters, a tolerance to the corner.
    Within {
        /// Greatest distance of the command from the corner, m.
        tolerance_m: f64,
    },
}

/// The geometry of a block of `N` axes.
pub type Shape<const N: usize> = ShapeOf<[f64; N]>;

/// The geometry of a block whose end points are of a type.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ShapeOf<P> {
    /// Standstill.
    Dwell {
        /// Duration, s.
        seconds: f64,
    },
    /// Straight line to a point.
    Line {
        /// End point, m.
        to_m: P,
    },
    /// Circular arc by a number of turns.
    Arc {
        /// The two axes of the plane; positive turns are from the first towards the second.
        plane: [u8; 2],
        /// Centre in the axes of the plane, m.
        centre_m: [f64; 2],
        /// Signed number of turns, not necessarily whole.
        turns: f64,
    },
    /// Circular arc to an end point.
    ArcTo {
        /// The two axes of the plane.
        plane: [u8; 2],
        /// Centre in the axes of the plane, m.
        centre_m: [f64; 2],
        /// End point in the axes of the plane, m.
        to_m: [f64; 2],
        /// Whether the direction is from the first axis of the plane towards the second.
        positive: bool,
    },
}

impl<const N: usize> Block<N> {
    /// A straight line that starts and ends at rest.
    #[must_use]
    pub const fn line(to_m: [f64; N], feed_m_per_s: f64, acceleration_m_per_s2: f64) -> Self {
        Self::line_to(to_m, feed_m_per_s, acceleration_m_per_s2)
    }

    /// A circular arc that starts and ends at rest.
    #[must_use]
    pub const fn arc(
        plane: [u8; 2],
        centre_m: [f64; 2],
        turns: f64,
        feed_m_per_s: f64,
        acceleration_m_per_s2: f64,
    ) -> Self {
        let shape = Shape::Arc { plane, centre_m, turns };
        Self { shape, feed_m_per_s, acceleration_m_per_s2, ramps: Ramps::Trapezoid, joint: Joint::Stop }
    }

    /// The block with other ramps.
    #[must_use]
    pub const fn with_ramps(self, ramps: Ramps) -> Self {
        Self { ramps, ..self }
    }

    /// The block with a transition to the next one within a tolerance, m.
    #[must_use]
    pub const fn within(self, tolerance_m: f64) -> Self {
        Self { joint: Joint::Within { tolerance_m }, ..self }
    }
}

impl<P> BlockOf<P> {
    /// A straight line to an end point in any form, from rest to rest.
    #[must_use]
    pub const fn line_to(to_m: P, feed_m_per_s: f64, acceleration_m_per_s2: f64) -> Self {
        Self {
            shape: ShapeOf::Line { to_m },
            feed_m_per_s,
            acceleration_m_per_s2,
            ramps: Ramps::Trapezoid,
            joint: Joint::Stop,
        }
    }

    /// A dwell, s.
    #[must_use]
    pub const fn dwell(seconds: f64) -> Self {
        Self {
            shape: ShapeOf::Dwell { seconds },
            feed_m_per_s: 0.0,
            acceleration_m_per_s2: 0.0,
            ramps: Ramps::Trapezoid,
            joint: Joint::Stop,
        }
    }

    /// The block with its end point in another form.
    pub fn map<Q>(self, end: impl FnOnce(P) -> Q) -> BlockOf<Q> {
        let shape = match self.shape {
            ShapeOf::Dwell { seconds } => ShapeOf::Dwell { seconds },
            ShapeOf::Line { to_m } => ShapeOf::Line { to_m: end(to_m) },
            ShapeOf::Arc { plane, centre_m, turns } => ShapeOf::Arc { plane, centre_m, turns },
            ShapeOf::ArcTo { plane, centre_m, to_m, positive } => {
                ShapeOf::ArcTo { plane, centre_m, to_m, positive }
            }
        };
        let Self { feed_m_per_s, acceleration_m_per_s2, ramps, joint, .. } = self;
        BlockOf { shape, feed_m_per_s, acceleration_m_per_s2, ramps, joint }
    }
}

impl<P: AsRef<[f64]>> BlockOf<P> {
    /// The block for a path of `N` axes; `None` if its end point has another number of them.
    #[must_use]
    pub fn of_axes<const N: usize>(&self) -> Option<Block<N>> {
        let Self { feed_m_per_s, acceleration_m_per_s2, ramps, joint, .. } = *self;
        let shape = match &self.shape {
            ShapeOf::Dwell { seconds } => Shape::Dwell { seconds: *seconds },
            ShapeOf::Line { to_m } => Shape::Line { to_m: to_m.as_ref().try_into().ok()? },
            ShapeOf::Arc { plane, centre_m, turns } => {
                Shape::Arc { plane: *plane, centre_m: *centre_m, turns: *turns }
            }
            ShapeOf::ArcTo { plane, centre_m, to_m, positive } => {
                Shape::ArcTo { plane: *plane, centre_m: *centre_m, to_m: *to_m, positive: *positive }
            }
        };
        Some(Block { shape, feed_m_per_s, acceleration_m_per_s2, ramps, joint })
    }
}
