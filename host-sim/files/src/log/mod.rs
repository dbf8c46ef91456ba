//! Logs: commands and measurements of each axis, uniformly sampled.
//!
//! The file format is a CSV table with one header line: `time_s`, then for each axis any of
//! `NAME_command_U`, `NAME_motor_U`, `NAME_table_U`, `NAME_tool_U`, `NAME_force_F`,
//! `NAME_added_force_F` and `NAME_temperature_c`, with U `mm` and F `n`, or U `deg` and F `nm`.

mod clock;
mod read;
mod write;

use std::ops::Range;

pub use read::{ALLOWED, Rows, TIME, channel_of, unit_of_axis};
pub use write::{RowWriter, write_rows};

/// Units of an axis's positions and forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Positions in mm, forces in N.
    Millimetre,
    /// Positions in degrees, torques in N·m.
    Degree,
}

impl Unit {
    /// All units.
    pub const ALL: [Self; 2] = [Self::Millimetre, Self::Degree];

    /// Suffix of a channel's column.
    #[must_use]
    pub fn suffix(self, channel: Channel) -> &'static str {
        match (self, channel.quantity()) {
            (Self::Millimetre, Quantity::Position) => "mm",
            (Self::Degree, Quantity::Position) => "deg",
            (Self::Millimetre, Quantity::Force) => "n",
            (Self::Degree, Quantity::Force) => "nm",
            (_, Quantity::Temperature) => "c",
        }
    }
}

/// What a channel measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A position, of a rotary axis an angle.
    Position,
    /// A force, of a rotary axis a torque.
    Force,
    /// A temperature.
    Temperature,
}

/// One signal of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Position command, before feed-forward.
    Command,
    /// Motor encoder or resolver, converted to table position.
    Motor,
    /// Linear scale or table encoder.
    Table,
    /// Tool-point probe.
    Tool,
    /// Commanded force of the drive, mean over the interval that ends at the sample.
    Force,
    /// Known test force that is added to the controller's output; [`Channel::Force`] includes it.
    AddedForce,
    /// Temperature of guide and lubricant, °C, as a sensor beside them reads it.
    Temperature,
}

impl Channel {
    /// All channels, in the order in which columns are written.
    pub const ALL: [Self; 7] = [
        Self::Command,
        Self::Motor,
        Self::Table,
        Self::Tool,
        Self::Force,
        Self::AddedForce,
        Self::Temperature,
    ];

    /// Middle part of a column's name.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Command => "command",
            Self::Motor => "motor",
            Self::Table => "table",
            Self::Tool => "tool",
            Self::Force => "force",
            Self::AddedForce => "added_force",
            Self::Temperature => "temperature",
        }
    }

    /// What it measures.
    #[must_use]
    pub const fn quantity(self) -> Quantity {
        match self {
            Self::Command | Self::Motor | Self::Table | Self::Tool => Quantity::Position,
            Self::Force | Self::AddedForce => Quantity::Force,
            Self::Temperature => Quantity::Temperature,
        }
    }
}

/// The channels of one axis; `None` if a channel was not measured.
///
/// Positions are in mm or degrees, forces in N or N·m, temperatures in °C, as in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisLog {
    /// Name of the axis.
    pub name: String,
    /// Unit of all its channels.
    pub unit: Unit,
    /// See [`Channel::Command`].
    pub command: Option<Vec<f64>>,
    /// See [`Channel::Motor`].
    pub motor: Option<Vec<f64>>,
    /// See [`Channel::Table`].
    pub table: Option<Vec<f64>>,
    /// See [`Channel::Tool`].
    pub tool: Option<Vec<f64>>,
    /// See [`Channel::Force`].
    pub force: Option<Vec<f64>>,
    /// See [`Channel::AddedForce`].
    pub added_force: Option<Vec<f64>>,
    /// See [`Channel::Temperature`].
    pub temperature: Option<Vec<f64>>,
}

