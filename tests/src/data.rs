//! The measured data and the blind cases, which are not part of the repository.

use std::io::{Write, stderr};
use std::path::PathBuf;

/// A folder below `LOST_MOTION_DATA`, which has the measured data and the blind cases.
///
/// `None` where the variable is not set, with a message on stderr: the caller's test is skipped.
///
/// # Panics
/// Where the variable is set and the folder does not exist: a requested check must not be skipped.
#[must_use]
pub fn data_folder(name: &str) -> Option<PathBuf> {
    let Some(root) = std::env::var_os("LOST_MOTION_DATA") else {
        // Not `eprintln!`: the harness does not show its output of a passing test.
        let _ = writeln!(stderr(), "SKIPPED: LOST_MOTION_DATA does not name the folder that holds {name}");
        return None;
    };
    let path = PathBuf::from(root).join(name);
    assert!(path.is_dir(), "LOST_MOTION_DATA is set, but {} is not a folder", path.display());
    Some(path)
}
