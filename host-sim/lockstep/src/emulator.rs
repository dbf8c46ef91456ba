//! The connection to a core emulated by QEMU, by the pipes of the emulator's process.
//!
//! The emulated program reads frames from standard input and writes answers to standard output through semihosting. Its clock
//! is its count of instructions, so that results do not depend on the speed of this computer.
//!
//! Emulator and host run alternately. A run is about 40 % faster if both run on one processor (`taskset -c 0 lost-motion
//! record …`). Pinning only the emulator has no effect, and pinning the calling process is left to the user.

use std::ffi::OsStr;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use shared::lockstep::protocol::FRAME;

use super::remote::{Connection, Frame};

/// The emulator's program.
const QEMU: &str = "qemu-system-arm";

/// The emulated board. An instruction takes 2¹⁰ ns of the emulated clock; the program's instruction counter divides by this.
const MACHINE: &[&str] = &["-machine", "mps2-an386", "-icount", "shift=10"];

/// No window, monitor or serial port; the process ends instead of rebooting.
const PIPES_ONLY: &[&str] = &["-display", "none", "-monitor", "none", "-serial", "none", "-no-reboot"];

/// Standard input and output of the emulated program are those of the emulator.
const SEMIHOSTING: &[&str] = &["-semihosting-config", "enable=on,target=native"];

/// Default of the maximum time for an answer. A tick takes about 1 ms, the start of the emulator on a loaded computer 1 to
/// 2 s.
pub const DEFAULT_TIMEOUT: Duration = Duration::from_secs(10);

/// A running emulator; dropping it ends the process.
#[derive(Debug)]
pub struct Emulator {
    child: Child,
    stdin: ChildStdin,
    /// Answers from the thread that reads standard output; disconnected when this thread ends.
    answers: Receiver<Frame>,
    /// Maximum time for an answer.
    timeout: Duration,
    /// The thread that reads standard error; its result is the line with the reason why the emulator ended.
    last_error: Option<JoinHandle<String>>,
}

/// The path at which `cargo emulated` builds its program.
#[must_use]
pub fn default_program() -> PathBuf {
    const THIS_CRATE: &str = env!("CARGO_MANIFEST_DIR");
    let workspace = Path::new(THIS_CRATE.strip_suffix("host-sim/lockstep").unwrap_or(THIS_CRATE));
    let built = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
    built.join("thumbv7em-none-eabihf/firmware/emulated")
}

impl Emulator {
    /// Starts the emulator with a program; `timeout` is the maximum time for each answer.
    ///
    /// # Errors
    /// A message of one line, if the program or the emulator is missing, or the emulator does not start.
    pub fn start(program: &Path, timeout: Duration) -> Result<Self, String> {
        if !program.is_file() {
            return Err(format!("{}: no such program, build it with `cargo emulated`", program.display()));
        }
        let Some(qemu) = installed(QEMU) else {
            return Err(format!("{QEMU} is not installed (Debian package qemu-system-arm)"));
        };
        Self::spawn(
            Command::new(qemu).args(MACHINE).args(PIPES_ONLY).args(SEMIHOSTING).arg("-kernel").arg(program),
            timeout,
        )
        .map_err(|error| format!("{QEMU} cannot be started: {error}"))
    }

    fn spawn(command: &mut Command, timeout: Duration) -> io::Result<Self> {
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let (Some(stdin), Some(stdout), Some(stderr)) = pipes else {
            return Err(io::Error::other("its standard streams are not available"));
        };
        // Standard error is read continuously, so that a full pipe does not block the emulator.
        let last_error = thread::spawn(move || last_line(stderr));
        // A read from a pipe has no timeout, but receiving from a thread that reads has.
        let (sender, answers) = sync_channel(1);
        thread::spawn(move || forward_frames(stdout, &sender));
        Ok(Self { child, stdin, answers, timeout, last_error: Some(last_error) })
    }

    /// Ends the emulator after a timeout; returns the error message.
    fn timeout_error(&mut self) -> String {
        let _ = self.child.kill();
        let _ = self.child.wait();
        format!(
            "the emulator has not answered for {} s and was ended; check that its program is the one of `cargo emulated` \
             in this version, and that this computer is not overloaded",
            self.timeout.as_secs_f64()
        )
    }

    /// The error message after the emulator has ended by itself.
    fn exit_error(&mut self) -> String {
        // The pipes are closed, but the process may still be running.
        let _ = self.child.kill();
        let _ = self.child.wait();
        let reason = self.last_error.take().and_then(|reader| reader.join().ok()).unwrap_or_default();
        if reason.is_empty() {
            "the emulator has ended".to_owned()
        } else {
            format!("the emulator has ended: {reason}")
        }
    }
}

