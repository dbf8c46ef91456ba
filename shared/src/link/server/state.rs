//! What a server keeps between requests.

use super::super::envelope::AdmittedSettings;
use super::super::message::{Jog, LONGEST_UPLOAD, MOTION_BLOCKS};
use super::super::packet::Frame;
use super::super::report::{Identity, SettingsReport, UsbState};
use super::super::session::SessionState;
use super::super::settings_memory::SettingsMemory;
use crate::interpolate::feed_hold::MOST_PERCENT;
use crate::interpolate::{Block, Path};
use crate::units::Position;

/// What a server keeps between requests.
#[derive(Debug)]
pub(super) struct ServerState<const N: usize> {
    pub(super) identity: Identity<N>,
    pub(super) session: SessionState,
    /// The reply to the last request that was executed.
    pub(super) kept: Frame,
    pub(super) settings: AdmittedSettings<N>,
    /// Where they are from, and what the flash holds.
    pub(super) report: SettingsReport,
    /// The USB port of the board.
    pub(super) usb: UsbState,
    pub(super) upload: Upload,
    pub(super) motion: Motion<N>,
    /// Number of the next packet of the stream, and the tick of the last one.
    pub(super) stream_packets: u32,
    pub(super) streamed_at: u64,
}

/// A motion that the host has sent.
#[derive(Debug)]
pub(super) struct Motion<const N: usize> {
    pub(super) blocks: heapless::Vec<Block<N>, MOTION_BLOCKS>,
    /// Where it starts, and where its last block ends.
    pub(super) start: [Position; N],
    pub(super) end: [Position; N],
    /// The greatest override that all of its blocks permit, %.
    pub(super) most_percent: u8,
    /// A copy of the queue of the path, on which blocks are planned.
    pub(super) plan: Path<N>,
    /// The jog at a speed that runs.
    pub(super) jog: Option<Jog>,
}

impl<const N: usize> Motion<N> {
    pub(super) const EMPTY: Self = Self {
        blocks: heapless::Vec::new(),
        start: [Position(0); N],
        end: [Position(0); N],
        most_percent: MOST_PERCENT,
        plan: Path::AT_ZERO,
        jog: None,
    };
}

/// An upload that is not complete or not applied yet.
#[derive(Debug)]
pub(super) struct Upload {
    pub(super) bytes: heapless::Vec<u8, LONGEST_UPLOAD>,
}

impl Upload {
    pub(super) const EMPTY: Self = Self { bytes: heapless::Vec::new() };
}

/// What the requests act on.
#[derive(Debug)]
pub(super) struct Access<'a, D, F> {
    pub(super) drive: &'a mut D,
    pub(super) memory: &'a mut SettingsMemory<F>,
}
