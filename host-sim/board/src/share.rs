//! A port that one program uses, and at which others ask for what needs no session.
//!
//! A thread reads the port. Replies to the guests go to them, all other bytes to the program itself. Both write whole frames, each as
//! soon as it has one: a guest does not wait for a reply that the program waits for, and its frame is the next on the line.

use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use shared::link::message::{FromBoard, Request};
use shared::link::packet::{self, Frame, Header, MAX_FRAME};

use crate::byte_stream::{ByteStream, READ_TIMEOUT, receive};

/// The numbers of requests of guests begin here: far from those that the program itself gives to a request without a session.
const FIRST_NUMBER: u32 = 0x8000_0000;

/// The program's own part of the port.
pub struct Shared {
    writer: Writer,
    received: Receiver<io::Result<Vec<u8>>>,
    /// What has been received and not been asked for.
    rest: Vec<u8>,
    ends: Arc<AtomicBool>,
    reader: Option<JoinHandle<()>>,
}

/// The part of the guests.
#[derive(Clone)]
pub struct Guests {
    writer: Writer,
    waiting: Waiting,
    number: Arc<AtomicU32>,
}

type Writer = Arc<Mutex<Box<dyn ByteStream>>>;

/// Who waits for the reply to which number.
type Waiting = Arc<Mutex<HashMap<u32, Sender<FromBoard>>>>;

/// Shares a port.
///
/// # Errors
/// The port, if it cannot be read beside being written.
pub fn share(stream: Box<dyn ByteStream>) -> Result<(Shared, Guests), Box<dyn ByteStream>> {
    let Ok(reading) = stream.another() else { return Err(stream) };
    let writer: Writer = Arc::new(Mutex::new(stream));
    let waiting = Waiting::default();
    let (sender, received) = mpsc::channel();
    let ends = Arc::new(AtomicBool::new(false));
    let router = Router { waiting: Arc::clone(&waiting), to_program: sender, frame: Vec::new() };
    let reader = {
        let ends = Arc::clone(&ends);
        thread::spawn(move || router.run(reading, &ends))
    };
    let guests =
        Guests { writer: Arc::clone(&writer), waiting, number: Arc::new(AtomicU32::new(FIRST_NUMBER)) };
    Ok((Shared { writer, received, rest: Vec::new(), ends, reader: Some(reader) }, guests))
}

fn send(writer: &Writer, bytes: &[u8]) -> io::Result<()> {
    let mut stream = writer.lock().unwrap_or_else(PoisonError::into_inner);
    stream.write_all(bytes)?;
    stream.flush()
}

impl Shared {
    pub(crate) fn send(&self, bytes: &[u8]) -> io::Result<()> {
        send(&self.writer, bytes)
    }

    pub(crate) fn receive(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.rest.is_empty() {
            match self.received.recv_timeout(READ_TIMEOUT) {
                Ok(received) => self.rest = received?,
                Err(RecvTimeoutError::Timeout) => return Ok(0),
                Err(RecvTimeoutError::Disconnected) => return Err(io::ErrorKind::UnexpectedEof.into()),
            }
        }
        let count = self.rest.len().min(bytes.len());
        bytes[..count].copy_from_slice(&self.rest[..count]);
        self.rest.drain(..count);
        Ok(count)
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::SeqCst);
        if let Some(reader) = self.reader.take() {
            // It has its own handle of the port, which is closed with it.
            let _ = reader.join();
        }
    }
}

impl Guests {
    /// Sends a request without a session. Its reply comes from the receiver, if it comes at all.
    ///
    /// # Errors
    /// The failure of the port.
    pub fn ask(&self, request: &Request) -> io::Result<(u32, Receiver<FromBoard>)> {
        let number = self.number.fetch_add(1, Ordering::SeqCst) | FIRST_NUMBER;
        let mut frame = Frame::new();
        packet::encode(Header::without_session(number), request, &mut frame)
            .map_err(|_| io::ErrorKind::InvalidInput)?;
        let (sender, reply) = mpsc::channel();
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner).insert(number, sender);
        send(&self.writer, &frame)?;
        Ok((number, reply))
    }

    /// Nobody waits for a reply any more.
    pub fn forget(&self, number: u32) {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner).remove(&number);
    }
}

/// What reads the port.
struct Router {
    waiting: Waiting,
    to_program: Sender<io::Result<Vec<u8>>>,
    /// Bytes since the last zero.
    frame: Vec<u8>,
}

impl Router {
    fn run(mut self, mut port: Box<dyn ByteStream>, ends: &AtomicBool) {
        let mut bytes = [0; 1024];
        while !ends.load(Ordering::SeqCst) {
            match receive(port.as_mut(), &mut bytes) {
                Ok(count) => self.route(&bytes[..count]),
                Err(error) => {
                    let _ = self.to_program.send(Err(error));
                    return;
                }
            }
        }
    }

    fn route(&mut self, bytes: &[u8]) {
        let mut own = Vec::new();
        for byte in bytes {
            self.frame.push(*byte);
            // Longer than a frame is garbage, which the program counts.
            if (*byte == 0 && !self.is_of_a_guest()) || self.frame.len() > 2 * MAX_FRAME {
                own.append(&mut self.frame);
            }
        }
        if !own.is_empty() {
            let _ = self.to_program.send(Ok(own));
        }
    }

