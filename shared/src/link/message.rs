//! Requests of a host, and what a board sends.

use serde::{Deserialize, Serialize};

pub use super::board_settings::BoardSettings;
use super::halt::Halt;
pub use super::history::HISTORY;
use super::history::HistoryEntry;
pub use super::packet::{MAX_AXES, PerAxis};
use super::refusal::Refusal;
use super::report::{CaptureReport, Status, Welcome};
use super::stream::StreamPacket;
use crate::capture::Trigger;
use crate::compensate::CompensationKind;
use crate::drive::direction_check::DirectionCheckSettings;
use crate::excitation::ExcitationSettings;
use crate::homing::HardStopSettings;
use crate::interpolate::following::FollowSettings;
use crate::interpolate::{Block, BlockOf};
use crate::probing::ProbeSettings;

/// Length of the longest upload in bytes: a compensation with every table at its capacity has 7.7 kB.
pub const LONGEST_UPLOAD: usize = 7808;

/// Greatest number of bytes of an upload in a request.
pub const PART: usize = 384;

/// Greatest number of bytes of a recording in a reply.
pub const READ: usize = 384;

/// Greatest number of blocks of a motion.
pub const MOTION_BLOCKS: usize = 64;

/// What an upload is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UploadKind {
    /// [`BoardSettings`]. Any compensation is discarded with the previous settings.
    Settings,
    /// [`CompensationSettings`](crate::compensate::CompensationSettings) of an axis.
    Compensation {
        /// Axis.
        axis: u8,
    },
}

/// A jog of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Jog {
    /// Axis.
    pub axis: u8,
    /// Signed distance, m; `None`: at a speed until it is not renewed, at most [`Jog::MAX_TRAVEL_M`].
    pub distance_m: Option<f64>,
    /// Signed speed, m/s. For a distance its magnitude counts.
    pub velocity_m_per_s: f64,
    /// Acceleration, m/s².
    pub acceleration_m_per_s2: f64,
}

impl Jog {
    /// Greatest travel of a jog at a speed, m.
    pub const MAX_TRAVEL_M: f64 = 1.0;
}

/// A request of a host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "one request at a time, and nothing to allocate it from")]
pub enum Request {
    /// Opens a session. Its packet needs no session and no sequence number. A repetition with the same number, before any other
    /// request, opens no further session.
    Hello {
        /// Any number, another one for each session.
        nonce: u32,
    },
    /// The state of the board.
    Status,
    /// The last faults and warnings.
    FaultHistory,
    /// Enables the drives. The enable switch must permit it.
    Enable,
    /// Disables the drives at once, and ends a direction check.
    Disable,
    /// Acknowledges a fault.
    Clear,
    /// Feed hold: decelerates along the path, drives on. Ends a direction check.
    Hold,
    /// Continues after a hold.
    Resume,
    /// Decelerates along the path and discards the rest of it, drives on.
    Stop,
    /// Jogs an axis. An unchanged jog at a speed is a renewal.
    Jog(Jog),
    /// Moves an axis to its reference.
    Home {
        /// Axis.
        axis: u8,
    },
    /// Moves an axis to a hard stop with a limited force, which becomes its reference, and backs off.
    HomeToStop {
        /// Axis.
        axis: u8,
        /// How the stop is found.
        settings: HardStopSettings,
    },
    /// Prepares a check of the direction of an axis with a small force, drives off: it starts when the enable switch is next
    /// closed, after it was open.
    CheckDirection {
        /// Axis.
        axis: u8,
        /// How it is checked.
        settings: DirectionCheckSettings,
    },
    /// Discards the blocks of a motion that has not been started.
    NewMotion,
    /// Appends a block to the motion. The whole motion is checked: each block, its travel and its speed, from the present
    /// command or the end of the block before.
    AddBlock(BlockOf<PerAxis<f64>>),
    /// Starts the motion.
    StartMotion {
        /// Number of blocks that it has to have.
        blocks: u16,
    },
    /// A part of an upload.
    Upload {
        /// Bytes before this part; 0 starts a new upload.
        offset: u16,
        /// The part.
        bytes: heapless::Vec<u8, PART>,
    },
    /// Checks the upload as a whole and applies it, with the drives off.
    Apply {
        /// What it is.
        kind: UploadKind,
        /// Number of bytes.
        length: u16,
        /// Their CRC-32.
        checksum: u32,
    },
    /// Switches a compensation of an axis on or off.
    Switch {
        /// Axis.
        axis: u8,
        /// Compensation.
        kind: CompensationKind,
        /// On.
        on: bool,
    },
    /// Makes what was uploaded since [`Request::BeginSave`] the settings of the next start.
    Save,
    /// Arms a recording of every tick.
    Arm {
        /// When it starts.
        trigger: Trigger,
        /// Number of samples.
        samples: u32,
    },
    /// Ends a recording.
    EndCapture,
    /// The state of the recording.
    Capture,
    /// Bytes of a recording that is complete.
    ReadCapture {
        /// First byte.
        offset: u32,
    },
    /// Streams every n-th tick; 0 ends it.
    Stream {
        /// Ticks per sample.
        decimation: u32,
    },
    /// Erases the older of the two records in flash, with the drives off. Each upload that is applied from here on is also written
    /// to it, until [`Request::Save`]; a refused one, or another session, discards it. The axes lose their references: while
    /// the flash is erased, for some seconds, the program stands still.
    BeginSave,
    /// What the board is, without a session.
    Identify,
    /// Sets the feed override of what runs, also without a session: the path runs at this share of its planned speed, as far as its
    /// axes permit it ([`FeedOverride`](super::feed_override::FeedOverride)). It is no sign of life of the host then.
    Override {
        /// 0 to 200 %.
        percent: u8,
    },
    /// Adds a force of a few tones to that of the velocity controller of an axis, with the drives on and the axes at rest, to measure a
    /// frequency response. It lasts until a hold, a stop, the drives off, another session, or a silence of the host by which a path would be
    /// held.
    Excite(ExcitationSettings),
    /// Moves an axis until the probe is touched, and keeps the positions of that tick.
    Probe {
        /// Axis.
        axis: u8,
        /// How it is moved.
        settings: ProbeSettings,
    },
    /// Lets an axis at rest follow an external counter, with the drives on, until a hold, a stop, the drives off, a fault, or a silence of the host by
    /// which a path would be held: see [`following`](crate::interpolate::following).
    Follow {
        /// Axis.
        axis: u8,
        /// What it follows, and how.
        settings: FollowSettings,
    },
}

