//! Samples in SI.

use shared::capture::Decoder;
use shared::link::message::PerAxis;
use shared::link::steps::ListedSteps;
use shared::link::stream::StreamPacket;

/// A channel without a reading, samples that are not as many as announced, or a board without axes.
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

/// Decodes samples of a recording or of a packet of a stream, of as many axes as there are steps.
///
/// # Errors
/// [`Unreadable`] if there are fewer samples, or no axes.
pub fn decode(
    steps: &ListedSteps,
    period: u32,
    samples: u32,
    bytes: &[u8],
) -> Result<Vec<PerAxis<AxisSample>>, Unreadable> {
    match steps.axes.len() {
        1 => decode_of::<1>(steps, period, samples, bytes),
        2 => decode_of::<2>(steps, period, samples, bytes),
        3 => decode_of::<3>(steps, period, samples, bytes),
        4 => decode_of::<4>(steps, period, samples, bytes),
        _ => Err(Unreadable),
    }
}

fn decode_of<const N: usize>(
    steps: &ListedSteps,
    period: u32,
    samples: u32,
    bytes: &[u8],
) -> Result<Vec<PerAxis<AxisSample>>, Unreadable> {
    let steps = steps.of_axes::<N>().ok_or(Unreadable)?;
    let mut decoder = Decoder::<N>::new(period, bytes);
    (0..samples)
        .map(|_| {
            let sample = decoder.next_sample().ok_or(Unreadable)?;
            let axes = sample.iter().enumerate().map(|(axis, values)| {
                let ([command, motor, table], force_n) = steps.values(axis, values);
                Ok(AxisSample {
                    command_m: command.ok_or(Unreadable)?,
                    motor_m: motor.ok_or(Unreadable)?,
                    table_m: table,
                    force_n,
                })
            });
            axes.collect()
        })
        .collect()
}

/// The samples of a packet.
///
/// # Errors
/// [`Unreadable`].
pub fn of_packet(steps: &ListedSteps, packet: &StreamPacket) -> Result<Vec<PerAxis<AxisSample>>, Unreadable> {
    decode(steps, packet.period, packet.samples.into(), &packet.bytes)
}
