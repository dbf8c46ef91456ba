//! From blocks to a command position every tick.
//!
//! A [`Block`] in SI is planned once ([`planned`]): its geometry becomes a [`mod@line`] or an [`arc`]
//! over the path length, its speed a [`trapezoid`] over time. All of it is integer.

pub mod arc;
pub mod block;
pub mod line;
pub mod path;
pub mod planned;
pub mod trapezoid;
pub mod turn;

pub use block::Block;
pub use path::Path;

/// Why a block was refused. The path is as it was before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum PathError {
    /// A number of the block is not finite.
    NotFinite(Field),
    /// A number of the block must be greater than zero, and large enough for the tick rate.
    NotPositive(Field),
    /// A number of the block is larger than the format holds.
    TooLarge(Field),
    /// Start and end are the same point.
    ZeroLength,
    /// The centre lies less than 1 µm from the start of the arc.
    ZeroRadius,
    /// An arc names an axis that the machine has not, or one axis twice.
    BadPlane,
    /// The queue holds no more blocks.
    QueueFull,
}

/// The number of a block that a [`PathError`] is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Field {
    /// End point.
    EndPoint,
    /// Centre of an arc.
    Centre,
    /// Turns of an arc.
    Turns,
    /// Feed along the path.
    Feed,
    /// Acceleration along the path.
    Acceleration,
    /// Length of a dwell.
    Dwell,
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
            Self::QueueFull => write!(f, "the queue of blocks is full"),
        }
    }
}

impl core::error::Error for PathError {}

/// `a·b / 2^SHIFT`, exact before one rounding to nearest.
#[must_use]
pub(crate) fn scaled<const SHIFT: u32>(a: i64, b: i64) -> i64 {
    let product = i128::from(a) * i128::from(b) + (1 << (SHIFT - 1));
    #[expect(clippy::cast_possible_truncation, reason = "callers keep |a·b| below 2^(63 + SHIFT)")]
    let scaled = (product >> SHIFT) as i64;
    scaled
}
