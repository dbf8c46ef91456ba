//! The link between a host and a servo board that runs its own ticks.
//!
//! The host sends one [`Request`] at a time and gets one [`Reply`]; a board that streams also sends samples by itself.
//!
//! | module | contents |
//! |---|---|
//! | [`packet`] | a message in bytes: version, session, sequence number, CRC-32, COBS |
//! | [`receiver`] | bytes to packets; whatever cannot be one is counted by its kind |
//! | [`message`], [`refusal`], [`report`] | requests and replies |
//! | [`steps`] | the steps of the recorded channels in a message |
//! | [`board_settings`], [`envelope`] | settings, and what they may not exceed |
//! | [`feed_override`] | the override of a motion that runs |
//! | [`session`] | which request is new, repeated, old or of another session |
//! | [`hosted_drive`] | the part that runs in the tick: drives, silence of the host, jog, recording, history of faults |
//! | [`server`] | the part that runs between ticks: executes requests |
//! | [`settings_memory`] | what was uploaded, in flash |
//! | [`port`] | what a board provides: bytes, and access to the part in the tick |
//! | [`can_frames`] | the bytes in frames of CAN FD |
//! | [`two_ports`] | two ports with one server: which of them is the host's |
//!
//! # Rules
//!
//! - The enable switch of the board permits an enable; a request enables. A host cannot enable drives whose switch is open,
//!   and the switch alone enables nothing.
//! - A host that is silent while the drives are on stops the path after [`Times::hold_ms`] and the drives after
//!   [`Times::off_ms`], which is a fault if a path was held. A jog at a speed ends after [`Times::jog_ms`] unless it is renewed.
//! - A hold, a stop and a disable need no session ([`halt::Halt`]). They are taken from any port, before anything that waits; the
//!   next request of the session is refused, so that its host starts nothing else. They are no sign of life of the host.
//! - A board with two ports has one host: the other port opens a session only while the host is silent.
//! - A force for a frequency response ([`Request::Excite`]) acts at rest, within the envelope and the force limit of the axis,
//!   and ends with whatever ends a motion.
//! - An axis that follows a counter ([`Request::Follow`]) does so until it is held or stopped: nobody can resume it.
//! - A motion is checked whole before it starts. A request that is refused changes nothing.

pub mod board_settings;
pub mod can_frames;
pub mod envelope;
pub mod feed_override;
pub mod halt;
pub mod history;
pub mod hosted_drive;
pub mod message;
pub mod packet;
pub mod port;
pub mod receiver;
pub mod refusal;
pub mod report;
pub mod server;
pub mod session;
pub mod settings_memory;
pub mod steps;
pub mod stream;
pub mod two_ports;
pub mod watch;

pub use envelope::{AdmittedSettings, Envelope};
pub use hosted_drive::HostedDrive;
pub use message::{FromBoard, Reply, Request};
pub use packet::{Frame, Header, PacketError};
pub use port::{BytePort, SharedDrive};
pub use receiver::{LinkCounts, Receiver};
pub use refusal::Refusal;
pub use report::{Identity, Status, Times, Welcome};
pub use server::Server;
pub use settings_memory::SettingsMemory;
pub use two_ports::TwoPorts;
