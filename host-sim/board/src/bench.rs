//! The emulated servo board: QEMU in the background, with a socket for the link and one for the bench.
//!
//! It is started by the first command that uses it, and lives on between commands like a board on a desk. It ends by itself after
//! ten minutes without a byte, or by [`Bench::operate`] with [`END`].

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::error::BoardError;
use crate::port::Port;

/// The emulator's program.
const QEMU: &str = "qemu-system-arm";

/// The emulated chip.
const MACHINE: [&str; 2] = ["-machine", "mps2-an386"];

/// Environment variable with the folder of sockets and log; without it a folder for each user.
pub const FOLDER_VARIABLE: &str = "LOST_MOTION_BENCH";

/// The byte that ends the emulator.
pub const END: u8 = b'q';

/// Names of the sockets in the folder.
const LINK: &str = "link";
const BENCH: &str = "bench";

/// File of the flash in the folder (`firmware/src/servo/flash.rs`).
const FLASH: &str = "flash";

/// Longest wait for the emulator's sockets.
const START_TIMEOUT: Duration = Duration::from_secs(20);

/// Longest wait for the bench to confirm a byte.
const CONFIRM_TIMEOUT: Duration = Duration::from_secs(5);

/// The programs of the emulated board.
#[derive(Clone, Copy, Debug)]
enum Program {
    TwoAxes,
    FourAxes,
}

/// The emulated servo board.
#[derive(Clone, Debug)]
pub struct Bench {
    folder: PathBuf,
}

impl Bench {
    /// The board, started with two axes if it does not run.
    ///
    /// # Errors
    /// [`BoardError::Port`] if QEMU or the board's program is missing, or does not start.
    pub fn start() -> Result<Self, BoardError> {
        Self::started(Program::TwoAxes).map(|(bench, _)| bench)
    }

    /// Starts the board with four axes.
    ///
    /// # Errors
    /// As [`Bench::start`]; also if a board runs already.
    pub fn start_four() -> Result<Self, BoardError> {
        let (bench, is_new) = Self::started(Program::FourAxes)?;
        if is_new { Ok(bench) } else { Err(bench.failed("it runs already: `board bench end` ends it")) }
    }

    /// The board, and whether it was started with this program now.
    fn started(program: Program) -> Result<(Self, bool), BoardError> {
        let bench = Self { folder: folder() };
        fs::create_dir_all(&bench.folder).map_err(|error| bench.failed(&error.to_string()))?;
        // One command starts it, and others wait for that.
        let lock = File::create(bench.folder.join("lock")).and_then(|file| file.lock().map(|()| file));
        let _lock = lock.map_err(|error| bench.failed(&error.to_string()))?;
        let is_new = Port::socket(&bench.bench_socket()).is_err();
        if is_new {
            let path = fs::canonicalize(program.path()?).map_err(|error| bench.failed(&error.to_string()))?;
            bench.spawn(program, &path)?;
        }
        Ok((bench, is_new))
    }

    /// Whether the board runs.
    #[must_use]
    pub fn is_running() -> bool {
        Port::socket(&Self { folder: folder() }.bench_socket()).is_ok()
    }

    /// Erases the flash of the board, which must not run: what was saved is lost.
    ///
    /// # Errors
    /// [`BoardError::Port`] if the file cannot be removed.
    pub fn erase_flash() -> Result<(), BoardError> {
        let bench = Self { folder: folder() };
        match fs::remove_file(bench.folder.join(FLASH)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(bench.failed(&error.to_string())),
            _ => Ok(()),
        }
    }

    /// A connection to the link of the board.
    ///
    /// # Errors
    /// [`BoardError::Port`].
    pub fn link(&self) -> Result<Port, BoardError> {
        Port::socket(&self.link_socket()).map_err(|error| self.failed(&error.to_string()))
    }

    /// Operates a switch of the simulated machine: see `firmware/src/servo/bench_port.rs`.
    ///
    /// # Errors
    /// [`BoardError`] if the bench does not confirm it.
    pub fn operate(&self, byte: u8) -> Result<(), BoardError> {
        let mut port = Port::socket(&self.bench_socket()).map_err(|error| self.failed(&error.to_string()))?;
        port.send(&[byte])?;
        let started = Instant::now();
        let mut reply = [0];
        while started.elapsed() < CONFIRM_TIMEOUT {
            match port.receive(&mut reply) {
                Ok(1) if reply[0] == byte => return Ok(()),
                Ok(1) => return Err(BoardError::Unexpected),
                Ok(_) => {}
                Err(_) if byte == END => return self.wait_for_the_end(started),
                Err(error) => return Err(error.into()),
            }
        }
        Err(BoardError::Silent { seconds: CONFIRM_TIMEOUT.as_secs_f64() })
    }

