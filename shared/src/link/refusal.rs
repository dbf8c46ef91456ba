//! Why a request is refused.

use serde::{Deserialize, Serialize};

use super::board_settings::NotSettings;
use super::halt::Halt;
use super::report::HomingFailure;
use crate::config::ConfigError;
use crate::drive::NotArmed;
use crate::drive::direction_check::DirectionCheckError;
use crate::excitation::ExcitationProblem;
use crate::interpolate::PathError;
use crate::interpolate::following::FollowError;
use crate::machine::MachineError;
use crate::probing::ProbeError;
use crate::safety::Fault;

/// The name of a setting.
pub type SettingName = heapless::String<48>;

/// Why a request is refused. Nothing has changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Refusal {
    /// The packet has another version.
    Version {
        /// The version of this board.
        supported: u8,
    },
    /// The bytes are not a request.
    Unreadable,
    /// The session is not the present one: the request is of an earlier session, or there was no [`Hello`](super::Request::Hello).
    Session,
    /// The sequence number is old, or numbers before it are missing.
    Sequence {
        /// The number that is expected next.
        expected: u32,
    },
    /// An upload is wrong.
    Upload(UploadError),
    /// A setting is wrong.
    Setting {
        /// Axis.
        axis: u8,
        /// Name of the setting.
        name: SettingName,
        /// What is wrong with it.
        problem: SettingProblem,
    },
    /// The tick rate of the settings is not that of the board.
    TickRate {
        /// Tick rate of the board, Hz.
        board_hz: f64,
    },
    /// A block of the motion, or a jog, cannot be planned.
    Path {
        /// Block, counted from 0.
        block: u16,
        /// What is wrong with it.
        error: PathError,
    },
    /// A block of the motion, or a jog, is faster than an axis may be.
    TooFast {
        /// Block, counted from 0.
        block: u16,
        /// Axis.
        axis: u8,
        /// Greatest speed, m/s.
        limit_m_per_s: f64,
    },
    /// There is no such axis.
    NoSuchAxis,
    /// The board has another number of axes.
    Axes {
        /// Number of axes of the board.
        board: u8,
    },
    /// A host may not enable the drives.
    NotArmed(NotArmed),
    /// A fault has to be acknowledged first.
    Faulted(Fault),
    /// The drives are off.
    DrivesOff,
    /// The drives are on.
    DrivesOn,
    /// The axes move, or are held on a path.
    Moving,
    /// The axis cannot be homed.
    Homing(HomingFailure),
    /// The direction of the axis cannot be checked.
    Direction(DirectionProblem),
    /// Nothing is held.
    NotHeld,
    /// The motion has as many blocks as the board holds.
    MotionFull {
        /// Greatest number of blocks.
        max: u16,
    },
    /// The motion has another number of blocks.
    BlockCount {
        /// Number of blocks that the board has.
        found: u16,
    },
    /// The axes are no longer at the position for which the motion was checked.
    Displaced,
    /// There is no complete recording.
    NoCapture,
    /// This board has no such function.
    NotAvailable,
    /// The flash has not kept what was written.
    Storage,
    /// The path changed too fast to append a block; the request can be repeated.
    Busy,
    /// No settings were uploaded since the last [`BeginSave`](super::Request::BeginSave), or an upload was refused since.
    NothingToSave,
    /// A host uses the other port of the board, and is not silent.
    OtherPort,
    /// Somebody without the session has asked for a halt since the last request of the session, which is told so once.
    HaltedByOther(Halt),
    /// The override is greater than a board permits.
    Override {
        /// Greatest override, %.
        max: u8,
    },
    /// No path runs and none is held: there is nothing to override.
    NothingMoves,
    /// The force for a frequency response is not one.
    Excitation(ExcitationProblem),
    /// Brakes open or close, and the drives hold the axes: the request can be repeated.
    BrakesMove,
    /// Nothing can be probed.
    Probe(ProbeError),
    /// The axis cannot follow the counter.
    Follow(FollowError),
    /// The axis is the second motor of a gantry, and moves with the first.
    SecondMotor {
        /// Axis.
        axis: u8,
        /// Axis of the first motor.
        first: u8,
    },
}

/// Why the direction of an axis cannot be checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DirectionProblem {
    /// The drives are on, a fault is not acknowledged, or a homing or another check runs.
    NotReady,
    /// A drive with step and direction inputs has no force to check.
    StepDrive,
    /// The force is not positive, or greater than the force limit of the axis.
    Force,
    /// The time or the distance is outside its range.
    Setting,
    /// The axis has a brake: with open loops it would fall.
    Brake,
    /// The axis is a motor of a gantry: one motor alone would bend the beam.
    Gantry,
}

