//! A host at the serial port of the emulated board: the protocol of the link over the emulator's socket.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use shared::link::packet::{self, Header};
use shared::link::{Frame, FromBoard, Receiver, Reply, Request, Welcome};
use tests::board::Chip;

/// The packet of the next request of a session. A hello opens one.
pub fn next_packet(session: u32, sequence: &mut u32, request: &Request) -> Frame {
    let header = if let Request::Hello { .. } = request {
        Header { session: 0, sequence: 0 }
    } else {
        *sequence += 1;
        Header { session, sequence: *sequence }
    };
    let mut frame = Frame::new();
    packet::encode(header, request, &mut frame).unwrap();
    frame
}

/// The host's side of a session.
pub struct Host {
    stream: UnixStream,
    receiver: Receiver,
    session: u32,
    sequence: u32,
}

impl Host {
    /// Connects to USART3.
    pub fn connect(chip: &Chip) -> Self {
        let stream = UnixStream::connect(chip.serial()).unwrap();
        stream.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
        Self { stream, receiver: Receiver::NEW, session: 0, sequence: 0 }
    }

    /// Sends a request; a hello opens a session. The board takes it while it runs.
    pub fn send(&mut self, request: &Request) {
        let frame = next_packet(self.session, &mut self.sequence, request);
        self.stream.write_all(&frame).unwrap();
    }

    /// The next reply, of those that the board has sent while it ran.
    pub fn reply(&mut self) -> Option<Reply> {
        let mut byte = [0];
        loop {
            match self.stream.read(&mut byte) {
                Ok(1) => {}
                Ok(_) => return None,
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    return None;
                }
                Err(error) => panic!("{error}"),
            }
            let Some(received) = self.receiver.push(byte[0]) else { continue };
            let packet = received.unwrap();
            match packet::message::<FromBoard>(packet.message).unwrap() {
                FromBoard::Reply(reply) => {
                    if let Reply::Welcome(Welcome { session, .. }) = &reply {
                        (self.session, self.sequence) = (*session, 0);
                    }
                    return Some(reply);
                }
                FromBoard::Stream(_) => {}
            }
        }
    }
}
