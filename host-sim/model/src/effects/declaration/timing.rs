//! What a file may leave open of the timing of an axis, and an effect describes.

use super::stage::Channel;

/// The time that an effect describes. The tracer fits small deviations of it without an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Timing {
    /// When a channel is read.
    Reading {
        /// The channel.
        channel: Channel,
        /// How late, ms; negative: early.
        late_ms: f64,
    },
    /// The age of the velocity in the velocity loop.
    VelocityAge,
    /// The lag of the drive's force.
    DriveLag,
}
