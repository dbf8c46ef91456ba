//! A client of GDB's remote serial protocol over stdin and stdout of a process: `qemu-system-… -gdb stdio`.
//!
//! It has the requests that a test of a chip needs: registers, memory, breakpoints, watchpoints, run, step and halt.

use std::io::{Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Stack pointer: its register number in QEMU's target description of an M-profile core.
pub const SP: u32 = 13;
/// Program counter.
pub const PC: u32 = 15;
/// Program status; its lowest nine bits are the number of the active exception, 0: none.
pub const XPSR: u32 = 25;

/// Timeout of a reply.
const REPLY_TIMEOUT: Duration = Duration::from_secs(10);

/// Bytes of memory in one packet: two digits each, well below QEMU's limit of 4 KiB.
const CHUNK: usize = 1024;

/// A breakpoint or watchpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// Before the instruction at an address.
    Run,
    /// At a write to the word at an address.
    Write,
    /// At a read from the word at an address.
    Read,
}

impl Watch {
    /// Its kind, address and size in a request.
    fn at(self, address: u32) -> String {
        match self {
            Self::Run => format!("0,{address:x},2"),
            Self::Write => format!("2,{address:x},4"),
            Self::Read => format!("3,{address:x},4"),
        }
    }
}

/// Why the target has halted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt {
    /// At a breakpoint, or on request.
    Here,
    /// At a write to this address.
    Write(u32),
    /// At a read from this address.
    Read(u32),
}

/// A target and its process, which is killed when this value is dropped.
pub struct Target {
    process: Child,
    requests: ChildStdin,
    replies: Receiver<String>,
}

/// Why a request failed.
#[derive(Debug, PartialEq, Eq)]
pub enum GdbError {
    /// No reply in time.
    Timeout,
    /// Its process has ended.
    Ended,
    /// A reply that does not belong to the request.
    Reply(String),
}

impl Drop for Target {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Target {
    /// Starts the process, which must halt before the first instruction, and reads its target description.
    ///
    /// # Errors
    /// Where it does not reply.
    ///
    /// # Panics
    /// Where it cannot be started.
    pub fn start(command: &mut Command) -> Result<Self, GdbError> {
        let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = piped.spawn().unwrap_or_else(|error| panic!("{command:?}: {error}"));
        let requests = process.stdin.take().expect("piped");
        let mut output = process.stdout.take().expect("piped");
        let (sender, replies) = channel();
        thread::spawn(move || {
            while let Some(reply) = packet(&mut output) {
                if sender.send(reply).is_err() {
                    break;
                }
            }
        });
        let mut target = Self { process, requests, replies };
        // QEMU gives single registers only after their description was read.
        target.request("qXfer:features:read:target.xml:0,ffb")?;
        Ok(target)
    }

    fn send(&mut self, request: &str) -> Result<(), GdbError> {
        let sum = request.bytes().fold(0u8, u8::wrapping_add);
        let sent = write!(self.requests, "${request}#{sum:02x}").and_then(|()| self.requests.flush());
        sent.map_err(|_| GdbError::Ended)
    }

    fn receive(&mut self, timeout: Duration) -> Result<String, GdbError> {
        let reply = self.replies.recv_timeout(timeout).map_err(|error| match error {
            RecvTimeoutError::Timeout => GdbError::Timeout,
            RecvTimeoutError::Disconnected => GdbError::Ended,
        })?;
        self.requests.write_all(b"+").and_then(|()| self.requests.flush()).map_err(|_| GdbError::Ended)?;
        Ok(reply)
    }

    fn request(&mut self, request: &str) -> Result<String, GdbError> {
        self.send(request)?;
        self.receive(REPLY_TIMEOUT)
    }

    fn command(&mut self, request: &str) -> Result<(), GdbError> {
        let reply = self.request(request)?;
        if reply == "OK" { Ok(()) } else { Err(GdbError::Reply(format!("{request}: {reply}"))) }
    }

    /// The value of a register.
    ///
    /// # Errors
    /// Where the target refuses.
    pub fn register(&mut self, number: u32) -> Result<u32, GdbError> {
        let reply = self.request(&format!("p{number:x}"))?;
        let bytes = bytes(&reply).and_then(|bytes| bytes.try_into().ok());
        bytes.map(u32::from_le_bytes).ok_or(GdbError::Reply(reply))
    }

    /// Sets a register.
    ///
    /// # Errors
    /// Where the target refuses.
    pub fn set_register(&mut self, number: u32, value: u32) -> Result<(), GdbError> {
        self.command(&format!("P{number:x}={}", digits(&value.to_le_bytes())))
    }

    /// Bytes of memory from an address on.
    ///
    /// # Errors
    /// Where the target refuses.
    pub fn memory(&mut self, address: u32, length: usize) -> Result<Vec<u8>, GdbError> {
        let mut all = Vec::with_capacity(length);
        for (from, length) in chunks(address, length) {
            let reply = self.request(&format!("m{from:x},{length:x}"))?;
            match bytes(&reply).filter(|bytes| bytes.len() == length) {
                Some(bytes) => all.extend(bytes),
                None => return Err(GdbError::Reply(reply)),
            }
        }
        Ok(all)
    }

