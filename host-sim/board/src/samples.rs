//! Samples in SI.

use shared::capture::{ChannelSteps, Decoder};
use shared::link::message::AXES;
use shared::link::stream::StreamPacket;

/// A channel without a reading, or samples that are not as many as announced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unreadable;

/// The channels of an axis at one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisSample {
    /// Command, m.
    pub command_m: f64,
    /// Motor reading, m.
    pub motor_m: f64,
    /// Reading of the linear scale, m; `None`: no signal.
    pub table_m: Option<f64>,
    /// Force that acted since the previous tick, N.
    pub force_n: f64,
}

/// Decodes samples of a recording or of a packet of a stream.
///
/// # Errors
/// [`Unreadable`] if there are fewer samples.
pub fn decode(
    steps: &ChannelSteps<AXES>,
    period: u32,
    samples: u32,
    bytes: &[u8],
) -> Result<Vec<[AxisSample; AXES]>, Unreadable> {
    let mut decoder = Decoder::<AXES>::new(period, bytes);
    (0..samples)
        .map(|_| {
            let sample = decoder.next_sample().ok_or(Unreadable)?;
            let mut axes = [AxisSample::default(); AXES];
            for (axis, values) in sample.iter().enumerate() {
                let ([command, motor, table], force_n) = steps.values(axis, values);
                axes[axis] = AxisSample {
                    command_m: command.ok_or(Unreadable)?,
                    motor_m: motor.ok_or(Unreadable)?,
                    table_m: table,
                    force_n,
                };
            }
            Ok(axes)
        })
        .collect()
}

/// The samples of a packet.
///
/// # Errors
/// [`Unreadable`].
pub fn of_packet(
    steps: &ChannelSteps<AXES>,
    packet: &StreamPacket,
) -> Result<Vec<[AxisSample; AXES]>, Unreadable> {
    decode(steps, packet.period, packet.samples.into(), &packet.bytes)
}
