//! Being told to end, by Ctrl-C or a signal.

use std::sync::atomic::{AtomicBool, Ordering};

use files::output::remove_unfinished;

/// What a shell says of a program that a signal has ended, for SIGINT.
pub const BROKEN_OFF: u8 = 130;

/// Whether the command writes what it has before it ends.
static WRITES_FIRST: AtomicBool = AtomicBool::new(false);
/// Whether it has been told to end.
static ASKED: AtomicBool = AtomicBool::new(false);

/// A command was told to end, and has written what it had.
#[derive(Debug, thiserror::Error)]
#[error("broken off after {done} of {asked} {what}")]
pub struct Stopped {
    /// Parts that are done.
    pub done: usize,
    /// Parts that were asked for.
    pub asked: u64,
    /// What the parts are.
    pub what: &'static str,
}

/// Ends the program when it is told to, with nothing half-written; a command that writes first is asked once.
pub fn listen() {
    // Without it a run that is broken off leaves half a file behind; that it cannot be had is no reason not to run.
    drop(ctrlc::set_handler(|| {
        if WRITES_FIRST.load(Ordering::SeqCst) && !ASKED.swap(true, Ordering::SeqCst) {
            return;
        }
        remove_unfinished();
        std::process::exit(i32::from(BROKEN_OFF));
    }));
}

/// From now on the command looks at [`is_asked`] and writes what it has.
pub fn write_first() {
    WRITES_FIRST.store(true, Ordering::SeqCst);
}

/// Whether the command has been told to end.
#[must_use]
pub fn is_asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}