    /// Waits until the process of the emulator has ended, after its connections: until then its sockets can be connected to.
    fn wait_for_the_end(&self, started: Instant) -> Result<(), BoardError> {
        while started.elapsed() < CONFIRM_TIMEOUT {
            if Port::socket(&self.bench_socket()).is_err() {
                return Ok(());
            }
            thread::sleep(Duration::from_millis(20));
        }
        Err(BoardError::Silent { seconds: CONFIRM_TIMEOUT.as_secs_f64() })
    }

    /// The file of the lock of the link.
    #[must_use]
    pub fn link_lock(&self) -> PathBuf {
        self.folder.join("link.lock")
    }

    fn link_socket(&self) -> PathBuf {
        self.folder.join(LINK)
    }

    fn bench_socket(&self) -> PathBuf {
        self.folder.join(BENCH)
    }

    fn spawn(&self, program: Program, path: &Path) -> Result<(), BoardError> {
        let socket = |name: &str| format!("unix:{name},server=on,wait=off");
        let log = File::create(self.folder.join("log")).map_err(|error| self.failed(&error.to_string()))?;
        let mut command = Command::new(QEMU);
        command
            .args(MACHINE)
            .args(program.clock())
            .args(["-display", "none", "-monitor", "none", "-no-reboot"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .args(["-serial", &socket(LINK), "-serial", &socket(BENCH)])
            .arg("-kernel")
            .arg(path)
            // Its sockets, and the file of its flash.
            .current_dir(&self.folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(log);
        // Not ended with the terminal of this command.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(|error| {
            self.failed(&match error.kind() {
                io::ErrorKind::NotFound => {
                    format!("{QEMU} is not installed (Debian package qemu-system-arm)")
                }
                _ => format!("{QEMU} cannot be started: {error}"),
            })
        })?;
        let started = Instant::now();
        while started.elapsed() < START_TIMEOUT {
            if Port::socket(&self.bench_socket()).is_ok() && self.link_socket().exists() {
                return Ok(());
            }
            if let Ok(Some(_)) = child.try_wait() {
                break;
            }
            thread::sleep(Duration::from_millis(20));
        }
        let log = fs::read_to_string(self.folder.join("log")).unwrap_or_default();
        Err(self.failed(&format!("{QEMU} has ended: {}", log.lines().last().unwrap_or("without a message"))))
    }

    fn failed(&self, problem: &str) -> BoardError {
        BoardError::Port(format!("bench ({}): {problem}", self.folder.display()))
    }
}

/// The folder of sockets, locks and log.
#[must_use]
pub fn folder() -> PathBuf {
    if let Some(folder) = std::env::var_os(FOLDER_VARIABLE) {
        return folder.into();
    }
    if let Some(folder) = std::env::var_os("XDG_RUNTIME_DIR") {
        return Path::new(&folder).join("lost-motion-bench");
    }
    let user = std::env::var("USER").unwrap_or_else(|_| "user".to_owned());
    std::env::temp_dir().join(format!("lost-motion-bench-{user}"))
}

impl Program {
    /// An instruction takes 4 ns of the emulated clock, so that a tick has 12,500; with four axes, whose controller and simulated machine
    /// take more, 2 ns and 25,000. The clock does not run ahead of the host's.
    const fn clock(self) -> [&'static str; 2] {
        match self {
            Self::TwoAxes => ["-icount", "shift=2,align=on"],
            Self::FourAxes => ["-icount", "shift=1,align=on"],
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::TwoAxes => "servo",
            Self::FourAxes => "servo-four",
        }
    }

    /// Its file: beside this program, or in the target folder of its workspace. It is not built here: that takes minutes.
    fn path(self) -> Result<PathBuf, BoardError> {
        let name = self.name();
        let in_target = Path::new("thumbv7em-none-eabihf/firmware").join(name);
        let this_program = std::env::current_exe().ok();
        let beside = this_program.iter().filter_map(|program| Some(program.parent()?.join(name)));
        let above = this_program.iter().flat_map(|program| program.ancestors().skip(1));
        let targets = above.map(|up| up.join(&in_target));
        let workspace = workspace();
        let target =
            std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
        let mut candidates = beside.chain(targets).chain(std::iter::once(target.join(&in_target)));
        candidates.find(|path| path.is_file()).ok_or_else(|| {
            let folder = workspace.display();
            BoardError::Port(format!(
                "bench: the program of the emulated board is missing: build it with `cargo servo` in {folder} (once, some minutes)"
            ))
        })
    }
}

/// The folder of the workspace that this program was built from.
fn workspace() -> PathBuf {
    const THIS_CRATE: &str = env!("CARGO_MANIFEST_DIR");
    PathBuf::from(THIS_CRATE.strip_suffix("host-sim/board").unwrap_or(THIS_CRATE))
}
