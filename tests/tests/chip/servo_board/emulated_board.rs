//! An emulated board of its own for each test.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Variable with the folder of the emulator's sockets (`host-sim/board/src/bench.rs`).
const FOLDER_VARIABLE: &str = "LOST_MOTION_BENCH";

/// One emulated board at a time: each takes a processor.
static ONE_BOARD: Mutex<()> = Mutex::new(());

/// Repetitions of a recording that has lost samples.
const REPETITIONS: usize = 5;

/// Longest wait for a state of the board that it reaches within 1 s of its own time, which a busy computer runs more slowly.
const LONGEST_WAIT: Duration = Duration::from_secs(20);

/// Whether a recording has failed because this computer did not run the program in time.
fn is_lossy(output: &Output) -> bool {
    let message = String::from_utf8_lossy(&output.stderr);
    ["samples were lost on the link", "the board held the path"].iter().any(|part| message.contains(part))
}

/// A folder in which commands are run, with an emulated board that ends with it.
pub struct EmulatedBoard {
    folder: tempfile::TempDir,
    _one: MutexGuard<'static, ()>,
}

impl EmulatedBoard {
    /// A board, not started yet; `None`, with a message, if QEMU is not installed.
    pub fn new() -> Option<Self> {
        let installed = Command::new("qemu-system-arm").arg("--version").stdout(Stdio::null()).status();
        if !installed.is_ok_and(|status| status.success()) {
            eprintln!("qemu-system-arm is not installed: skipped");
            return None;
        }
        // The command finds what is built here.
        let _ = tests::firmware::built("servo");
        let one = ONE_BOARD.lock().unwrap_or_else(PoisonError::into_inner);
        Some(Self { folder: tempfile::tempdir().unwrap(), _one: one })
    }

    /// With the enable switch closed.
    pub fn armed() -> Option<Self> {
        let board = Self::new()?;
        board.succeeds("board bench close-switch");
        Some(board)
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// A file of the repository.
    pub fn file(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name(name)
    }

    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(tests::program::lost_motion());
        command.args(arguments.split_whitespace()).current_dir(self.path());
        // A short path: those of sockets are limited to 107 bytes.
        command.env(FOLDER_VARIABLE, self.path().join("run"));
        command
    }

    pub fn run(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Starts a command without waiting for its end.
    pub fn start(&self, arguments: &str) -> Child {
        self.command(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    }

    /// The same, with its output for the test.
    pub fn start_with_output(&self, arguments: &str) -> Child {
        self.command(arguments).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap()
    }

    /// Runs a command that has to succeed. Returns its output. A recording whose samples the link has lost, or whose path the board
    /// has held, because this computer has not run the program for 20 ms or 0.5 s, is repeated as its user would do.
    pub fn succeeds(&self, arguments: &str) -> String {
        let mut output = self.run(arguments);
        for _ in 0..REPETITIONS {
            if output.status.success() || !is_lossy(&output) {
                break;
            }
            output = self.run(arguments);
        }
        assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// The status once it shows all of these texts. Panics if it does not within [`LONGEST_WAIT`].
    pub fn status_with(&self, shown: &[&str]) -> String {
        let start = Instant::now();
        loop {
            let status = self.succeeds("board status --port bench");
            if shown.iter().all(|shown| status.contains(shown)) {
                return status;
            }
            assert!(start.elapsed() < LONGEST_WAIT, "expected {shown:?}: {status}");
            sleep(Duration::from_millis(100));
        }
    }

    /// Homes both axes and moves them to the start of `bench_travel.toml`, a motion of 7 s. Returns this motion's file.
    pub fn at_start_of_travel(&self) -> String {
        for axis in ["x", "y"] {
            self.succeeds(&format!("board home --port bench --axis {axis}"));
            self.succeeds(&format!(
                "board jog --port bench --axis {axis} --by-mm 91.7 --speed-mm-per-min 6000"
            ));
        }
        Self::file("host-sim/motions/bench_travel.toml").display().to_string()
    }

    /// Runs a command that has to fail with an exit code. Returns its only line of diagnostics.
    pub fn fails(&self, code: i32, arguments: &str) -> String {
        let output = self.run(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments}: {message}");
        assert_eq!(message.lines().count(), 1, "{arguments}: {message}");
        message.trim().to_owned()
    }
}

impl Drop for EmulatedBoard {
    fn drop(&mut self) {
        let _ = self.run("board bench end");
    }
}
