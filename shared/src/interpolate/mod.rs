//! From blocks to a command position every tick.
//!
//! A [`Block`] in SI is planned once ([`planned`]): its geometry becomes a [`mod@line`] or an [`arc`]
//! over the path length; its length over time becomes a [`profile`], whose ramps [`ramp`] plans, or an
//! [`exponential`]. At a [`joint`] the path passes from block to block at speed, or stops. Behind it,
//! [`smooth`] can filter each axis. All of it is integer.

pub mod arc;
pub mod block;
pub mod exponential;
pub mod joint;
pub mod line;
pub mod path;
pub mod planned;
pub mod profile;
pub mod ramp;
pub mod smooth;
pub mod turn;

pub use block::{Block, Joint, Ramps};
pub use path::Path;
pub use smooth::Smoothing;

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
    /// The end point of an arc is its start point: whether that is a full circle or none has to be
    /// said in turns.
    CoincidentEndPoints,
    /// The end point of an arc lies further from the circle than [`arc::END_TOLERANCE_NM`], or than a 1024th of
    /// its length.
    EndOffArc,
    /// The block would last longer than can be counted.
    TooLong,
    /// The queue holds no more blocks.
    QueueFull,
    /// The drives have gone off, or go off once the path stands: it is forgotten then.
    Interrupted,
    /// The machine has no settings yet.
    NotConfigured,
    /// The block leads out of the travel of an axis, or further out than the axis is.
    BeyondTravel {
        /// Axis, counted from 0.
        axis: u8,
    },
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
    /// Jerk along the path.
    Jerk,
    /// Tolerance of a joint.
    Tolerance,
    /// Length of a dwell.
    Dwell,
    /// Times of the filter behind the path.
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
            Self::NotConfigured => write!(f, "the machine has no settings yet"),
            Self::Interrupted => {
                write!(f, "the drives have gone off, or stop the path: it is forgotten")
            }
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

/// a·b/2⁶⁴, up to two units too small: the product of the lower halves is left out.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the halves")]
pub(crate) const fn high(a: i64, b: i64) -> i64 {
    let (a_high, a_low) = ((a >> 32) as i32 as i64, a as u32 as i64);
    let (b_high, b_low) = ((b >> 32) as i32 as i64, b as u32 as i64);
    a_high * b_high + ((a_high * b_low) >> 32) + ((a_low * b_high) >> 32)
}

/// `value`·`part`/2³², rounded down.
#[must_use]
pub(crate) fn share(value: i64, part: u32) -> i64 {
    let (high, low) = (value >> 32, value & 0xffff_ffff);
    let low = (low.cast_unsigned() * u64::from(part)) >> 32;
    (high.wrapping_mul(i64::from(part))).wrapping_add(low.cast_signed())
}

/// Fraction bits of positions and speeds that are added up.
pub(crate) const FRACTION: u32 = 64;

/// Whole position units of a distance with 64 fraction bits.
#[must_use]
pub(crate) const fn whole(distance: i128) -> i64 {
    (distance >> FRACTION) as i64
}

/// A speed with 16 fraction bits, of a step with 64; none where a step that would have led backwards stops short.
#[must_use]
pub(crate) const fn speed(step: i128) -> u64 {
    if step < 0 {
        return 0;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "feeds are below 2⁵⁷")]
    let speed = (step >> (FRACTION - 16)) as u64;
    speed
}
