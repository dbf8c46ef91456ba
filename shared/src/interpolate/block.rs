//! Blocks: the segments of a path in SI, as a program or a host gives them.

use serde::{Deserialize, Serialize};

/// One segment of a path. It starts at the end of the previous block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block<const N: usize> {
    /// Geometry.
    #[serde(bound = "")]
    pub shape: Shape<N>,
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

/// The geometry of a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shape<const N: usize> {
    /// Standstill.
    Dwell {
        /// Duration, s.
        seconds: f64,
    },
    /// Straight line to a point.
    Line {
        /// End point, m.
        #[serde(with = "array")]
        to_m: [f64; N],
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
        Self {
            shape: Shape::Line { to_m },
            feed_m_per_s,
            acceleration_m_per_s2,
            ramps: Ramps::Trapezoid,
            joint: Joint::Stop,
        }
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

    /// A dwell, s.
    #[must_use]
    pub const fn dwell(seconds: f64) -> Self {
        Self {
            shape: Shape::Dwell { seconds },
            feed_m_per_s: 0.0,
            acceleration_m_per_s2: 0.0,
            ramps: Ramps::Trapezoid,
            joint: Joint::Stop,
        }
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

/// Serialises an array of const length as a tuple: serde implements arrays only up to 32, and not generically.
mod array {
    use core::fmt;

    use serde::de::{Error, SeqAccess, Visitor};
    use serde::ser::SerializeTuple;
    use serde::{Deserializer, Serializer};

    pub fn serialize<S: Serializer, const N: usize>(array: &[f64; N], to: S) -> Result<S::Ok, S::Error> {
        let mut tuple = to.serialize_tuple(N)?;
        for element in array {
            tuple.serialize_element(element)?;
        }
        tuple.end()
    }

    pub fn deserialize<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<[f64; N], D::Error> {
        struct Elements<const N: usize>;
        impl<'de, const N: usize> Visitor<'de> for Elements<N> {
            type Value = [f64; N];

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{N} numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<[f64; N], A::Error> {
                let mut array = [0.0; N];
                for (i, element) in array.iter_mut().enumerate() {
                    *element = seq.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?;
                }
                Ok(array)
            }
        }
        from.deserialize_tuple(N, Elements)
    }
}