    /// Whether the frame is a reply for which a guest waits. It is passed on then.
    fn is_of_a_guest(&mut self) -> bool {
        let mut frame = self.frame.clone();
        frame.pop();
        let Ok(packet) = packet::decode(&mut frame) else { return false };
        if packet.header.session != 0 {
            return false;
        }
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(guest) = waiting.remove(&packet.header.sequence) else { return false };
        if let Ok(reply) = packet::message::<FromBoard>(packet.message) {
            // A guest that has gone needs no reply.
            let _ = guest.send(reply);
        }
        self.frame.clear();
        true
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use std::io::Read;
    use std::os::unix::net::UnixStream;

    use super::*;
    use shared::link::halt::Halt;
    use shared::link::message::Reply;
    use shared::link::{Receiver as PacketReceiver, Refusal};

    /// The board's end of a line.
    struct Line {
        stream: UnixStream,
        receiver: PacketReceiver,
    }

    impl Line {
        /// The next request.
        fn request(&mut self) -> (Header, Request) {
            let mut byte = [0];
            loop {
                self.stream.read_exact(&mut byte).unwrap();
                if let Some(packet) = self.receiver.push(byte[0]) {
                    let packet = packet.unwrap();
                    return (packet.header, packet::message(packet.message).unwrap());
                }
            }
        }

        fn reply(&mut self, header: Header, reply: Reply) {
            let mut frame = Frame::new();
            packet::encode(header, &FromBoard::Reply(reply), &mut frame).unwrap();
            self.stream.write_all(&frame).unwrap();
        }
    }

    fn shared() -> (Shared, Guests, Line) {
        let (ours, stream) = UnixStream::pair().unwrap();
        ours.set_read_timeout(Some(READ_TIMEOUT)).unwrap();
        let Ok((shared, guests)) = share(Box::new(ours)) else { panic!("a socket can be shared") };
        (shared, guests, Line { stream, receiver: PacketReceiver::NEW })
    }

    /// What the program itself receives until a number of frames has ended.
    fn own(shared: &mut Shared, frames: usize) -> Vec<u8> {
        let mut all = Vec::new();
        let mut bytes = [0; 64];
        while all.split(|byte| *byte == 0).count() <= frames {
            let count = shared.receive(&mut bytes).unwrap();
            all.extend_from_slice(&bytes[..count]);
        }
        all
    }

    /// While the program waits for a reply, a guest's halt is on the line; each gets its own reply, in whatever order, and the program
    /// not a byte of the guest's. A reply that nobody waits for is the program's.
    #[test]
    fn a_guest_does_not_wait_for_the_program_and_each_gets_its_own_reply() {
        let (mut shared, guests, mut line) = shared();
        let mut frame = Frame::new();
        let session = Header { session: 7, sequence: 1 };
        packet::encode(session, &Request::Status, &mut frame).unwrap();
        shared.send(&frame).unwrap();
        let asked = Halt::ALL.map(|halt| guests.ask(&Request::from(halt)).unwrap());
        assert_eq!(line.request(), (session, Request::Status));
        let headers = Halt::ALL.map(|halt| {
            let (header, request) = line.request();
            assert_eq!((header.session, request), (0, Request::from(halt)));
            header
        });
        line.reply(headers[2], Reply::Done);
        line.reply(session, Reply::Done);
        line.reply(headers[0], Reply::Refused(Refusal::OtherPort));
        line.reply(Header::without_session(0), Reply::Refused(Refusal::Session));
        guests.forget(headers[1].sequence);
        line.reply(headers[1], Reply::Done);
        let mut expected = Vec::new();
        for (header, reply) in [
            (session, Reply::Done),
            (Header::without_session(0), Reply::Refused(Refusal::Session)),
            (headers[1], Reply::Done),
        ] {
            packet::encode(header, &FromBoard::Reply(reply), &mut frame).unwrap();
            expected.extend_from_slice(&frame);
        }
        assert_eq!(own(&mut shared, 3), expected);
        let replies = asked.map(|(_, reply)| reply.try_recv().ok());
        let refused = FromBoard::Reply(Reply::Refused(Refusal::OtherPort));
        assert_eq!(replies, [Some(refused), None, Some(FromBoard::Reply(Reply::Done))]);
    }

    /// Garbage without a zero is passed on before it fills the memory, and the end of the port is that of the program.
    #[test]
    fn garbage_and_the_end_of_the_port_reach_the_program() {
        let (mut shared, _guests, mut line) = shared();
        line.stream.write_all(&[1; 3 * MAX_FRAME]).unwrap();
        let mut bytes = [0; 4 * MAX_FRAME];
        let mut received = 0;
        while received == 0 {
            received = shared.receive(&mut bytes).unwrap();
        }
        assert!(received > MAX_FRAME && bytes[..received].iter().all(|byte| *byte == 1), "{received}");
        drop(line);
        let error = loop {
            match shared.receive(&mut bytes) {
                Ok(_) => {}
                Err(error) => break error,
            }
        };
        assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof);
    }
}
