//! Requests and their replies.

use std::collections::VecDeque;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use shared::link::message::{FromBoard, Reply, Request};
use shared::link::packet::{self, Frame, Header};
use shared::link::stream::StreamPacket;
use shared::link::{Receiver, Refusal, Status, Welcome};

use crate::error::BoardError;
use crate::port::Port;

/// Repetitions of a request whose reply does not arrive.
const REPETITIONS: u32 = 3;

/// A session with a board.
#[derive(Debug)]
pub struct Client {
    port: Port,
    receiver: Box<Receiver>,
    session: u32,
    sequence: u32,
    timeout: Duration,
    welcome: Welcome,
    streamed: VecDeque<StreamPacket>,
}

impl Client {
    /// Opens a session. `timeout` is the longest wait for a reply.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn connect(port: Port, timeout: Duration) -> Result<Self, BoardError> {
        let mut client = Self::without_session(port, timeout)?;
        client.sequence = 0;
        let Reply::Welcome(welcome) = client.exchange(&Request::Hello { nonce: nonce() })? else {
            return Err(BoardError::Unexpected);
        };
        client.session = welcome.session;
        client.welcome = welcome;
        Ok(client)
    }

    /// Without a session: the board answers what needs none.
    pub(crate) fn without_session(port: Port, timeout: Duration) -> Result<Self, BoardError> {
        let mut client = Self {
            port,
            receiver: Box::new(Receiver::NEW),
            session: 0,
            // Not a number of an earlier program, whose reply may still be on the line.
            sequence: nonce() >> 1,
            timeout,
            welcome: no_welcome(),
            streamed: VecDeque::new(),
        };
        // Ends whatever an earlier program has left on the line.
        client.port.send(&[0])?;
        Ok(client)
    }

    /// What the board is.
    #[must_use]
    pub const fn welcome(&self) -> &Welcome {
        &self.welcome
    }

    /// Number of axes of the board.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.welcome.steps.axes.len()
    }

    /// Sends a request and returns its reply.
    ///
    /// # Errors
    /// [`BoardError`], a refusal included.
    pub fn request(&mut self, request: &Request) -> Result<Reply, BoardError> {
        self.sequence = self.sequence.wrapping_add(1);
        self.exchange(request)
    }

    /// Sends a request whose reply is [`Reply::Done`].
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn command(&mut self, request: &Request) -> Result<(), BoardError> {
        match self.request(request)? {
            Reply::Done => Ok(()),
            _ => Err(BoardError::Unexpected),
        }
    }

    /// Sends a request whose reply is [`Reply::Done`] and may take longer than others.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn command_within(&mut self, request: &Request, timeout: Duration) -> Result<(), BoardError> {
        let usual = std::mem::replace(&mut self.timeout, timeout);
        let result = self.command(request);
        self.timeout = usual;
        result
    }

    /// The state of the board.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn status(&mut self) -> Result<Status, BoardError> {
        match self.request(&Request::Status)? {
            Reply::Status(status) => Ok(status),
            _ => Err(BoardError::Unexpected),
        }
    }

    /// Receives the stream for a time. A program that sleeps instead lets the line fill up, and the board loses samples.
    ///
    /// # Errors
    /// The failure of the port.
    pub fn listen(&mut self, time: Duration) -> Result<(), BoardError> {
        let started = Instant::now();
        while started.elapsed() < time {
            self.receive()?;
        }
        Ok(())
    }

    /// The next packet of the stream that has been received with the replies.
    pub fn streamed(&mut self) -> Option<StreamPacket> {
        self.streamed.pop_front()
    }

    /// Sends the request with the present sequence number, and again if there is no reply.
    fn exchange(&mut self, request: &Request) -> Result<Reply, BoardError> {
        let mut frame = Frame::new();
        let header = Header { session: self.session, sequence: self.sequence };
        packet::encode(header, request, &mut frame).map_err(|_| BoardError::TooLong)?;
        for _ in 0..=REPETITIONS {
            self.port.send(&frame)?;
            if let Some(reply) = self.wait_for_reply(header.sequence)? {
                return match reply {
                    Reply::Refused(Refusal::HaltedByOther(halt)) => Err(BoardError::HaltedByOther(halt)),
                    Reply::Refused(refusal) => Err(BoardError::Refused(refusal)),
                    reply => Ok(reply),
                };
            }
        }
        Err(BoardError::Silent { seconds: self.timeout.as_secs_f64() * f64::from(REPETITIONS + 1) })
    }

    /// The reply with a sequence number; `None` after the timeout.
    fn wait_for_reply(&mut self, sequence: u32) -> Result<Option<Reply>, BoardError> {
        let started = Instant::now();
        while started.elapsed() < self.timeout {
            if let Some((header, reply)) = self.receive()?
                && (self.is_mine(header, sequence) || is_version(&reply))
            {
                return Ok(Some(reply));
            }
        }
        Ok(None)
    }

    /// Whether a reply is that to a request of this session; that to a hello has the number of the session that it opens.
    const fn is_mine(&self, header: Header, sequence: u32) -> bool {
        header.sequence == sequence && (self.session == 0 || header.session == self.session)
    }

    /// Takes what has arrived. Keeps packets of the stream; returns the last reply.
    fn receive(&mut self) -> Result<Option<(Header, Reply)>, BoardError> {
        let mut bytes = [0; 1024];
        let received = self.port.receive(&mut bytes)?;
        let mut last = None;
        for byte in &bytes[..received] {
            // What is damaged is repeated after the timeout.
            let Some(Ok(packet)) = self.receiver.push(*byte) else { continue };
            match packet::message::<FromBoard>(packet.message) {
                Ok(FromBoard::Reply(reply)) => last = Some((packet.header, reply)),
                Ok(FromBoard::Stream(samples)) if packet.header.session == self.session => {
                    self.streamed.push_back(samples);
                }
                Ok(FromBoard::Stream(_)) | Err(_) => {}
            }
        }
        Ok(last)
    }
}

/// Whether a reply says that the board has another version: it has no sequence number.
fn is_version(reply: &Reply) -> bool {
    matches!(reply, Reply::Refused(Refusal::Version { .. }))
}

/// A number that differs from program to program.
fn nonce() -> u32 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    now.subsec_nanos() ^ std::process::id().rotate_left(16)
}

/// Before the hello.
fn no_welcome() -> Welcome {
    use shared::config::Rates;
    use shared::link::steps::ListedSteps;
    Welcome {
        session: 0,
        board: heapless::String::new(),
        software: heapless::String::new(),
        sources: 0,
        rates: Rates { velocity_loop_hz: 0.0, position_loop_divider: 1 },
        times: shared::link::Times::default(),
        steps: ListedSteps::default(),
        capture_bytes: 0,
    }
}
