//! What a board tells about itself.

use serde::{Deserialize, Serialize};

use super::envelope::Envelope;
use super::feed_override::FeedOverride;
use super::packet::PerAxis;
use super::receiver::LinkCounts;
use super::steps::ListedSteps;
use crate::capture::{CaptureState, ChannelSteps};
use crate::config::Rates;
use crate::drive::direction_check::DirectionResult;
use crate::drive::{NotArmed, Supply, TickCounts};
use crate::figures::{AxisRms, SignalFigures};
use crate::homing::{HomingError, HomingSettings};
use crate::interpolate::PathError;
use crate::interpolate::feed_hold::FeedState;
use crate::probing::ProbeStatus;
use crate::safety::{Fault, Power};
use crate::storage::SlotError;
use crate::units::Position;

/// Declared times of the supervision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Times {
    /// Silence of the host after which the path is held, ms.
    pub hold_ms: u16,
    /// Silence of the host after which the drives are disabled, ms.
    pub off_ms: u16,
    /// Time after which a jog at a speed that was not renewed decelerates, ms.
    pub jog_ms: u16,
}

impl Default for Times {
    /// 0.5 s, 10 s and 0.3 s.
    fn default() -> Self {
        Self { hold_ms: 500, off_ms: 10_000, jog_ms: 300 }
    }
}

/// What a board of `N` axes is: constants of its program.
#[derive(Clone, Copy, Debug)]
pub struct Identity<const N: usize> {
    /// Name of the board.
    pub board: &'static str,
    /// Version of its program.
    pub software: &'static str,
    /// Tick rate, Hz.
    pub tick_hz: u32,
    /// Steps of the recorded channels.
    pub steps: ChannelSteps<N>,
    /// Times of the supervision.
    pub times: Times,
    /// How each axis is homed; `None`: it has no reference.
    pub homing: [Option<HomingSettings>; N],
    /// What no settings may exceed.
    pub envelope: &'static Envelope<N>,
}

/// The reply to a hello, and to the question what the board is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Welcome {
    /// Number of the session; 0: none was opened.
    pub session: u32,
    /// Name of the board.
    pub board: heapless::String<32>,
    /// Version of its program.
    pub software: heapless::String<16>,
    /// The sources of its program: [`SOURCES`](crate::SOURCES).
    pub sources: u64,
    /// Rates of the loops.
    pub rates: Rates,
    /// Times of the supervision.
    pub times: Times,
    /// Steps of the recorded channels, of as many axes as the board has.
    pub steps: ListedSteps,
    /// Memory for a recording, bytes.
    pub capture_bytes: u32,
}

/// What the axes do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Activity {
    /// At rest.
    #[default]
    Idle,
    /// A motion of the host runs.
    Motion,
    /// A jog runs.
    Jog,
    /// An axis moves to its reference.
    Homing,
    /// A frequency response is measured at rest.
    Response,
    /// An axis moves until the probe is touched, or back.
    Probing,
    /// Axes follow counters, or decelerate from that.
    Following,
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisStatus {
    /// Command.
    pub command: Position,
    /// Motor reading.
    pub motor: Position,
    /// Reading of the linear scale.
    pub table: Option<Position>,
    /// Force of the last tick, N.
    pub force_n: f32,
    /// Whether the position refers to the reference of the axis.
    pub homed: bool,
    /// The signals of its motor sensor, if it has some.
    pub signals: Option<SignalFigures>,
    /// Following error and force over the last complete second with the drives on.
    pub rms: Option<AxisRms>,
    /// Counter at the input of its scale, if no scale is there.
    pub counter: Option<u32>,
    /// How far its command is from the setpoint of a counter that it follows, position units.
    pub lag: Option<i64>,
    /// The gantry of which it is the second motor.
    pub gantry: Option<GantryStatus>,
}

/// The second motor of a gantry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GantryStatus {
    /// Axis of its first motor.
    pub first: u8,
    /// Position of the second motor less that of the first, from the square beam if the gantry is homed, position units.
    pub skew: i64,
}

/// The homing that ran last, if no probing has run since.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum HomingReport {
    /// None has run.
    None,
    /// One runs.
    Running,
    /// The axis is homed.
    Homed,
    /// It has failed.
    Failed(HomingFailure),
}

/// The direction check that ran last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DirectionReport {
    /// None has run.
    None,
    /// One waits for the enable switch, or pushes.
    Running {
        /// Axis.
        axis: u8,
    },
    /// It has ended.
    Ended {
        /// Axis.
        axis: u8,
        /// Its result.
        result: DirectionResult,
    },
}

