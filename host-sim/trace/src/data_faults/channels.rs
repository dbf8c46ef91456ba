//! The position channels of an axis: their references, their accuracy, and the stages that use them.

use std::borrow::Cow;
use std::ops::Range;

use files::log::{AxisLog, Channel};
use model::effects::Stage;

/// Position channels in the direction of the signal flow.
pub const POSITIONS: [Channel; 4] = [Channel::Command, Channel::Motor, Channel::Table, Channel::Tool];

/// Position channels that are measured.
pub const SENSORS: [Channel; 3] = [Channel::Motor, Channel::Table, Channel::Tool];

/// The other position channels, the one nearest to this channel first. The command is last, as the following error lies
/// between it and the sensors.
#[must_use]
pub const fn others(channel: Channel) -> [Channel; 3] {
    match channel {
        Channel::Table => [Channel::Motor, Channel::Tool, Channel::Command],
        Channel::Tool => [Channel::Table, Channel::Motor, Channel::Command],
        Channel::Motor => [Channel::Table, Channel::Tool, Channel::Command],
        Channel::Command | Channel::Force | Channel::AddedForce | Channel::Temperature => SENSORS,
    }
}

/// The other position channels that an axis has, the nearest first.
pub fn references(axis: &AxisLog, channel: Channel) -> impl Iterator<Item = (Channel, &[f64])> {
    others(channel).into_iter().filter_map(|other| axis.channel(other).map(|values| (other, values)))
}

/// The nearest other position channel, if there is one.
#[must_use]
pub fn reference(axis: &AxisLog, channel: Channel) -> Option<&[f64]> {
    references(axis, channel).map(|(_, values)| values).next()
}

/// The stages in whose residuals a channel appears, as the measured signal or as the input.
#[must_use]
pub fn stages(axis: &AxisLog, channel: Channel) -> &'static [Stage] {
    match channel {
        Channel::Command => &[Stage::Motor],
        Channel::Motor if axis.table.is_none() => &[Stage::Motor, Stage::Table, Stage::Force, Stage::Tool],
        Channel::Motor => &[Stage::Motor, Stage::Table, Stage::Force],
        Channel::Table => &[Stage::Table, Stage::Tool],
        Channel::Tool => &[Stage::Tool],
        Channel::Force | Channel::AddedForce | Channel::Temperature => &[Stage::Force, Stage::Table],
    }
}

/// Standard deviation of the white noise of a channel. As in [`crate::input::smoothing::noise`] it is estimated from third
/// differences, whose variance is 20 times that of the noise, but from their median, which spikes do not raise; and with
/// repeated readings counted once, if that is less, as the difference after a repeated reading is that of two samples.
#[must_use]
pub fn noise(values: &[f64]) -> f64 {
    let values = thinned(values);
    let mut changed = values.to_vec();
    changed.dedup();
    median_noise(&values).min(median_noise(&changed))
}

/// Length from which a channel is regarded in stretches where it is compared as a whole.
const LONG: usize = 400_000;
/// Number and length of these stretches.
const STRETCHES: [usize; 2] = [8, 32_768];

/// The values of a channel, or of a long one evenly spaced stretches: medians and quantiles of differences hardly depend on which
/// part of a log they are from, and the few differences across two stretches do not affect them.
#[must_use]
pub fn thinned(values: &[f64]) -> Cow<'_, [f64]> {
    if values.len() < LONG {
        return Cow::Borrowed(values);
    }
    Cow::Owned(stretches(values.len()).into_iter().flat_map(|range| &values[range]).copied().collect())
}

/// The stretches in which a channel with this number of samples is regarded; one of all samples if it is short.
#[must_use]
pub fn stretches(samples: usize) -> Vec<Range<usize>> {
    if samples < LONG {
        return std::iter::once(0..samples).collect();
    }
    let [count, length] = STRETCHES;
    let start = |i: usize| i * (samples - length) / (count - 1);
    (0..count).map(|i| start(i)..start(i) + length).collect()
}

fn median_noise(values: &[f64]) -> f64 {
    const STRETCH: usize = 64;
    /// Median of the absolute value of a standard normal deviate.
    const MEDIAN: f64 = 0.6745;
    let thirds: Vec<f64> = values.windows(4).map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs()).collect();
    let medians: Vec<f64> = thirds.chunks(STRETCH).filter_map(numerics::median).collect();
    numerics::median(&medians).unwrap_or(0.0) / (MEDIAN * 20f64.sqrt())
}

/// Noise and resolution of a channel, in its unit.
#[derive(Clone, Copy, Debug)]
pub struct Accuracy {
    /// Standard deviation of the noise.
    pub noise: f64,
    /// Smallest difference between two successive values.
    pub resolution: f64,
}

impl Accuracy {
    /// Accuracy of a channel.
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        /// Smaller differences are rounding errors of the computation, mm.
        const MIN_DIFFERENCE: f64 = 1e-7;
        let differences = values.windows(2).map(|two| (two[1] - two[0]).abs());
        let resolution =
            differences.filter(|difference| *difference > MIN_DIFFERENCE).fold(f64::INFINITY, f64::min);
        let resolution = if resolution.is_finite() { resolution } else { 0.0 };
        Self { noise: noise(values), resolution }
    }
}
