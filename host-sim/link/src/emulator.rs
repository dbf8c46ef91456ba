//! A core that QEMU emulates, at the end of two pipes.
//!
//! The program reads frames from the emulator's standard input and writes answers to its standard
//! output through semihosting. It runs as fast as it can; its clock is its own count of
//! instructions, so that nothing depends on the speed of this computer.
//!
//! Emulator and host take turns. A run is about 40 % faster where one core does both (`taskset -c 0
//! lost-motion record …`); pinning the emulator alone gains nothing, and pinning this process is not a
//! library's to decide.

use std::ffi::OsStr;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use shared::protocol::FRAME;

use super::remote::{Connection, Frame};

const QEMU: &str = "qemu-system-arm";

/// 2¹⁰ ns of the emulated clock for an instruction; the program's meter divides by that.
const MACHINE: &[&str] = &["-machine", "mps2-an386", "-icount", "shift=10"];

const PIPES_ONLY: &[&str] = &["-display", "none", "-monitor", "none", "-serial", "none", "-no-reboot"];

const SEMIHOSTING: &[&str] = &["-semihosting-config", "enable=on,target=native"];

/// How long an answer may take where nothing else is asked for: a tick takes a millisecond, the start of the emulator on
/// a busy computer a second or two.
pub const PATIENCE: Duration = Duration::from_secs(10);

/// A running emulator. It ends with this value.
#[derive(Debug)]
pub struct Emulator {
    child: Child,
    orders: ChildStdin,
    /// From the thread that reads the program's output; closed where that has ended.
    answers: Receiver<Frame>,
    /// How long an answer may take.
    patience: Duration,
    /// Gives the last line of what the emulator complained of, once it has ended.
    complaint: Option<JoinHandle<String>>,
}

/// Where `cargo emulated` puts its program.
#[must_use]
pub fn default_program() -> PathBuf {
    const THIS_CRATE: &str = env!("CARGO_MANIFEST_DIR");
    let workspace = Path::new(THIS_CRATE.strip_suffix("host-sim/link").unwrap_or(THIS_CRATE));
    let built = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
    built.join("thumbv7em-none-eabihf/firmware/emulated")
}

impl Emulator {
    /// Starts the emulator on a program whose answers may each take as long as `patience`.
    ///
    /// # Errors
    /// One line: the program or the emulator is missing, or the system does not start it.
    pub fn start(program: &Path, patience: Duration) -> Result<Self, String> {
        if !program.is_file() {
            return Err(format!("{}: no such program, build it with `cargo emulated`", program.display()));
        }
        let Some(qemu) = installed(QEMU) else {
            return Err(format!("{QEMU} is not installed (Debian package qemu-system-arm)"));
        };
        Self::spawn(
            Command::new(qemu).args(MACHINE).args(PIPES_ONLY).args(SEMIHOSTING).arg("-kernel").arg(program),
            patience,
        )
        .map_err(|error| format!("{QEMU} cannot be started: {error}"))
    }

    fn spawn(command: &mut Command, patience: Duration) -> io::Result<Self> {
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let (Some(orders), Some(answers), Some(complaints)) = pipes else {
            return Err(io::Error::other("no pipe to it"));
        };
        // Read all the time, so that a talkative emulator does not block.
        let complaint = thread::spawn(move || last_line(complaints));
        // A read from a pipe waits for ever; only a thread of its own can be given up.
        let (sender, frames) = sync_channel(1);
        thread::spawn(move || pass_on(answers, &sender));
        Ok(Self { child, orders, answers: frames, patience, complaint: Some(complaint) })
    }

    /// Ends the emulator, which has not answered in time; says so.
    fn give_up(&mut self) -> String {
        let _ = self.child.kill();
        let _ = self.child.wait();
        format!(
            "the emulator has not answered for {} s and was ended; check that its program is the one of `cargo emulated` \
             in this version, and that this computer is not overloaded",
            self.patience.as_secs_f64()
        )
    }

    /// Why the emulator is gone.
    fn epitaph(&mut self) -> String {
        // It may still be on its way out; its pipes are closed already.
        let _ = self.child.kill();
        let _ = self.child.wait();
        let said = self.complaint.take().and_then(|reader| reader.join().ok()).unwrap_or_default();
        if said.is_empty() {
            "the emulator has ended".to_owned()
        } else {
            format!("the emulator has ended: {said}")
        }
    }
}

impl Connection for Emulator {
    fn exchange(&mut self, frame: &mut Frame) -> Result<(), String> {
        // The pipe holds many frames and one is under way at most: this does not wait.
        self.orders.write_all(frame).map_err(|_| self.epitaph())?;
        match self.answers.recv_timeout(self.patience) {
            Ok(answer) => {
                *frame = answer;
                Ok(())
            }
            Err(RecvTimeoutError::Timeout) => Err(self.give_up()),
            Err(RecvTimeoutError::Disconnected) => Err(self.epitaph()),
        }
    }
}

