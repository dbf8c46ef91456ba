//! Executes the requests of a host, between ticks.
//!
//! A request that takes long, such as the conversion of a table or the planning of a block, is computed outside of
//! [`SharedDrive::with`]: ticks go on meanwhile.

mod block_limits;
mod compensation_reader;
mod excitation;
mod following;
mod hard_stop;
mod motion;
mod outside;
mod probing;
mod recording;
mod saving;
mod state;
mod upload;
mod waiting;

use super::HostedDrive;
use super::envelope::AdmittedSettings;
use super::message::{FromBoard, MAX_AXES, Reply, Request};
use super::packet::{self, Frame, Header, Packet, PacketError, VERSION};
use super::port::{BytePort, SharedDrive};
use super::receiver::{LinkCounts, Receiver};
use super::refusal::Refusal;
use super::report::{Identity, SettingsReport, UsbState, Welcome};
use super::session::{SessionState, Verdict};
use super::settings_memory::SettingsMemory;
use crate::SOURCES;
use crate::safety::Fault;
use crate::scalar::Scalar;
use embedded_storage::nor_flash::NorFlash;
use saving::begin_save;
use state::{Access, Motion, ServerState, Upload};
use waiting::Waiting;

/// Greatest number of bytes that are taken in one call.
const BYTES_PER_POLL: usize = 64;

/// The server of one host, on a board of `N` axes. It is large: a static on a chip.
#[derive(Debug)]
pub struct Server<const N: usize> {
    receiver: Receiver,
    state: ServerState<N>,
    waiting: Waiting,
    /// Bytes that wait to be sent, and how many of them have been.
    out: Frame,
    sent: usize,
}

impl<const N: usize> Server<N> {
    /// Without a session. `settings` are those that the machine is configured with. A board has 1 to [`MAX_AXES`] axes: another number is
    /// an error of the compiler.
    #[must_use]
    pub const fn new(identity: Identity<N>, settings: AdmittedSettings<N>) -> Self {
        const { assert!(N >= 1 && N <= MAX_AXES, "a board has 1 to 4 axes") };
        Self {
            receiver: Receiver::NEW,
            state: ServerState {
                identity,
                session: SessionState::NEW,
                kept: Frame::new(),
                settings,
                report: SettingsReport::PROGRAM,
                usb: UsbState::None,
                upload: Upload::EMPTY,
                motion: Motion::EMPTY,
                stream_packets: 0,
                streamed_at: 0,
            },
            waiting: Waiting::NONE,
            out: Frame::new(),
            sent: 0,
        }
    }

    /// Applies the settings in flash. To be called once, before the first [`Server::poll`]; ticks may run, with the drives off. A
    /// flash whose settings cannot be used is a fault ([`Fault::StoredSettings`]) that has to be acknowledged, as the fault that
    /// ended the previous run; the settings of the program remain then.
    pub fn load<'m, S: Scalar, F: NorFlash>(
        &mut self,
        drive: &mut impl SharedDrive<'m, S, N>,
        memory: &mut SettingsMemory<F>,
        previous_fault: Option<Fault>,
    ) {
        self.state.load(&mut Access { drive, memory });
        if let Some(fault) = previous_fault {
            drive.with(|drive| drive.inhibit_enable(fault));
        }
    }

    /// Takes what the port has received, executes requests, sends replies and the stream. To be called repeatedly. It waits for
    /// the flash only, with the drives off.
    ///
    /// A halt is executed as soon as it has been received, also while the port takes no bytes; any other request once the reply before
    /// it has been sent.
    pub fn poll<'m, S: Scalar, F: NorFlash>(
        &mut self,
        port: &mut impl BytePort,
        drive: &mut impl SharedDrive<'m, S, N>,
        memory: &mut SettingsMemory<F>,
    ) {
        self.state.usb = port.usb();
        self.flush(port);
        for _ in 0..BYTES_PER_POLL {
            self.take_waiting(&mut Access { drive, memory });
            let Some(byte) = port.read() else { break };
            let counts = self.receiver.counts();
            let Some(received) = self.receiver.push(byte) else { continue };
            if self.out.is_empty() {
                self.state.receive(received, counts, &mut Access { drive, memory }, &mut self.out);
                self.flush(port);
            } else if let Ok(packet) = received {
                if self.state.halt_at_once(&packet, drive) {
                    self.waiting.halted(packet.header);
                } else {
                    self.waiting.keep(&packet);
                }
            }
        }
        self.state.feed_motion(drive);
        self.state.feed_legs(drive);
        if self.out.is_empty() {
            self.state.stream(drive, &mut self.out);
        }
        self.flush(port);
    }

    /// Answers what has waited until the reply before it was sent: halts, then a request.
    fn take_waiting<'m, S: Scalar, D: SharedDrive<'m, S, N>, F: NorFlash>(
        &mut self,
        access: &mut Access<'_, D, F>,
    ) {
        if !self.out.is_empty() {
            return;
        }
        if let Some(header) = self.waiting.next_halted() {
            send(header, Reply::Done, &mut self.out);
        } else if let Some(packet) = self.waiting.packet() {
            let counts = self.receiver.counts();
            self.state.receive(Ok(packet), counts, access, &mut self.out);
            self.waiting.forget();
        }
    }

    // Not inlined: it is called several times.
    #[inline(never)]
    fn flush(&mut self, port: &mut impl BytePort) {
        if let Some(rest) = self.out.get(self.sent..).filter(|rest| !rest.is_empty()) {
            self.sent += port.write(rest);
        }
        if self.sent >= self.out.len() {
            self.out.clear();
            self.sent = 0;
        }
    }
}

