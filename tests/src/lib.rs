//! What several of the tests need.

pub mod board;
pub mod cases;
pub mod chip;
pub mod firmware;
pub mod gdb;

use std::io::{Write, stderr};
use std::path::PathBuf;

/// A folder below `LOST_MOTION_DATA`, where the measured data and the blind cases are.
///
/// `None`, said on stderr, where the variable is not set: the caller's test is skipped.
///
/// # Panics
/// Where it is set and the folder is not there: a check that was asked for must not vanish.
#[must_use]
pub fn data(folder: &str) -> Option<PathBuf> {
    let Some(root) = std::env::var_os("LOST_MOTION_DATA") else {
        // Not `eprintln!`: the harness keeps to itself what a passing test says with it.
        let _ = writeln!(stderr(), "SKIPPED: LOST_MOTION_DATA does not name the folder that holds {folder}");
        return None;
    };
    let path = PathBuf::from(root).join(folder);
    assert!(path.is_dir(), "LOST_MOTION_DATA is set, but {} is not a folder", path.display());
    Some(path)
}
pub mod program;