/// Passes whole frames on until there are no more, or nobody takes them.
fn pass_on(mut answers: ChildStdout, to: &SyncSender<Frame>) {
    let mut frame = [0; FRAME];
    while answers.read_exact(&mut frame).is_ok() && to.send(frame).is_ok() {}
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The path of an installed program.
fn installed(program: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join(OsStr::new(program))).find(|path| path.is_file())
}

/// The last line in QEMU's own name, else the last that is not empty; read to the end.
///
/// Behind a line of its own, QEMU may print the registers.
fn last_line(from: ChildStderr) -> String {
    let (mut own, mut last) = (None, String::new());
    for line in BufReader::new(from).split(b'\n').map_while(Result::ok) {
        let line = String::from_utf8_lossy(&line).trim().replace(char::is_control, "?");
        if line.starts_with("qemu") {
            own = Some(line.clone());
        }
        if !line.is_empty() {
            last = line;
        }
    }
    own.unwrap_or(last)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    fn shell(script: &str) -> Emulator {
        Emulator::spawn(Command::new("sh").args(["-c", script]), PATIENCE).unwrap()
    }

    /// A child answers `frames` frames with themselves and then only reads.
    fn falls_silent_after(frames: usize) {
        // Long enough for a shell to start on a busy computer.
        let patience = Duration::from_millis(1500);
        // Its output stays open in 3, as an end of it would say that the child has ended.
        let answer = format!("dd bs={FRAME} count={frames} 2>/dev/null");
        let script = format!("{answer}; exec cat 3>&1 >/dev/null");
        let mut child = Emulator::spawn(Command::new("sh").args(["-c", &script]), patience).unwrap();
        for _ in 0..frames {
            child.exchange(&mut [7; FRAME]).unwrap();
        }
        let asked = Instant::now();
        let said = child.exchange(&mut [7; FRAME]).unwrap_err();
        let waited = asked.elapsed();
        assert!(said.starts_with("the emulator has not answered for 1.5 s and was ended; check"), "{said}");
        assert!(!said.contains('\n'), "{said}");
        // No sooner than it was told, and not much later: killing takes milliseconds, a busy computer some more.
        assert!(waited >= patience && waited < patience + Duration::from_secs(5), "{waited:?}");
        assert!(child.child.try_wait().unwrap().is_some(), "it still runs");
        // Asked again, it is gone, and nobody waits.
        let again = Instant::now();
        assert_eq!(child.exchange(&mut [7; FRAME]).unwrap_err(), "the emulator has ended");
        assert!(again.elapsed() < patience);
    }

    #[test]
    fn a_child_that_never_answers_is_given_up() {
        falls_silent_after(0);
    }

    #[test]
    fn so_is_one_that_no_longer_does() {
        falls_silent_after(3);
    }

    #[test]
    fn a_child_that_ends_is_an_error_with_its_last_line() {
        let mut child = shell("echo first >&2; echo could not load kernel >&2; exit 1");
        let mut frame = [0; 256];
        assert_eq!(child.exchange(&mut frame).unwrap_err(), "the emulator has ended: could not load kernel");
        // Asked again, it says the same without the words, which have been told.
        assert_eq!(child.exchange(&mut frame).unwrap_err(), "the emulator has ended");
    }

    #[test]
    fn registers_do_not_hide_the_reason() {
        let mut child = shell("printf 'qemu: fatal: Lockup\n\nR00=00000000\n' >&2");
        assert_eq!(child.exchange(&mut [0; 256]).unwrap_err(), "the emulator has ended: qemu: fatal: Lockup");
    }

    #[test]
    fn programs_are_found_as_a_shell_finds_them() {
        assert!(installed("sh").is_some());
        assert_eq!(installed("no-program-of-this-name"), None);
    }

    #[test]
    fn a_child_that_ends_within_an_answer_is_an_error() {
        let mut child = shell("head -c 100; exit 0");
        assert_eq!(child.exchange(&mut [0; 256]).unwrap_err(), "the emulator has ended");
    }

    #[test]
    fn a_frame_goes_there_and_back() {
        let mut child = shell("cat");
        let mut frame = core::array::from_fn(|i| u8::try_from(i).unwrap());
        let sent = frame;
        child.exchange(&mut frame).unwrap();
        assert_eq!(frame, sent);
    }

    #[test]
    fn the_default_program_lies_where_cargo_builds_it() {
        assert!(default_program().ends_with("thumbv7em-none-eabihf/firmware/emulated"));
    }
}
