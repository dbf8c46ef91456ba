//! The contour errors of logs, with their names.

use super::evaluation::ContourError;
use super::logged::log_name;
use super::long_log;
use files::log::{Channel, Log};

/// The contour error of a log with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct LogError {
    /// See [`log_name`].
    pub log: String,
    /// Names of the axes.
    pub axes: Vec<String>,
    /// The measured channel.
    pub channel: Channel,
    /// The error relative to the path of the log's own command, all samples as logged.
    pub error: ContourError,
}

impl LogError {
    /// The contour errors of those logs that have what it needs.
    pub fn all<'a>(logs: impl IntoIterator<Item = &'a Log>) -> Vec<Self> {
        let of_log = |log: &Log| {
            let (motion, error) = long_log::contour_error(log)?;
            Some(Self { log: log_name(&log.source), axes: motion.axes, channel: motion.channel, error })
        };
        logs.into_iter().filter_map(of_log).collect()
    }
}
