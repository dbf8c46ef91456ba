//! A client of GDB's remote protocol over the two pipes of a process: `qemu-system-… -gdb stdio`.
//!
//! Only what a test of a chip needs: registers, memory, breakpoints and watchpoints, and a halt.

use std::io::{Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Numbers of registers of an M-profile core, as the target describes them.
pub const SP: u32 = 13;
/// Program counter.
pub const PC: u32 = 15;
/// Status; its lowest nine bits are the number of the exception that runs, 0: none.
pub const XPSR: u32 = 25;

/// An answer has to be there within this time.
const ANSWER: Duration = Duration::from_secs(10);

/// Bytes of memory in one packet: two digits each, well below what QEMU takes, 4 KiB.
const CHUNK: usize = 1024;

/// Where the target is to halt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// Before the instruction at an address.
    Run,
    /// At a write of the word at an address.
    Write,
    /// At a read of it.
    Read,
}

/// Why the target has halted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt {
    /// At a breakpoint, or because it was told to.
    Here,
    /// At a write to this address.
    Write(u32),
    /// At a read from this address.
    Read(u32),
}

/// A target that answers, and its process, which ends with this value.
pub struct Target {
    process: Child,
    orders: ChildStdin,
    answers: Receiver<String>,
}

/// What the target did not do.
#[derive(Debug, PartialEq, Eq)]
pub enum Trouble {
    /// No answer in time.
    Silent,
    /// Its process has ended.
    Ended,
    /// An answer that is none to this order.
    Answer(String),
}

impl Drop for Target {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Target {
    /// Starts the process, which has to halt before the first instruction, and asks how its registers are called.
    ///
    /// # Errors
    /// Where it does not answer.
    ///
    /// # Panics
    /// Where it cannot be started.
    pub fn start(command: &mut Command) -> Result<Self, Trouble> {
        let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = piped.spawn().unwrap_or_else(|error| panic!("{command:?}: {error}"));
        let orders = process.stdin.take().expect("piped");
        let mut output = process.stdout.take().expect("piped");
        let (sender, answers) = channel();
        thread::spawn(move || {
            while let Some(answer) = packet(&mut output) {
                if sender.send(answer).is_err() {
                    break;
                }
            }
        });
        let mut target = Self { process, orders, answers };
        // Single registers can be asked for only after their description.
        target.ask("qXfer:features:read:target.xml:0,ffb")?;
        Ok(target)
    }

    fn send(&mut self, order: &str) -> Result<(), Trouble> {
        let sum = order.bytes().fold(0u8, u8::wrapping_add);
        let sent = write!(self.orders, "${order}#{sum:02x}").and_then(|()| self.orders.flush());
        sent.map_err(|_| Trouble::Ended)
    }

    fn receive(&mut self, within: Duration) -> Result<String, Trouble> {
        let answer = self.answers.recv_timeout(within).map_err(|error| match error {
            RecvTimeoutError::Timeout => Trouble::Silent,
            RecvTimeoutError::Disconnected => Trouble::Ended,
        })?;
        self.orders.write_all(b"+").and_then(|()| self.orders.flush()).map_err(|_| Trouble::Ended)?;
        Ok(answer)
    }

    fn ask(&mut self, order: &str) -> Result<String, Trouble> {
        self.send(order)?;
        self.receive(ANSWER)
    }

    fn tell(&mut self, order: &str) -> Result<(), Trouble> {
        let answer = self.ask(order)?;
        if answer == "OK" { Ok(()) } else { Err(Trouble::Answer(format!("{order}: {answer}"))) }
    }

    /// The value of a register.
    ///
    /// # Errors
    /// Where the target does not give it.
    pub fn register(&mut self, number: u32) -> Result<u32, Trouble> {
        let answer = self.ask(&format!("p{number:x}"))?;
        let bytes = bytes(&answer).and_then(|bytes| bytes.try_into().ok());
        bytes.map(u32::from_le_bytes).ok_or(Trouble::Answer(answer))
    }

    /// Sets a register.
    ///
    /// # Errors
    /// Where the target does not take it.
    pub fn set_register(&mut self, number: u32, value: u32) -> Result<(), Trouble> {
        self.tell(&format!("P{number:x}={}", digits(&value.to_le_bytes())))
    }

    /// So many bytes of memory from an address on.
    ///
    /// # Errors
    /// Where the target does not give them.
    pub fn memory(&mut self, address: u32, length: usize) -> Result<Vec<u8>, Trouble> {
        let mut all = Vec::with_capacity(length);
        for (from, length) in chunks(address, length) {
            let answer = self.ask(&format!("m{from:x},{length:x}"))?;
            match bytes(&answer).filter(|bytes| bytes.len() == length) {
                Some(bytes) => all.extend(bytes),
                None => return Err(Trouble::Answer(answer)),
            }
        }
        Ok(all)
    }

    /// The word at an address, as a load of a program would read it.
    ///
    /// # Errors
    /// Where the target does not give it.
    pub fn word(&mut self, address: u32) -> Result<u32, Trouble> {
        let bytes = self.memory(address, 4)?;
        Ok(bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte)))
    }

    /// Puts bytes into memory from an address on; what is not memory is left out without a word.
    ///
    /// # Errors
    /// Where the target does not take it.
    pub fn set_memory(&mut self, address: u32, bytes: &[u8]) -> Result<(), Trouble> {
        for ((from, length), part) in chunks(address, bytes.len()).zip(bytes.chunks(CHUNK)) {
            self.tell(&format!("M{from:x},{length:x}:{}", digits(part)))?;
        }
        Ok(())
    }

    /// Halts there from now on.
    ///
    /// # Errors
    /// Where the target cannot.
    pub fn watch(&mut self, watch: Watch, address: u32) -> Result<(), Trouble> {
        match watch {
            Watch::Run => self.tell(&format!("Z0,{address:x},2")),
            Watch::Write => self.tell(&format!("Z2,{address:x},4")),
            Watch::Read => self.tell(&format!("Z3,{address:x},4")),
        }
    }

    /// Lets the target run. [`Target::halted`] says when it halts.
    ///
    /// # Errors
    /// Where its process has ended.
    pub fn run(&mut self) -> Result<(), Trouble> {
        self.send("c")
    }

    /// Runs one instruction, with interrupts held back.
    ///
    /// # Errors
    /// Where the target does not halt behind it.
    pub fn step(&mut self) -> Result<(), Trouble> {
        self.send("s")?;
        self.halted(ANSWER)?.map(drop).ok_or(Trouble::Silent)
    }

    /// Why the target has halted; `None` where it still runs after that time.
    ///
    /// # Errors
    /// Where its process has ended, or it answers something else.
    pub fn halted(&mut self, within: Duration) -> Result<Option<Halt>, Trouble> {
        match self.receive(within) {
            Ok(answer) => halt(&answer).map(Some).ok_or(Trouble::Answer(answer)),
            Err(Trouble::Silent) => Ok(None),
            Err(trouble) => Err(trouble),
        }
    }

    /// Halts the target that runs.
    ///
    /// # Errors
    /// Where its process has ended, or it does not halt.
    pub fn stop(&mut self) -> Result<Halt, Trouble> {
        self.orders.write_all(&[3]).and_then(|()| self.orders.flush()).map_err(|_| Trouble::Ended)?;
        self.halted(ANSWER)?.ok_or(Trouble::Silent)
    }
}

/// The text of the next packet, its acknowledgements and check sum left out: a pipe loses nothing.
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

/// The reason in a stop reply: `T05thread:p01.01;rwatch:40023800;`.
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