impl AxisLog {
    /// An axis without channels.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: Unit) -> Self {
        Self {
            name: name.into(),
            unit,
            command: None,
            motor: None,
            table: None,
            tool: None,
            force: None,
            added_force: None,
            temperature: None,
        }
    }

    /// The samples of a channel, if it was measured.
    #[must_use]
    pub fn channel(&self, channel: Channel) -> Option<&[f64]> {
        let samples = match channel {
            Channel::Command => &self.command,
            Channel::Motor => &self.motor,
            Channel::Table => &self.table,
            Channel::Tool => &self.tool,
            Channel::Force => &self.force,
            Channel::AddedForce => &self.added_force,
            Channel::Temperature => &self.temperature,
        };
        samples.as_deref()
    }

    /// The samples of a channel, to be set or replaced.
    pub fn channel_mut(&mut self, channel: Channel) -> &mut Option<Vec<f64>> {
        match channel {
            Channel::Command => &mut self.command,
            Channel::Motor => &mut self.motor,
            Channel::Table => &mut self.table,
            Channel::Tool => &mut self.tool,
            Channel::Force => &mut self.force,
            Channel::AddedForce => &mut self.added_force,
            Channel::Temperature => &mut self.temperature,
        }
    }

    /// The samples of all measured channels.
    fn channels_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let Self { command, motor, table, tool, force, added_force, temperature, .. } = self;
        [command, motor, table, tool, force, added_force, temperature].into_iter().flatten()
    }

    /// Name of the column of a channel.
    #[must_use]
    pub fn column(&self, channel: Channel) -> String {
        format!("{}_{}_{}", self.name, channel.word(), self.unit.suffix(channel))
    }

    fn slice(&self, range: &Range<usize>) -> Self {
        let mut part = Self::new(self.name.clone(), self.unit);
        for channel in Channel::ALL {
            let samples = self.channel(channel).map(|samples| samples[range.clone()].to_vec());
            *part.channel_mut(channel) = samples;
        }
        part
    }
}

/// A log: all channels of all axes at the same uniformly spaced times.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// File name given by the user, for messages.
    pub source: String,
    /// Time of the first sample, s. Logs of one session share one clock.
    pub start_s: f64,
    /// Time from one sample to the next, s.
    pub sample_time_s: f64,
    /// The axes, in the order of the columns.
    pub axes: Vec<AxisLog>,
    /// Samples for which the file had no row at their time, in increasing order: they were interpolated, and are no measurement.
    pub interpolated: Vec<Range<usize>>,
}

impl Log {
    /// A log of which every sample was measured. `source` is its name for messages, `start_s` the time of its first sample.
    #[must_use]
    pub fn new(
        source: impl Into<String>,
        start_s: f64,
        sample_time_s: f64,
        axes: impl IntoIterator<Item = AxisLog>,
    ) -> Self {
        let axes = axes.into_iter().collect();
        Self { source: source.into(), start_s, sample_time_s, axes, interpolated: Vec::new() }
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        let channels = |axis| Channel::ALL.map(|channel| AxisLog::channel(axis, channel));
        self.axes.iter().flat_map(channels).flatten().map(<[f64]>::len).next().unwrap_or(0)
    }

    /// Whether there is no sample at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The axis with a name.
    #[must_use]
    pub fn axis(&self, name: &str) -> Option<&AxisLog> {
        self.axes.iter().find(|axis| axis.name == name)
    }

    /// Time of a sample on the clock of the session, s.
    #[must_use]
    pub fn time_s(&self, sample: usize) -> f64 {
        self.start_s + sample as f64 * self.sample_time_s
    }

    /// Whether the file had a row at the time of a sample.
    #[must_use]
    pub fn is_measured(&self, sample: usize) -> bool {
        let next = self.interpolated.partition_point(|range| range.end <= sample);
        self.interpolated.get(next).is_none_or(|range| sample < range.start)
    }

    /// Number of samples that were interpolated.
    #[must_use]
    pub fn interpolated_samples(&self) -> usize {
        self.interpolated.iter().map(ExactSizeIterator::len).sum()
    }

    /// A part of the samples, with their times.
    ///
    /// # Panics
    /// If the range reaches beyond the log.
    #[must_use]
    pub fn slice(&self, range: Range<usize>) -> Self {
        Self {
            source: self.source.clone(),
            start_s: self.time_s(range.start),
            sample_time_s: self.sample_time_s,
            axes: self.axes.iter().map(|axis| axis.slice(&range)).collect(),
            interpolated: self.interpolated.iter().filter_map(|samples| within(samples, &range)).collect(),
        }
    }

    /// Each Nth sample, from the first one on.
    ///
    /// # Panics
    /// If `every` is 0.
    #[must_use]
    pub fn thinned(mut self, every: usize) -> Self {
        self.sample_time_s *= every as f64;
        for channel in self.axes.iter_mut().flat_map(AxisLog::channels_mut) {
            *channel = channel.iter().copied().step_by(every).collect();
        }
        let thinned =
            self.interpolated.iter().map(|range| range.start.div_ceil(every)..range.end.div_ceil(every));
        self.interpolated = thinned.filter(|range| !range.is_empty()).collect();
        self
    }
}

/// The part of a range that is in another one, counted from its start.
fn within(samples: &Range<usize>, range: &Range<usize>) -> Option<Range<usize>> {
    let part = samples.start.max(range.start)..samples.end.min(range.end);
    (!part.is_empty()).then(|| part.start - range.start..part.end - range.start)
}

#[cfg(test)]
mod tests;
