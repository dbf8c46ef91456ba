//! A fault of a channel.

use files::log::Channel;

/// What is wrong with a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultKind {
    /// The reading jumps from one sample to the next and stays shifted.
    Slip,
    /// The reading is repeated while the axis moves.
    Stuck,
    /// Single readings are far from their neighbours.
    Spike,
    /// The reading has the wrong sign.
    Sign,
    /// The readings of two axes are exchanged.
    Exchanged,
    /// The reading is late or early by more than any latency.
    Shifted,
    /// The rows are not those of the declared rate.
    Rate,
    /// The reading has another unit, or is wrong by a factor.
    Unit,
    /// The reading does not change while the axis moves.
    Dead,
    /// The reading contains an oscillation that the other channels do not show.
    Hum,
}

impl FaultKind {
    /// Name of the kind, as in `--json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Slip => "slip",
            Self::Stuck => "stuck",
            Self::Spike => "spike",
            Self::Sign => "sign",
            Self::Exchanged => "exchanged",
            Self::Shifted => "shifted",
            Self::Rate => "rate",
            Self::Unit => "unit",
            Self::Dead => "dead",
            Self::Hum => "hum",
        }
    }
}

/// What a trace does about a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultHandling {
    /// The channel is corrected and used.
    Corrected,
    /// The channel is not used.
    Removed,
    /// The whole log is not fitted, as other logs contain the channel.
    LogLeftOut,
}

impl FaultHandling {
    /// Name of the treatment, as in `--json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corrected => "corrected",
            Self::Removed => "removed",
            Self::LogLeftOut => "log_left_out",
        }
    }
}

/// A fault of a channel in a log.
#[derive(Clone, Debug, PartialEq)]
pub struct DataFault {
    /// Name of the axis.
    pub axis: String,
    /// The channel; `None`: all channels of the axis.
    pub channel: Option<Channel>,
    /// What is wrong.
    pub kind: FaultKind,
    /// Source of the log.
    pub log: String,
    /// Time of the fault, or of the first of several, on the session's clock, s; `None` if it extends over the log.
    pub at_s: Option<f64>,
    /// Size: slip and largest spike, µm (mdeg) added to the reading; stuck, total duration, s; shifted, ms late (negative:
    /// early); unit and rate, factor between reading and truth; hum, amplitude, µm (mdeg) or N; otherwise `None`.
    pub size: Option<f64>,
    /// Frequency of a hum, Hz; otherwise `None`.
    pub frequency_hz: Option<f64>,
    /// Number of occurrences that this entry combines.
    pub count: usize,
    /// What the trace does about it.
    pub treatment: FaultHandling,
}
