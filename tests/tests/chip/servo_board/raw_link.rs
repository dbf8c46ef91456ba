//! The link of an emulated board without the program of the host: any request with any header.

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use shared::link::message::{FromBoard, Reply, Request};
use shared::link::packet::{self, Frame, Header};
use shared::link::{Receiver, Welcome};

use super::emulated_board::EmulatedBoard;

/// Longest wait for replies.
const TIMEOUT: Duration = Duration::from_secs(10);

/// A connection with a session.
pub struct RawLink {
    stream: UnixStream,
    receiver: Receiver,
    pub welcome: Welcome,
}

pub fn frame(header: Header, request: &Request) -> Frame {
    let mut frame = Frame::new();
    packet::encode(header, request, &mut frame).unwrap();
    frame
}

impl RawLink {
    /// Opens a session at a board that runs.
    pub fn open(board: &EmulatedBoard) -> Self {
        let stream = UnixStream::connect(board.path().join("run").join("link")).unwrap();
        stream.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
        let hello = frame(Header::without_session(0), &Request::Hello { nonce: 5 });
        let (stream, receiver, found) = exchange(stream, Receiver::NEW, &hello, 1);
        let [Reply::Welcome(welcome)] = &found[..] else { panic!("{found:?}") };
        Self { stream, receiver, welcome: welcome.clone() }
    }

    /// The header of a request of the session.
    pub const fn header(&self, sequence: u32) -> Header {
        Header { session: self.welcome.session, sequence }
    }

    /// Sends frames in one piece. Returns the replies, at most `count`.
    pub fn exchange(&mut self, frames: &[Frame], count: usize) -> Vec<Reply> {
        let stream = self.stream.try_clone().unwrap();
        let receiver = std::mem::replace(&mut self.receiver, Receiver::NEW);
        let (_, receiver, found) = exchange(stream, receiver, &frames.concat(), count);
        self.receiver = receiver;
        found
    }
}

fn exchange(
    mut stream: UnixStream,
    mut receiver: Receiver,
    bytes: &[u8],
    count: usize,
) -> (UnixStream, Receiver, Vec<Reply>) {
    stream.write_all(bytes).unwrap();
    let (mut all, started, mut bytes) = (Vec::new(), Instant::now(), [0; 1024]);
    while all.len() < count && started.elapsed() < TIMEOUT {
        let received = stream.read(&mut bytes).unwrap_or(0);
        all.extend(replies(&mut receiver, &bytes[..received]));
    }
    (stream, receiver, all)
}

/// The replies in bytes.
fn replies(receiver: &mut Receiver, bytes: &[u8]) -> Vec<Reply> {
    let mut replies = Vec::new();
    for byte in bytes {
        if let Some(Ok(packet)) = receiver.push(*byte)
            && let Ok(FromBoard::Reply(reply)) = packet::message(packet.message)
        {
            replies.push(reply);
        }
    }
    replies
}
