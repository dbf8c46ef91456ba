//! The blind cases: each a folder with a machine file, logs to fit and logs to validate.

use std::fs::read_dir;
use std::path::{Path, PathBuf};

use crate::data::data_folder;

/// The folders of the cases, sorted. `None` where there are no data: see [`data_folder`].
///
/// # Panics
/// If there are fewer than nine: an incomplete set of cases must not pass.
#[must_use]
pub fn folders() -> Option<Vec<PathBuf>> {
    let folders = sorted(&data_folder("cases")?);
    assert!(folders.len() >= 9, "{} cases", folders.len());
    Some(folders)
}

/// The folders of the cases with little knowledge, sorted. `None` where there are no data.
///
/// # Panics
/// If there are fewer than six.
#[must_use]
pub fn sparse_folders() -> Option<Vec<PathBuf>> {
    let folders = sorted(&data_folder("cases-sparse")?);
    assert!(folders.len() >= 6, "{} cases", folders.len());
    Some(folders)
}

/// The logs of a case whose names begin with a prefix, sorted.
#[must_use]
pub fn logs(folder: &Path, prefix: &str) -> Vec<PathBuf> {
    let has_prefix =
        |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(prefix));
    sorted(folder).into_iter().filter(has_prefix).collect()
}

fn sorted(folder: &Path) -> Vec<PathBuf> {
    let entries = read_dir(folder).expect("the folder exists");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("the entry can be read").path()).collect();
    paths.sort();
    paths
}