/// Why a homing has failed: [`HomingError`] without details.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names of HomingError")]
pub enum HomingFailure {
    Setting,
    NotReady,
    SwitchNotFound,
    SwitchStuck,
    IndexNotFound,
    IndexTooCloseToSwitch,
    StopNotFound,
    StopYields,
    HeldFast,
    Weight,
    LimitSwitch,
    ScaleMissing,
    Timeout,
    Stopped,
    DrivesOff,
    Path(PathError),
    Gantry,
}

impl From<HomingError> for HomingFailure {
    fn from(error: HomingError) -> Self {
        match error {
            HomingError::Setting(_) => Self::Setting,
            HomingError::NotReady => Self::NotReady,
            HomingError::SwitchNotFound => Self::SwitchNotFound,
            HomingError::SwitchStuck => Self::SwitchStuck,
            HomingError::IndexNotFound => Self::IndexNotFound,
            HomingError::IndexTooCloseToSwitch => Self::IndexTooCloseToSwitch,
            HomingError::StopNotFound => Self::StopNotFound,
            HomingError::StopYields => Self::StopYields,
            HomingError::HeldFast => Self::HeldFast,
            HomingError::Weight => Self::Weight,
            HomingError::Gantry => Self::Gantry,
            HomingError::LimitSwitch => Self::LimitSwitch,
            HomingError::ScaleMissing => Self::ScaleMissing,
            HomingError::Timeout => Self::Timeout,
            HomingError::Stopped => Self::Stopped,
            HomingError::DrivesOff => Self::DrivesOff,
            HomingError::Path(error) => Self::Path(error),
        }
    }
}

/// Where the settings that a board uses are from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SettingsSource {
    /// From its program.
    #[default]
    Program,
    /// From the newest record in its flash: loaded at the start, or saved since.
    Record,
    /// Uploaded, and not saved.
    Upload,
}

/// What the flash of a board holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum StoredRecord {
    /// Nothing was ever saved.
    #[default]
    None,
    /// A valid record, with the number of its save.
    Valid(u32),
    /// Neither slot has a valid record: the reason for each.
    Invalid([SlotError; 2]),
    /// A valid record with an upload that is not accepted.
    Refused(u32),
}

/// The settings of a board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SettingsReport {
    /// Where the settings in use are from.
    pub source: SettingsSource,
    /// What its flash holds.
    pub stored: StoredRecord,
}

impl SettingsReport {
    /// Settings of the program; nothing is known of the flash.
    pub const PROGRAM: Self = Self { source: SettingsSource::Program, stored: StoredRecord::None };
}

/// The USB port of a board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum UsbState {
    /// The board has none.
    #[default]
    None,
    /// It did not answer at the start, and is not used.
    NotAnswering,
    /// No host has configured it: there is no cable, or the host sleeps.
    Detached,
    /// A host has configured it.
    Attached,
}

/// The state of a board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Ticks since the start.
    pub tick: u64,
    /// Power state of the drives.
    pub power: Power,
    /// The first warning since the drives were enabled.
    pub warning: Option<Fault>,
    /// What does not permit that a host enables the drives, also while they are on.
    pub not_armed: Option<NotArmed>,
    /// What the axes do.
    pub activity: Activity,
    /// What the feed hold does.
    pub feed: FeedState,
    /// The feed override.
    pub feed_override: FeedOverride,
    /// The present rate of the path, % of the planned one.
    pub rate_percent: u8,
    /// Whether the command is at rest and no block is left.
    pub at_rest: bool,
    /// Blocks of the motion that have not been passed to the path yet.
    pub blocks_left: u16,
    /// Axes.
    pub axes: PerAxis<AxisStatus>,
    /// Late and missed ticks.
    pub ticks: TickCounts,
    /// Supply, as far as the board measures it.
    pub supply: Supply,
    /// The homing that ran last.
    pub homing: HomingReport,
    /// The probing that runs or that ran last; `None` if a homing has run since.
    pub probe: Option<ProbeStatus>,
    /// The direction check that ran last.
    pub direction: DirectionReport,
    /// State of the recording.
    pub capture: CaptureState,
    /// Samples of the stream that were lost.
    pub lost_samples: u32,
    /// Where the settings are from, and what the flash holds.
    pub settings: SettingsReport,
    /// What the link has received before this request.
    pub link: LinkCounts,
    /// Its USB port.
    pub usb: UsbState,
}

/// The state of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CaptureReport {
    /// What it does.
    pub state: CaptureState,
    /// Number of samples.
    pub samples: u32,
    /// Number of bytes.
    pub bytes: u32,
    /// Samples per position tick, which a decoder needs.
    pub period: u32,
    /// The tick of the first sample.
    pub start: u64,
}
