//! The blind cases: a folder each, with a machine file, logs to fit and logs to validate.

use std::fs::read_dir;
use std::path::{Path, PathBuf};

/// The folders of the cases, in order. `None` where there are no data: see [`data`](crate::data).
///
/// # Panics
/// Where there are fewer than nine: a case must not vanish.
#[must_use]
pub fn folders() -> Option<Vec<PathBuf>> {
    let folders = sorted(&crate::data("cases")?);
    assert!(folders.len() >= 9, "{} cases", folders.len());
    Some(folders)
}

/// The logs of a case whose names begin with a word, in order.
#[must_use]
pub fn logs(folder: &Path, begins: &str) -> Vec<PathBuf> {
    let is_one =
        |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(begins));
    sorted(folder).into_iter().filter(is_one).collect()
}

fn sorted(folder: &Path) -> Vec<PathBuf> {
    let entries = read_dir(folder).expect("the folder is there");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("it can be read").path()).collect();
    paths.sort();
    paths
}
