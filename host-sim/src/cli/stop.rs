//! Interruption by Ctrl-C or a signal.

use std::sync::atomic::{AtomicBool, Ordering};

use files::output::remove_unfinished;

/// Exit code of an interrupted program: that of a shell for SIGINT.
pub const EXIT_CODE: u8 = 130;

/// Whether the command writes its partial result before it ends.
static WRITES_PARTIAL_RESULT: AtomicBool = AtomicBool::new(false);
/// Whether the program has been interrupted.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// A command was interrupted and has written its partial result.
#[derive(Debug, thiserror::Error)]
#[error("interrupted after {done} of {asked} {what}")]
pub struct Stopped {
    /// Number of finished parts.
    pub done: usize,
    /// Number of requested parts.
    pub asked: u64,
    /// Plural noun for the parts.
    pub what: &'static str,
}

/// Installs the handler of interrupts. It removes partly written files and ends the program; a command that writes its
/// partial result is only notified at the first interrupt.
pub fn install_handler() {
    // Without a handler an interrupted run leaves temporary files behind, which is acceptable.
    drop(ctrlc::set_handler(|| {
        if WRITES_PARTIAL_RESULT.load(Ordering::SeqCst) && !INTERRUPTED.swap(true, Ordering::SeqCst) {
            return;
        }
        remove_unfinished();
        std::process::exit(i32::from(EXIT_CODE));
    }));
}

/// From now on the command polls [`is_interrupted`] and writes its partial result itself.
pub fn write_partial_result() {
    WRITES_PARTIAL_RESULT.store(true, Ordering::SeqCst);
}

/// Before a motion is started: whether the program has been interrupted.
///
/// # Errors
/// [`Stopped`] if it has been.
pub fn check_before_motion() -> Result<(), Stopped> {
    if is_interrupted() {
        return Err(Stopped { done: 0, asked: 1, what: "motions; it was not started" });
    }
    Ok(())
}

/// The error of a motion that an interrupt has stopped.
pub const MOTION_STOPPED: Stopped =
    Stopped { done: 0, asked: 1, what: "motions; the axes stand, and the rest of the path is discarded" };

/// Whether the program has been interrupted.
#[must_use]
pub fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}