    /// The word at an address, little-endian.
    ///
    /// # Errors
    /// Where the target refuses.
    pub fn word(&mut self, address: u32) -> Result<u32, GdbError> {
        let bytes = self.memory(address, 4)?;
        Ok(bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte)))
    }

    /// Writes bytes to memory from an address on. QEMU ignores addresses without memory.
    ///
    /// # Errors
    /// Where the target refuses.
    pub fn set_memory(&mut self, address: u32, bytes: &[u8]) -> Result<(), GdbError> {
        for ((from, length), part) in chunks(address, bytes.len()).zip(bytes.chunks(CHUNK)) {
            self.command(&format!("M{from:x},{length:x}:{}", digits(part)))?;
        }
        Ok(())
    }

    /// Sets a breakpoint or watchpoint.
    ///
    /// # Errors
    /// Where the target refuses.
    pub fn watch(&mut self, watch: Watch, address: u32) -> Result<(), GdbError> {
        self.command(&format!("Z{}", watch.at(address)))
    }

    /// Removes a breakpoint or watchpoint.
    ///
    /// # Errors
    /// Where the target refuses.
    pub fn unwatch(&mut self, watch: Watch, address: u32) -> Result<(), GdbError> {
        self.command(&format!("z{}", watch.at(address)))
    }

    /// Lets the target run, until [`Target::halted`] reports a halt.
    ///
    /// # Errors
    /// Where its process has ended.
    pub fn run(&mut self) -> Result<(), GdbError> {
        self.send("c")
    }

    /// Runs one instruction with interrupts masked.
    ///
    /// # Errors
    /// Where the target does not halt after it.
    pub fn step(&mut self) -> Result<(), GdbError> {
        self.send("s")?;
        self.halted(REPLY_TIMEOUT)?.map(drop).ok_or(GdbError::Timeout)
    }

    /// Why the target has halted; `None` where it still runs after the timeout.
    ///
    /// # Errors
    /// Where its process has ended, or its reply is not a halt.
    pub fn halted(&mut self, timeout: Duration) -> Result<Option<Halt>, GdbError> {
        match self.receive(timeout) {
            Ok(reply) => halt(&reply).map(Some).ok_or(GdbError::Reply(reply)),
            Err(GdbError::Timeout) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Halts the running target.
    ///
    /// # Errors
    /// Where its process has ended, or it does not halt.
    pub fn stop(&mut self) -> Result<Halt, GdbError> {
        self.requests.write_all(&[3]).and_then(|()| self.requests.flush()).map_err(|_| GdbError::Ended)?;
        self.halted(REPLY_TIMEOUT)?.ok_or(GdbError::Timeout)
    }
}

/// The text of the next packet, without acknowledgements and checksum: a pipe loses nothing.
fn packet(output: &mut ChildStdout) -> Option<String> {
    let mut next = || {
        let mut byte = [0];
        output.read_exact(&mut byte).ok().map(|()| char::from(byte[0]))
    };
    while next()? != '$' {}
    let mut text = String::new();
    loop {
        match next()? {
            '#' => break,
            letter => text.push(letter),
        }
    }
    next()?;
    next()?;
    Some(text)
}

/// The reason in a stop reply, for example `T05thread:p01.01;rwatch:40023800;`.
fn halt(reply: &str) -> Option<Halt> {
    let fields = reply.strip_prefix('T')?.get(2..)?;
    for field in fields.split(';') {
        let at = |text: &str| u32::from_str_radix(text, 16).ok();
        match field.split_once(':') {
            Some(("watch", address)) => return at(address).map(Halt::Write),
            Some(("rwatch", address)) => return at(address).map(Halt::Read),
            _ => {}
        }
    }
    Some(Halt::Here)
}

fn chunks(address: u32, length: usize) -> impl Iterator<Item = (u32, usize)> {
    let offset = |offset| u32::try_from(offset).expect("within 32 bits");
    (0..length).step_by(CHUNK).map(move |from| (address + offset(from), CHUNK.min(length - from)))
}

fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn bytes(digits: &str) -> Option<Vec<u8>> {
    let byte = |at: usize| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok();
    (0..digits.len()).step_by(2).map(byte).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stop_replies_of_the_protocol() {
        assert_eq!(halt("T05thread:p01.01;rwatch:40023800;"), Some(Halt::Read(0x4002_3800)));
        assert_eq!(halt("T05thread:p01.01;watch:40023808;"), Some(Halt::Write(0x4002_3808)));
        assert_eq!(halt("T02thread:p01.01;"), Some(Halt::Here));
        assert_eq!(halt("E22"), None);
        assert_eq!(halt("W00"), None);
    }

    #[test]
    fn bytes_and_their_digits() {
        assert_eq!(digits(&[0, 0xa5, 0xff]), "00a5ff");
        assert_eq!(bytes("00a5ff"), Some(vec![0, 0xa5, 0xff]));
        assert_eq!((bytes("0"), bytes("zz")), (None, None));
        let all: Vec<_> = chunks(0x100, 2 * CHUNK + 3).collect();
        assert_eq!(all, [(0x100, CHUNK), (0x500, CHUNK), (0x900, 3)]);
    }
}
