//! Two ports with one server: a serial port and USB. Which of them is the host's. A board without USB may have a CAN port in its place
//! ([`super::can_frames`]).
//!
//! The server has one session. It reads and writes the *selected* port only, at the start the serial port. A session at the other
//! port begins with a [`Hello`](Request::Hello), and is refused while the host at the selected port is not silent
//! ([`HostedDrive::host_is_silent`](super::HostedDrive::host_is_silent)).
//!
//! | received at the port that is not selected | answer |
//! |---|---|
//! | a hello, while the host at the selected port is silent | this port is selected; the server opens a session |
//! | a halt, of any session or none | executed; the host at the selected port is told with its next request |
//! | a hello otherwise, and every other request | refused: [`Refusal::OtherPort`] |
//! | a packet of another version | refused, with the version of the board |
//! | bytes that are no packet | none |
//!
//! Nothing else that is received there reaches the drives before the port is selected, and nothing of it counts as a sign of life of the
//! host: the supervision of the host cannot be avoided with a second port.

use super::halt::Halt;
use super::message::{FromBoard, Reply, Request};
use super::packet::{self, Frame, Header, PacketError, VERSION};
use super::port::{BytePort, SharedDrive};
use super::receiver::Receiver;
use super::refusal::Refusal;
use super::report::UsbState;
use crate::scalar::Scalar;

/// Greatest number of bytes that are taken in one call.
const BYTES_PER_CALL: usize = 64;

/// Greatest length of the frame of a hello with a zero before it: header (9), variant and number (6), checksum (4), COBS (1), zeros (2).
const HELLO: usize = 22;

/// A port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selected {
    /// The serial port.
    Uart,
    /// USB.
    Usb,
}

impl Selected {
    const fn other(self) -> Self {
        match self {
            Self::Uart => Self::Usb,
            Self::Usb => Self::Uart,
        }
    }
}

/// A USB port.
#[derive(Debug)]
pub struct UsbPort<'r, B> {
    /// The port.
    pub port: B,
    /// For the port that is not selected. It is large, and may be in a memory of its own.
    pub receiver: &'r mut Receiver,
}

/// What was received at the port that is not selected.
enum Received {
    Hello(Header, u32),
    Halt(Header, Halt),
    Refused(Header, Refusal),
}

/// Two ports as one.
#[derive(Debug)]
pub struct TwoPorts<'r, A, B> {
    uart: A,
    usb: Option<UsbPort<'r, B>>,
    selected: Selected,
    /// The hello that selected the port, as far as the server has not read it.
    hello: heapless::Deque<u8, HELLO>,
}

impl<'r, A: BytePort, B: BytePort> TwoPorts<'r, A, B> {
    /// The serial port is selected. Without USB, because it does not answer, it remains selected.
    pub const fn new(uart: A, usb: Option<UsbPort<'r, B>>) -> Self {
        Self { uart, usb, selected: Selected::Uart, hello: heapless::Deque::new() }
    }

    /// The port of the server.
    #[must_use]
    pub const fn selected(&self) -> Selected {
        self.selected
    }

    /// The serial port.
    pub const fn uart(&mut self) -> &mut A {
        &mut self.uart
    }

    /// USB.
    pub fn usb_port(&mut self) -> Option<&mut B> {
        self.usb.as_mut().map(|usb| &mut usb.port)
    }

    /// Takes what the port that is not selected has received, and answers at most one packet. To be called before each
    /// [`Server::poll`](super::Server::poll).
    pub fn service<'m, S: Scalar, const N: usize>(&mut self, drive: &mut impl SharedDrive<'m, S, N>) {
        if !self.hello.is_empty() {
            return;
        }
        match self.receive() {
            Some(Received::Hello(header, nonce)) => {
                if drive.with(|drive| drive.host_is_silent()) {
                    self.select_other(header, nonce);
                } else {
                    self.answer(header, Reply::Refused(Refusal::OtherPort));
                }
            }
            Some(Received::Halt(header, halt)) => {
                drive.with(|drive| drive.halt_from_outside(halt));
                self.answer(header, Reply::Done);
            }
            Some(Received::Refused(header, refusal)) => self.answer(header, Reply::Refused(refusal)),
            None => {}
        }
    }

    /// The next packet at the port that is not selected.
    // Not inlined, as `select_other` and `answer`: request and frame are not on the stack while a request is executed.
    #[inline(never)]
    fn receive(&mut self) -> Option<Received> {
        let usb = self.usb.as_mut()?;
        for _ in 0..BYTES_PER_CALL {
            let byte = match self.selected {
                Selected::Uart => usb.port.read(),
                Selected::Usb => self.uart.read(),
            }?;
            match usb.receiver.push(byte) {
                Some(Ok(packet)) => {
                    return Some(match packet::message::<Request>(packet.message) {
                        Ok(Request::Hello { nonce }) => Received::Hello(packet.header, nonce),
                        Ok(request) if let Some(halt) = request.halt() => Received::Halt(packet.header, halt),
                        _ => Received::Refused(packet.header, Refusal::OtherPort),
                    });
                }
                Some(Err(PacketError::Version { .. })) => {
                    let header = Header { session: 0, sequence: 0 };
                    return Some(Received::Refused(header, Refusal::Version { supported: VERSION }));
                }
                Some(Err(_)) | None => {}
            }
        }
        None
    }

    #[inline(never)]
    fn select_other(&mut self, header: Header, nonce: u32) {
        let mut frame = Frame::new();
        // Both fit: a test has the longest hello.
        if packet::encode(header, &Request::Hello { nonce }, &mut frame).is_err() {
            return;
        }
        // The zero ends what the server has received of the other port.
        for byte in core::iter::once(0).chain(frame) {
            let _ = self.hello.push_back(byte);
        }
        self.selected = self.selected.other();
        // Ends what was sent at this port before.
        self.send(self.selected, &[0]);
    }

    /// A reply that the port does not take is lost: the host repeats its request. It is shorter than a packet of USB.
    #[inline(never)]
    fn answer(&mut self, header: Header, reply: Reply) {
        let mut frame = Frame::new();
        if packet::encode(header, &FromBoard::Reply(reply), &mut frame).is_ok() {
            self.send(self.selected.other(), &frame);
        }
    }

    fn send(&mut self, to: Selected, bytes: &[u8]) -> usize {
        match (to, &mut self.usb) {
            (Selected::Usb, Some(usb)) => usb.port.write(bytes),
            (Selected::Uart, _) => self.uart.write(bytes),
            (Selected::Usb, None) => bytes.len(),
        }
    }
}

impl<A: BytePort, B: BytePort> BytePort for TwoPorts<'_, A, B> {
    fn read(&mut self) -> Option<u8> {
        if let Some(byte) = self.hello.pop_front() {
            return Some(byte);
        }
        match (self.selected, &mut self.usb) {
            (Selected::Usb, Some(usb)) => usb.port.read(),
            _ => self.uart.read(),
        }
    }

    /// What the server sends before it has read the hello belongs to the session at the other port, and is discarded.
    fn write(&mut self, bytes: &[u8]) -> usize {
        if self.hello.is_empty() { self.send(self.selected, bytes) } else { bytes.len() }
    }

    fn usb(&self) -> UsbState {
        self.usb.as_ref().map_or(UsbState::NotAnswering, |usb| usb.port.usb())
    }
}
