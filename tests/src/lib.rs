//! Parts that several integration tests share.
//!
//! [`program`] builds and runs `lost-motion`, [`cases`] finds the blind cases; [`firmware`] builds the programs of the
//! chip, [`chip`] analyses them, and [`board`] runs them on an emulated chip by [`gdb`].

pub mod board;
pub mod cases;
pub mod chip;
pub mod firmware;
pub mod gdb;
pub mod program;

use std::io::{Write, stderr};
use std::path::PathBuf;

/// A folder below `LOST_MOTION_DATA`, which has the measured data and the blind cases.
///
/// `None` where the variable is not set, with a message on stderr: the caller's test is skipped.
///
/// # Panics
/// Where the variable is set and the folder does not exist: a requested check must not be skipped.
#[must_use]
pub fn data(folder: &str) -> Option<PathBuf> {
    let Some(root) = std::env::var_os("LOST_MOTION_DATA") else {
        // Not `eprintln!`: the harness does not show its output of a passing test.
        let _ = writeln!(stderr(), "SKIPPED: LOST_MOTION_DATA does not name the folder that holds {folder}");
        return None;
    };
    let path = PathBuf::from(root).join(folder);
    assert!(path.is_dir(), "LOST_MOTION_DATA is set, but {} is not a folder", path.display());
    Some(path)
}
