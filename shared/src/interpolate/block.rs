//! A piece of path in SI, as a program or a host gives it.

use serde::{Deserialize, Serialize};

/// One piece of a path; it starts where the one before ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block<const N: usize> {
    /// What is travelled.
    #[serde(bound = "")]
    pub shape: Shape<N>,
    /// Greatest speed along the path, m/s. Not used by a dwell.
    pub feed_m_per_s: f64,
    /// Greatest acceleration, m/s²: along the path, and together with that towards the centre of an arc.
    /// Not used by a dwell.
    pub acceleration_m_per_s2: f64,
    /// How the speed rises and falls. Not used by a dwell.
    pub ramps: Ramps,
    /// How the path goes on from the end of this block.
    pub joint: Joint,
}

/// How the speed along a block rises and falls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Ramps {
    /// With the block's acceleration, which jumps.
    #[default]
    Trapezoid,
    /// With an acceleration that rises and falls with a jerk.
    SCurve {
        /// Greatest jerk, m/s³.
        jerk_m_per_s3: f64,
    },
    /// Exponentially, with the block's acceleration at the most. Starts and ends at rest.
    Exponential,
    /// Not at all: the feed stands from start to end, for the filters behind the path to smooth
    /// ([`super::Smoothing`]). It is lowered where they would accelerate by more than the block allows.
    AfterInterpolation,
}

/// How the path goes on from the end of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Joint {
    /// From rest.
    #[default]
    Stop,
    /// At the greatest speed that keeps acceleration and jerk, and keeps the command, behind the filters of
    /// the axes, within a tolerance of the path.
    Within {
        /// Greatest distance from the corner, m.
        tolerance_m: f64,
    },
}

/// The geometry of a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shape<const N: usize> {
    /// Stand still.
    Dwell {
        /// How long.
        seconds: f64,
    },
    /// Straight to a point.
    Line {
        /// End point, m.
        #[serde(with = "array")]
        to_m: [f64; N],
    },
    /// Round a centre.
    Arc {
        /// The two axes that turn; positive turns run from the first towards the second.
        plane: [u8; 2],
        /// Centre in the plane's axes, m.
        centre_m: [f64; 2],
        /// Signed turns, any fraction.
        turns: f64,
    },
    /// Round a centre to a point on the circle.
    ArcTo {
        /// The two axes that turn.
        plane: [u8; 2],
        /// Centre in the plane's axes, m.
        centre_m: [f64; 2],
        /// End point in the plane's axes, m.
        to_m: [f64; 2],
        /// From the plane's first axis towards its second, or the other way.
        positive: bool,
    },
}

impl<const N: usize> Block<N> {
    /// A straight line.
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

    /// A circular arc by signed turns round a centre.
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

    /// A pause.
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

    /// The same with other ramps.
    #[must_use]
    pub const fn with_ramps(self, ramps: Ramps) -> Self {
        Self { ramps, ..self }
    }

    /// The same, joined to the next one within a tolerance.
    #[must_use]
    pub const fn within(self, tolerance_m: f64) -> Self {
        Self { joint: Joint::Within { tolerance_m }, ..self }
    }
}

/// serde knows arrays of a const length only up to 32 and not generically: as a tuple of N.
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