impl<const N: usize> ServerState<N> {
    /// Answers what was received. Bytes that are no packet are only counted: they may be noise.
    fn receive<'m, S: Scalar, D: SharedDrive<'m, S, N>, F: NorFlash>(
        &mut self,
        received: Result<Packet<'_>, PacketError>,
        counts: LinkCounts,
        access: &mut Access<'_, D, F>,
        out: &mut Frame,
    ) {
        let packet = match received {
            Ok(packet) => packet,
            Err(PacketError::Version { .. }) => {
                let refusal = Reply::Refused(Refusal::Version { supported: VERSION });
                send(Header { session: 0, sequence: 0 }, refusal, out);
                return;
            }
            Err(_) => return,
        };
        let request = packet::message::<Request>(packet.message);
        if let Ok(Request::Hello { nonce }) = request {
            access.memory.discard();
            self.greet(nonce, packet.header.sequence, access.drive, out);
            return;
        }
        match self.session.judge(&packet) {
            Verdict::Execute => {
                access.drive.with(HostedDrive::heard);
                let reply = match request {
                    Ok(request) => self.execute(&request, counts, access),
                    Err(_) => Reply::Refused(Refusal::Unreadable),
                };
                send(packet.header, reply, out);
                self.session.executed(&packet);
                self.kept.clone_from(out);
            }
            Verdict::Repeat => {
                access.drive.with(HostedDrive::heard);
                out.clone_from(&self.kept);
            }
            Verdict::Refuse(refusal) => {
                let reply = match request {
                    Ok(request) => {
                        self.execute_outside(&request, (packet.header, refusal), counts, access.drive)
                    }
                    Err(_) => Reply::Refused(refusal),
                };
                send(packet.header, reply, out);
            }
        }
    }