/// What is wrong with an upload.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UploadError {
    /// A part is missing before this one, or it was received before.
    OutOfOrder {
        /// The offset that is expected.
        expected: u16,
    },
    /// Longer than the board holds.
    TooLong {
        /// Greatest number of bytes.
        max: u16,
    },
    /// The upload has another number of bytes.
    Length {
        /// Number of bytes that the board has.
        found: u16,
    },
    /// The checksum is wrong.
    Checksum,
    /// The bytes are not such a message.
    Unreadable,
}

/// What is wrong with a setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum SettingProblem {
    /// Not a finite number.
    NotFinite,
    /// Must be greater than zero.
    NotPositive,
    /// Cannot be changed now.
    NotWhileRunning,
    /// Requires another setting.
    Requires {
        /// The missing setting.
        other: heapless::String<16>,
    },
    /// Outside its range.
    OutOfRange {
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// Too few values of a table, or too many.
    Count {
        /// Greatest number of values.
        max: u16,
    },
    /// The number of an axis that is not another axis.
    NotAnotherAxis,
    /// Above its ceiling in the [envelope](super::envelope) of the board.
    AboveCeiling {
        /// Its value.
        value: f64,
        /// Greatest value.
        ceiling: f64,
    },
    /// Below its floor in the envelope.
    BelowFloor {
        /// Its value.
        value: f64,
        /// Least value.
        floor: f64,
    },
    /// A limit that is missing, and that the envelope requires.
    NotMonitored {
        /// Greatest value.
        ceiling: f64,
    },
    /// Uses a linear scale, and the axis has none.
    NoScale,
    /// Of the second motor of a gantry, and another than that of its first motor.
    NotOfFirstMotor,
    /// The axis cannot be the second motor of a gantry on this board.
    NoGantry,
}

/// A name, cut to its capacity.
fn name<const CAPACITY: usize>(name: &str) -> heapless::String<CAPACITY> {
    name.chars().filter(char::is_ascii).take(CAPACITY).collect()
}

impl From<DirectionCheckError> for Refusal {
    fn from(error: DirectionCheckError) -> Self {
        Self::Direction(match error {
            DirectionCheckError::NotReady => DirectionProblem::NotReady,
            DirectionCheckError::StepDrive => DirectionProblem::StepDrive,
            DirectionCheckError::Brake => DirectionProblem::Brake,
            DirectionCheckError::Gantry => DirectionProblem::Gantry,
            DirectionCheckError::Setting("force_n") => DirectionProblem::Force,
            DirectionCheckError::Setting(_) => DirectionProblem::Setting,
        })
    }
}

impl From<NotSettings> for Refusal {
    fn from(error: NotSettings) -> Self {
        match error {
            NotSettings::Unreadable => Self::Upload(UploadError::Unreadable),
            NotSettings::Axes { board } => Self::Axes { board },
        }
    }
}

impl From<MachineError> for Refusal {
    fn from(error: MachineError) -> Self {
        let (axis, error) = match error {
            MachineError::NoSuchAxis => return Self::NoSuchAxis,
            MachineError::PathRunning => return Self::Moving,
            MachineError::Path(error) => return Self::Path { block: 0, error },
            MachineError::Config { axis, error } => (u8::try_from(axis).unwrap_or(u8::MAX), error),
        };
        let (setting, problem) = match error {
            ConfigError::NotFinite(setting) => (setting, SettingProblem::NotFinite),
            ConfigError::NotPositive(setting) => (setting, SettingProblem::NotPositive),
            ConfigError::NotWhileRunning(setting) => (setting, SettingProblem::NotWhileRunning),
            ConfigError::Requires { name: setting, other } => {
                (setting, SettingProblem::Requires { other: name(other) })
            }
            ConfigError::OutOfRange { name: setting, min, max } => {
                (setting, SettingProblem::OutOfRange { min, max })
            }
            ConfigError::Count { name: setting, max } => (setting, SettingProblem::Count { max }),
            ConfigError::NotAnotherAxis { name: setting, .. } => (setting, SettingProblem::NotAnotherAxis),
            ConfigError::AboveCeiling { name: setting, value, ceiling } => {
                (setting, SettingProblem::AboveCeiling { value, ceiling })
            }
            ConfigError::BelowFloor { name: setting, value, floor } => {
                (setting, SettingProblem::BelowFloor { value, floor })
            }
            ConfigError::NotMonitored { name: setting, ceiling } => {
                (setting, SettingProblem::NotMonitored { ceiling })
            }
            ConfigError::NoScale(setting) => (setting, SettingProblem::NoScale),
            ConfigError::NotOfFirstMotor(setting) => (setting, SettingProblem::NotOfFirstMotor),
            ConfigError::NoGantry(setting) => (setting, SettingProblem::NoGantry),
        };
        Self::Setting { axis, name: name(setting), problem }
    }
}
