//! A socket beside the lock of a port, at which other programs of this user ask for what needs no session: stop, hold, disable, override, status.
//!
//! A guest sends the packets that it would send at the port, and gets the replies of the board. It gets no session: it can start
//! nothing, and its requests are no sign of life of the program that holds the port.

use std::path::{Path, PathBuf};

use shared::link::message::{FromBoard, Reply, Request};
use shared::link::packet::{self, Frame, Header};
use shared::link::{Receiver, Refusal};

use crate::share::Guests;

/// The socket beside a lock.
pub fn socket_of(lock: &Path) -> PathBuf {
    lock.with_extension("socket")
}

pub use platform::Broker;

#[cfg(unix)]
mod platform {
    use std::fs;
    use std::io::{self, Write};
    use std::os::unix::fs::PermissionsExt;
    use std::os::unix::net::{UnixListener, UnixStream};
    use std::path::{Path, PathBuf};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::mpsc::RecvTimeoutError;
    use std::thread::{self, JoinHandle, sleep};
    use std::time::{Duration, Instant};

    use super::{FromBoard, Guests, Request, answer, received, socket_of};
    use crate::byte_stream::{READ_TIMEOUT, receive};
    use shared::link::Receiver;

    /// Longest wait for a reply of the board: the guest repeats its request then.
    const REPLY_TIMEOUT: Duration = Duration::from_secs(2);

    /// Least time between two questions of a guest: the line belongs to the program that holds the port. Halts do not wait.
    const QUESTION_INTERVAL: Duration = Duration::from_millis(20);

    /// A socket that guests connect to.
    pub struct Broker {
        socket: PathBuf,
        ends: Arc<AtomicBool>,
        listener: Option<JoinHandle<()>>,
    }

    impl Broker {
        /// Listens beside a lock that this program holds.
        ///
        /// # Errors
        /// If the socket cannot be made.
        pub fn start(lock: &Path, guests: Guests) -> io::Result<Self> {
            let socket = socket_of(lock);
            // One that a program has left that was killed: its lock is ours now.
            let _ = fs::remove_file(&socket);
            let listener = UnixListener::bind(&socket)?;
            fs::set_permissions(&socket, fs::Permissions::from_mode(0o600))?;
            let ends = Arc::new(AtomicBool::new(false));
            let ended = Arc::clone(&ends);
            let listener = thread::spawn(move || {
                for stream in listener.incoming() {
                    if ended.load(Ordering::SeqCst) {
                        break;
                    }
                    let (guests, ended) = (guests.clone(), Arc::clone(&ended));
                    if let Ok(stream) = stream {
                        // Its failure is that of the guest, who has gone.
                        thread::spawn(move || drop(serve(stream, &guests, &ended)));
                    }
                }
            });
            Ok(Self { socket, ends, listener: Some(listener) })
        }
    }

    impl Drop for Broker {
        fn drop(&mut self) {
            self.ends.store(true, Ordering::SeqCst);
            // Wakes the listener.
            let woken = UnixStream::connect(&self.socket);
            let _ = fs::remove_file(&self.socket);
            if let Some(listener) = self.listener.take().filter(|_| woken.is_ok()) {
                let _ = listener.join();
            }
        }
    }

    /// Serves a guest until it has gone.
    fn serve(mut stream: UnixStream, guests: &Guests, ended: &AtomicBool) -> io::Result<()> {
        stream.set_read_timeout(Some(READ_TIMEOUT))?;
        stream.set_write_timeout(Some(REPLY_TIMEOUT))?;
        let mut receiver = Box::new(Receiver::NEW);
        let mut asked: Option<Instant> = None;
        let mut bytes = [0; 256];
        while !ended.load(Ordering::SeqCst) {
            let count = receive(&mut stream, &mut bytes)?;
            for byte in &bytes[..count] {
                let Some((number, request)) = received(&mut receiver, *byte) else { continue };
                let Some(request) = request else {
                    stream.write_all(&answer(number, &FromBoard::Reply(super::REFUSED)))?;
                    continue;
                };
                if request.halt().is_none() {
                    let since = asked.map_or(QUESTION_INTERVAL, |asked| asked.elapsed());
                    sleep(QUESTION_INTERVAL.saturating_sub(since));
                    asked = Some(Instant::now());
                }
                if let Some(reply) = ask(guests, &request, ended)? {
                    stream.write_all(&answer(number, &reply))?;
                }
            }
        }
        Ok(())
    }

    /// The reply of the board to a request; `None` if there is none in time.
    fn ask(guests: &Guests, request: &Request, ended: &AtomicBool) -> io::Result<Option<FromBoard>> {
        let (number, reply) = guests.ask(request)?;
        let started = Instant::now();
        while started.elapsed() < REPLY_TIMEOUT && !ended.load(Ordering::SeqCst) {
            match reply.recv_timeout(READ_TIMEOUT) {
                Ok(reply) => return Ok(Some(reply)),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        guests.forget(number);
        Ok(None)
    }
}

#[cfg(not(unix))]
mod platform {
    use std::io;
    use std::path::Path;

    use super::Guests;

    /// No socket: another program cannot reach the board here while this one holds its port.
    pub struct Broker;

    impl Broker {
        /// There is none.
        ///
        /// # Errors
        /// Always.
        pub fn start(_lock: &Path, _guests: Guests) -> io::Result<Self> {
            Err(io::ErrorKind::Unsupported.into())
        }
    }
}

/// The answer to a request that needs a session.
#[cfg_attr(not(unix), expect(dead_code, reason = "there are no guests"))]
const REFUSED: Reply = Reply::Refused(Refusal::Session);

/// Takes a byte of a guest. Returns the number of the request that it ends; the request itself if it needs no session.
#[cfg_attr(not(unix), expect(dead_code, reason = "there are no guests"))]
fn received(receiver: &mut Receiver, byte: u8) -> Option<(u32, Option<Request>)> {
    let packet = receiver.push(byte)?.ok()?;
    let request = packet::message::<Request>(packet.message).ok();
    let needs_none = |request: &Request| {
        request.halt().is_some()
            || matches!(
                request,
                Request::Status | Request::FaultHistory | Request::Identify | Request::Override { .. }
            )
    };
    Some((
        packet.header.sequence,
        request.filter(|request| packet.header.session == 0 && needs_none(request)),
    ))
}

/// The frame of a reply to a guest.
#[cfg_attr(not(unix), expect(dead_code, reason = "there are no guests"))]
fn answer(number: u32, reply: &FromBoard) -> Frame {
    let mut frame = Frame::new();
    // It has been in a packet before.
    let _ = packet::encode(Header::without_session(number), reply, &mut frame);
    frame
}