    /// Opens a session. The stream of the previous one ends.
    #[inline(never)]
    fn greet<'m, S: Scalar>(
        &mut self,
        nonce: u32,
        sequence: u32,
        drive: &mut impl SharedDrive<'m, S, N>,
        out: &mut Frame,
    ) {
        let now = drive.with(|drive| {
            drive.stream().start(0);
            drive.greeted();
            drive.now()
        });
        #[expect(clippy::cast_possible_truncation, reason = "the low half differs from run to run")]
        let session = self.session.hello(nonce, now as u32);
        send(Header { session, sequence }, self.welcome(session, drive), out);
    }

    /// What the board is.
    #[inline(never)]
    fn welcome<'m, S: Scalar>(&self, session: u32, drive: &mut impl SharedDrive<'m, S, N>) -> Reply {
        let capture_bytes = drive.with(|drive| drive.capture().capacity());
        Reply::Welcome(Welcome {
            session,
            board: text(self.identity.board),
            software: text(self.identity.software),
            sources: SOURCES,
            rates: self.settings.rates,
            times: self.identity.times,
            steps: (&self.identity.steps).into(),
            capture_bytes: u32::try_from(capture_bytes).unwrap_or(u32::MAX),
        })
    }

    fn execute<'m, S: Scalar, D: SharedDrive<'m, S, N>, F: NorFlash>(
        &mut self,
        request: &Request,
        counts: LinkCounts,
        access: &mut Access<'_, D, F>,
    ) -> Reply {
        if request.halt().is_none()
            && let Some(halt) = access.drive.with(HostedDrive::take_halt_by_other)
        {
            return Reply::Refused(Refusal::HaltedByOther(halt));
        }
        let done = match request {
            Request::BeginSave => begin_save(access),
            Request::Save => self.save(access),
            Request::Apply { kind, length, checksum } => self.apply(*kind, *length, *checksum, access),
            _ => return self.execute_without_flash(request, counts, access.drive),
        };
        done.map_or_else(Reply::Refused, |()| Reply::Done)
    }

    // Not inlined, as the functions below: their messages are not on the stack while a compensation is converted.
    #[inline(never)]
    fn execute_without_flash<'m, S: Scalar>(
        &mut self,
        request: &Request,
        counts: LinkCounts,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Reply {
        if let Some(reply) = self.look(request, counts, drive) {
            return reply;
        }
        if let Some(halt) = request.halt() {
            drive.with(|drive| drive.halt(halt));
            return Reply::Done;
        }
        let done = match request {
            Request::Capture => {
                return Reply::Capture(drive.with(|drive| recording::report(drive.capture())));
            }
            Request::ReadCapture { offset } => return recording::read(drive, *offset),
            // They do not get here.
            Request::Hello { .. }
            | Request::BeginSave
            | Request::Save
            | Request::Apply { .. }
            | Request::Hold
            | Request::Stop
            | Request::Disable
            | Request::Status
            | Request::FaultHistory
            | Request::Identify => Err(Refusal::Unreadable),
            Request::Enable => drive.with(HostedDrive::enable),
            Request::Clear => drive.with(HostedDrive::clear),
            Request::Resume => drive.with(HostedDrive::resume),
            Request::Override { percent } => drive.with(|drive| drive.set_override(*percent)),
            Request::Jog(jog) => self.jog(jog, drive),
            Request::CheckDirection { axis, settings } => {
                drive.with(|drive| drive.check_direction(usize::from(*axis), settings))
            }
            Request::Home { axis } => self.home(*axis, drive),
            Request::HomeToStop { axis, settings } => self.home_to_stop(*axis, settings, drive),
            Request::Probe { axis, settings } => self.probe(*axis, settings, drive),
            Request::Excite(settings) => self.excite(settings, drive),
            Request::Follow { axis, settings } => self.follow(*axis, settings, drive),
            Request::NewMotion => self.new_motion(drive),
            Request::AddBlock(block) => self.add_block(block, drive),
            Request::StartMotion { blocks } => self.start_motion(*blocks, drive),
            Request::Upload { offset, bytes } => self.upload.append(*offset, bytes),
            Request::Switch { axis, kind, on } => drive.with(|drive| {
                drive.machine_mut().switch(usize::from(*axis), *kind, *on).map_err(Refusal::from)
            }),
            Request::Arm { trigger, samples } => recording::arm(drive, *trigger, *samples),
            Request::EndCapture => drive.with(|drive| {
                drive.capture().end();
                Ok(())
            }),
            Request::Stream { decimation } => drive.with(|drive| {
                drive.stream().start(*decimation);
                Ok(())
            }),
        };
        done.map_or_else(Reply::Refused, |()| Reply::Done)
    }
}

/// Writes a reply to `out`.
#[inline(never)]
fn send(header: Header, reply: Reply, out: &mut Frame) {
    // Every reply fits: a test encodes the longest ones.
    if packet::encode(header, &FromBoard::Reply(reply), out).is_err() {
        out.clear();
    }
}

/// A text, cut to its capacity.
fn text<const L: usize>(text: &str) -> heapless::String<L> {
    text.chars().filter(char::is_ascii).take(L).collect()
}