impl Connection for Emulator {
    fn exchange(&mut self, frame: &mut Frame) -> Result<(), String> {
        // Does not block: the capacity of the pipe is many frames, and at most one is in transit.
        self.stdin.write_all(frame).map_err(|_| self.exit_error())?;
        match self.answers.recv_timeout(self.timeout) {
            Ok(answer) => {
                *frame = answer;
                Ok(())
            }
            Err(RecvTimeoutError::Timeout) => Err(self.timeout_error()),
            Err(RecvTimeoutError::Disconnected) => Err(self.exit_error()),
        }
    }
}

/// Sends complete frames until the output ends or the receiver is dropped.
fn forward_frames(mut stdout: ChildStdout, to: &SyncSender<Frame>) {
    let mut frame = [0; FRAME];
    while stdout.read_exact(&mut frame).is_ok() && to.send(frame).is_ok() {}
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The path of a program that is in one of the folders of `PATH`.
fn installed(program: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join(OsStr::new(program))).find(|path| path.is_file())
}

/// Reads to the end; returns the last line that begins with `qemu`, otherwise the last line that is not empty. QEMU may print
/// registers after its message.
fn last_line(stderr: ChildStderr) -> String {
    let (mut own, mut last) = (None, String::new());
    for line in BufReader::new(stderr).split(b'\n').map_while(Result::ok) {
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
        Emulator::spawn(Command::new("sh").args(["-c", script]), DEFAULT_TIMEOUT).unwrap()
    }

    /// The child echoes `frames` frames and then only reads.
    fn times_out_after(frames: usize) {
        // Long enough for a shell to start on a loaded computer.
        let timeout = Duration::from_millis(1500);
        // The output stays open as descriptor 3; a closed output would be taken for the end of the process.
        let echo = format!("dd bs={FRAME} count={frames} 2>/dev/null");
        let script = format!("{echo}; exec cat 3>&1 >/dev/null");
        let mut child = Emulator::spawn(Command::new("sh").args(["-c", &script]), timeout).unwrap();
        for _ in 0..frames {
            child.exchange(&mut [7; FRAME]).unwrap();
        }
        let started = Instant::now();
        let message = child.exchange(&mut [7; FRAME]).unwrap_err();
        let waited = started.elapsed();
        assert!(
            message.starts_with("the emulator has not answered for 1.5 s and was ended; check"),
            "{message}"
        );
        assert!(!message.contains('\n'), "{message}");
        // Ending the process takes milliseconds, more on a loaded computer.
        assert!(waited >= timeout && waited < timeout + Duration::from_secs(5), "{waited:?}");
        assert!(child.child.try_wait().unwrap().is_some(), "the process is still running");
        // The next exchange fails without waiting.
        let again = Instant::now();
        assert_eq!(child.exchange(&mut [7; FRAME]).unwrap_err(), "the emulator has ended");
        assert!(again.elapsed() < timeout);
    }

    #[test]
    fn a_child_that_never_answers_times_out() {
        times_out_after(0);
    }

    #[test]
    fn a_child_that_stops_answering_times_out() {
        times_out_after(3);
    }

    #[test]
    fn a_child_that_ends_is_an_error_with_its_last_line() {
        let mut child = shell("echo first >&2; echo could not load kernel >&2; exit 1");
        let mut frame = [0; 256];
        assert_eq!(child.exchange(&mut frame).unwrap_err(), "the emulator has ended: could not load kernel");
        // The reason is reported only once.
        assert_eq!(child.exchange(&mut frame).unwrap_err(), "the emulator has ended");
    }

    #[test]
    fn registers_do_not_hide_the_reason() {
        let mut child = shell("printf 'qemu: fatal: Lockup\n\nR00=00000000\n' >&2");
        assert_eq!(child.exchange(&mut [0; 256]).unwrap_err(), "the emulator has ended: qemu: fatal: Lockup");
    }

    #[test]
    fn programs_are_found_in_the_folders_of_path() {
        assert!(installed("sh").is_some());
        assert_eq!(installed("no-program-of-this-name"), None);
    }

    #[test]
    fn a_child_that_ends_within_an_answer_is_an_error() {
        let mut child = shell("head -c 100; exit 0");
        assert_eq!(child.exchange(&mut [0; 256]).unwrap_err(), "the emulator has ended");
    }

    #[test]
    fn an_echoed_frame_is_unchanged() {
        let mut child = shell("cat");
        let mut frame = core::array::from_fn(|i| u8::try_from(i).unwrap());
        let sent = frame;
        child.exchange(&mut frame).unwrap();
        assert_eq!(frame, sent);
    }

    #[test]
    fn the_default_program_is_at_the_path_of_cargo_emulated() {
        assert!(default_program().ends_with("thumbv7em-none-eabihf/firmware/emulated"));
    }
}
