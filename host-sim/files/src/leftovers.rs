//! Temporary files of outputs: their names, and what a killed run left of them.
//!
//! The name has the number of the process, and the process locks the file as long as it writes. A file whose process has ended and that
//! nobody has locked is left over. Both are asked, as the number of a process may be that of another one in another container.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, PoisonError};

/// Begin of the names of all temporary files.
const PREFIX: &str = ".lost-motion-";

/// Number of random characters at the end of a name.
const RANDOM: usize = 6;

/// Begin of the names of this process's temporary files; [`RANDOM`] characters follow.
#[must_use]
pub fn prefix() -> String {
    format!("{PREFIX}{}-", process::id())
}

/// Marks a temporary file as being written, until it is closed. Where files cannot be locked, its process alone says so.
pub fn mark(file: &File) {
    let _ = file.try_lock();
}

/// Removes what killed runs left in a folder; once for each folder, as the next run does it again. What cannot be removed stays.
pub fn remove_in(folder: &Path) {
    static CLEANED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    if CLEANED.lock().unwrap_or_else(PoisonError::into_inner).insert(folder.clone()) {
        remove_all(&folder);
    }
}

fn remove_all(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file
            && entry.file_name().to_str().is_some_and(is_of_ended_process)
            && is_unlocked(&entry.path())
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether a name is that of a temporary file whose process has ended, as far as it is known.
fn is_of_ended_process(name: &str) -> bool {
    let Some(rest) = name.strip_prefix(PREFIX) else { return false };
    let is_random = |text: &str| text.len() == RANDOM && text.chars().all(|c| c.is_ascii_alphanumeric());
    match rest.split_once('-') {
        // As version 0.1.0 named them.
        None => is_random(rest),
        Some((number, random)) => {
            is_random(random) && number.parse::<u32>().is_ok_and(|number| !is_running(number))
        }
    }
}

/// Whether a process runs. Where that cannot be asked, the lock alone decides, except of this process.
fn is_running(number: u32) -> bool {
    number == process::id() || Path::new("/proc").join(number.to_string()).exists()
}

fn is_unlocked(path: &Path) -> bool {
    File::options().write(true).open(path).is_ok_and(|file| file.try_lock().is_ok())
}

// Of a process that has ended, /proc tells.
#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// A number that no process has: the highest of Linux is 2²².
    const ENDED: &str = "4194400";

    #[test]
    fn only_files_of_ended_processes_that_nobody_writes_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let of_parent = format!("{PREFIX}{}-abcdef", std::os::unix::process::parent_id());
        let kept =
            [format!("{}abcdef", prefix()), of_parent, "out.csv".into(), ".lost-motion-notes.txt".into()];
        let removed = [format!("{PREFIX}{ENDED}-a1B2c3"), format!("{PREFIX}a1B2c3")];
        for name in kept.iter().chain(&removed) {
            fs::write(path(name), "half").unwrap();
        }
        let locked = format!("{PREFIX}{ENDED}-locked");
        let writing = File::create(path(&locked)).unwrap();
        mark(&writing);
        remove_all(folder.path());
        assert!(kept.iter().all(|name| path(name).exists()) && path(&locked).exists());
        assert!(removed.iter().all(|name| !path(name).exists()));
        drop(writing);
        remove_all(folder.path());
        assert!(!path(&locked).exists());
    }
}
