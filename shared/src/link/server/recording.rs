//! Recordings and the stream.

use super::super::HostedDrive;
use super::super::message::{FromBoard, READ, Reply};
use super::super::packet::{self, Frame, Header};
use super::super::port::SharedDrive;
use super::super::refusal::Refusal;
use super::super::report::CaptureReport;
use super::super::stream::StreamPacket;
use super::state::ServerState;
use crate::capture::prediction::MAX_PERIOD;
use crate::capture::{CaptureMemory, CaptureState, Trigger};
use crate::scalar::Scalar;

/// Samples that are waited for before a packet is sent.
const SAMPLES_PER_PACKET: usize = 24;

/// Part of a second after which a packet with fewer samples is sent.
const PACKETS_PER_SECOND: u32 = 50;

pub(super) fn report<const N: usize>(capture: &CaptureMemory<'_, N>) -> CaptureReport {
    CaptureReport {
        state: capture.state(),
        samples: capture.samples(),
        bytes: u32::try_from(capture.bytes().len()).unwrap_or(u32::MAX),
        period: capture.period(),
        start: capture.start(),
    }
}

pub(super) fn read<'m, S: Scalar, const N: usize>(
    drive: &mut impl SharedDrive<'m, S, N>,
    offset: u32,
) -> Reply {
    let offset = usize::try_from(offset).unwrap_or(usize::MAX);
    drive.with(|drive| {
        let capture = drive.capture();
        if capture.state() != CaptureState::Complete {
            return Reply::Refused(Refusal::NoCapture);
        }
        let rest = capture.bytes().get(offset..).unwrap_or_default();
        Reply::Bytes(rest.iter().take(READ).copied().collect())
    })
}

pub(super) fn arm<'m, S: Scalar, const N: usize>(
    drive: &mut impl SharedDrive<'m, S, N>,
    trigger: Trigger,
    samples: u32,
) -> Result<(), Refusal> {
    drive.with(|drive| {
        let period = period(drive, 1);
        drive.capture().arm(trigger, samples.max(1), period);
        Ok(())
    })
}

/// Samples per position tick of a recording of every `decimation`-th tick.
fn period<S: Scalar, const N: usize>(drive: &HostedDrive<'_, S, N>, decimation: u32) -> u32 {
    let divider = drive.machine().position_loop_divider();
    let period = divider.checked_div(decimation).unwrap_or(0);
    let is_whole = period * decimation == divider && period as usize <= MAX_PERIOD;
    if is_whole { period.max(1) } else { 1 }
}

impl<const N: usize> ServerState<N> {
    /// Sends samples that wait, when there are enough of them or they have waited long enough.
    // Not inlined: its packet is not on the stack while a request is executed.
    #[inline(never)]
    pub(super) fn stream<'m, S: Scalar>(&mut self, drive: &mut impl SharedDrive<'m, S, N>, out: &mut Frame) {
        let interval = u64::from(self.identity.tick_hz / PACKETS_PER_SECOND);
        let since = self.streamed_at;
        let due = drive.with(|drive| {
            let (now, waiting) = (drive.now(), drive.stream().waiting());
            let due = waiting >= SAMPLES_PER_PACKET || waiting > 0 && now.wrapping_sub(since) >= interval;
            due.then(|| {
                let decimation = drive.stream().decimation();
                (now, period(drive, decimation), drive.stream().start_tick())
            })
        });
        let Some((now, period, start)) = due else { return };
        let packet = StreamPacket::fill(period, |number| drive.with(|drive| drive.stream().pop(number)));
        let Some(packet) = packet else { return };
        let packet = StreamPacket { start, lost: drive.with(|drive| drive.stream().lost()), ..packet };
        let header = Header { session: self.session.number(), sequence: self.stream_packets };
        if packet::encode(header, &FromBoard::Stream(packet), out).is_err() {
            out.clear();
        }
        self.stream_packets = self.stream_packets.wrapping_add(1);
        self.streamed_at = now;
    }
}
