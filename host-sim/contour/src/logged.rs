//! The contour error of a log.

use super::evaluation::{ContourError, Evaluation};
use super::path::NominalPath;
use super::vector::Point;
use files::error::InputError;
use files::log::{AxisLog, Channel, Log, Unit};
use motion::MAX_AXES;

/// Channels that measure the position, the nearest to the tool first.
pub const POSITIONS: [Channel; 3] = [Channel::Tool, Channel::Table, Channel::Motor];

/// The positions of a log that a contour error needs: the command and a measured channel of all linear axes.
#[derive(Clone, Debug, PartialEq)]
pub struct LoggedMotion {
    /// Names of the linear axes.
    pub axes: Vec<String>,
    /// The measured channel.
    pub channel: Channel,
    /// Time from one sample to the next, s.
    pub sample_s: f64,
    /// Command, one vector per axis, m.
    pub command_m: Vec<Vec<f64>>,
    /// Measured position, one vector per axis, m.
    pub measured_m: Vec<Vec<f64>>,
}

impl LoggedMotion {
    /// The motion with the channel nearest to the tool that all linear axes have.
    ///
    /// # Errors
    /// What the log lacks: one to three linear axes, a command or a measured position of each.
    pub fn of(log: &Log) -> Result<Self, Missing> {
        let channel = POSITIONS.into_iter().find(|channel| has(log, *channel)).ok_or(Missing::Position)?;
        Self::of_channel(log, channel)
    }

    /// The motion with a given channel.
    ///
    /// # Errors
    /// As [`LoggedMotion::of`].
    pub fn of_channel(log: &Log, channel: Channel) -> Result<Self, Missing> {
        let axes: Vec<&AxisLog> = linear(log).collect();
        if axes.is_empty() || axes.len() > MAX_AXES {
            return Err(Missing::LinearAxes);
        }
        let metres = |channel: Channel| -> Option<Vec<Vec<f64>>> {
            let of_axis = |axis: &&AxisLog| Some(axis.channel(channel)?.iter().map(|mm| 1e-3 * mm).collect());
            axes.iter().map(of_axis).collect()
        };
        Ok(Self {
            axes: axes.iter().map(|axis| axis.name.clone()).collect(),
            channel,
            sample_s: log.sample_time_s,
            command_m: metres(Channel::Command).ok_or(Missing::Command)?,
            measured_m: metres(channel).ok_or(Missing::Position)?,
        })
    }

    /// The contour error relative to the path of the log's own command; `None` if the log ends before its settling does.
    #[must_use]
    pub fn contour_error(&self) -> Option<ContourError> {
        let path = NominalPath::of_command(&self.command_m, self.sample_s);
        self.contour_error_on(&path)
    }

    /// The contour error relative to a path with the same axes in the same order.
    #[must_use]
    pub fn contour_error_on(&self, path: &NominalPath) -> Option<ContourError> {
        self.evaluated(Evaluation::new(path, self.sample_s))
    }

    /// The contour error of a log that continues another one, so that no settling is left out.
    #[must_use]
    pub(crate) fn contour_error_of_continuation(&self) -> Option<ContourError> {
        let path = NominalPath::of_command(&self.command_m, self.sample_s);
        self.evaluated(Evaluation::new(&path, self.sample_s).without_settling())
    }

    fn evaluated(&self, mut evaluation: Evaluation<'_>) -> Option<ContourError> {
        let samples = self.command_m.iter().map(Vec::len).min().unwrap_or(0);
        for i in 0..samples {
            evaluation.add(&at(&self.command_m, i), &at(&self.measured_m, i));
        }
        evaluation.finish()
    }
}

/// Name of a log: its file name without folder and extension.
#[must_use]
pub fn log_name(source: &str) -> String {
    let name = source.rsplit(['/', '\\']).next().unwrap_or(source);
    let name = name.strip_suffix(".gz").unwrap_or(name);
    let name = name.strip_suffix(".csv").or_else(|| name.strip_suffix(".toml")).unwrap_or(name);
    name.to_owned()
}

/// Whether all linear axes of a log have a channel.
#[must_use]
pub fn has(log: &Log, channel: Channel) -> bool {
    linear(log).all(|axis| axis.channel(channel).is_some())
}

fn linear(log: &Log) -> impl Iterator<Item = &AxisLog> {
    log.axes.iter().filter(|axis| axis.unit == Unit::Millimetre)
}

fn at(axes_m: &[Vec<f64>], sample: usize) -> Point {
    let mut point = [0.0; MAX_AXES];
    point.iter_mut().zip(axes_m).for_each(|(coordinate, axis)| *coordinate = axis[sample]);
    point
}

/// What a log lacks for a contour error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    /// One to three linear axes.
    LinearAxes,
    /// The command of each linear axis.
    Command,
    /// One measured position, of the same kind for each linear axis.
    Position,
}

impl Missing {
    /// The input error of the log that lacks it.
    #[must_use]
    pub fn in_log(self, log: &Log) -> InputError {
        InputError::expected(&log.source, self.expected(), "none")
    }

    fn expected(self) -> &'static str {
        match self {
            Self::LinearAxes => "1 to 3 axes in mm",
            Self::Command => "the command of each axis (NAME_command_mm)",
            Self::Position => {
                "a measured position of each axis (NAME_tool_mm, NAME_table_mm or NAME_motor_mm)"
            }
        }
    }
}