impl Request {
    /// The halt that it is, if it is one.
    #[must_use]
    pub const fn halt(&self) -> Option<Halt> {
        match self {
            Self::Hold => Some(Halt::Hold),
            Self::Stop => Some(Halt::Stop),
            Self::Disable => Some(Halt::Disable),
            _ => None,
        }
    }
}

impl Request {
    /// [`Request::AddBlock`] of a block of `N` axes. More than [`MAX_AXES`] are an error of the compiler.
    #[must_use]
    pub fn add_block<const N: usize>(block: Block<N>) -> Self {
        const { assert!(N <= MAX_AXES, "a board has 1 to 4 axes") };
        Self::AddBlock(block.map(|to_m| to_m.into_iter().collect()))
    }
}

impl From<Halt> for Request {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Hold => Self::Hold,
            Halt::Stop => Self::Stop,
            Halt::Disable => Self::Disable,
        }
    }
}

/// The reply to a request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "one reply at a time, and nothing to allocate it from")]
pub enum Reply {
    /// A session is open, or what the board is.
    Welcome(Welcome),
    /// Executed.
    Done,
    /// Refused; nothing has changed.
    Refused(Refusal),
    /// The state of the board.
    Status(Status),
    /// The last faults and warnings, the newest first.
    FaultHistory(heapless::Vec<HistoryEntry, HISTORY>),
    /// The state of the recording.
    Capture(CaptureReport),
    /// Bytes of a recording; none behind its end.
    Bytes(heapless::Vec<u8, READ>),
}

/// What a board sends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromBoard {
    /// The reply to a request, with its sequence number.
    Reply(Reply),
    /// Samples of the stream.
    Stream(StreamPacket),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensate::CompensationSettings;

    /// Less than a part remains free, so that the capacity is not larger than necessary.
    #[test]
    fn the_longest_upload_fits_its_capacity() {
        let mut bytes = [0; LONGEST_UPLOAD];
        let length = postcard::to_slice(&CompensationSettings::longest(), &mut bytes).unwrap().len();
        assert!(length > LONGEST_UPLOAD - PART, "{length} bytes");
    }
}
