//! A piece of path in SI, as a program or a host gives it.

use serde::{Deserialize, Serialize};

/// One piece of a path; it starts where the one before ended, at rest, and ends at rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block<const N: usize> {
    /// What is travelled.
    #[serde(bound = "")]
    pub shape: Shape<N>,
    /// Greatest speed along the path, m/s. Not used by a dwell.
    pub feed_m_per_s: f64,
    /// Greatest acceleration along the path, m/s². Not used by a dwell.
    pub acceleration_m_per_s2: f64,
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
}

impl<const N: usize> Block<N> {
    /// A straight line.
    #[must_use]
    pub const fn line(to_m: [f64; N], feed_m_per_s: f64, acceleration_m_per_s2: f64) -> Self {
        Self { shape: Shape::Line { to_m }, feed_m_per_s, acceleration_m_per_s2 }
    }

    /// A pause.
    #[must_use]
    pub const fn dwell(seconds: f64) -> Self {
        Self { shape: Shape::Dwell { seconds }, feed_m_per_s: 0.0, acceleration_m_per_s2: 0.0 }
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
