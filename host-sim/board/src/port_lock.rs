//! One program at a port: a second one would get no replies, and could neither ask nor stop anything.
//!
//! Each program that opens a port locks a file for it, and writes there who it is. The lock ends with its process. Other programs, such
//! as a terminal, are found by their open files, as far as the system shows them.

use std::fs::{self, File};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

/// Longest description of a holder that is read.
const LONGEST: u64 = 512;

/// A port that this process holds.
#[derive(Debug)]
pub struct PortLock {
    file: File,
    path: PathBuf,
}

impl PortLock {
    /// Locks a file for a port. `Ok(None)`: the file cannot be made, and the port is used without a lock; a stop must not fail for that.
    ///
    /// # Errors
    /// The program that holds it, in words.
    pub fn take(path: &Path) -> Result<Option<Self>, String> {
        if let Some(folder) = path.parent() {
            // If it fails, so does the next step.
            let _ = fs::create_dir_all(folder);
        }
        let opened = File::options().read(true).write(true).create(true).truncate(false).open(path);
        let Ok(file) = opened else { return Ok(None) };
        match file.try_lock() {
            Ok(()) => {
                let mut lock = Self { file, path: path.to_owned() };
                // Without a description the lock still holds.
                let _ = lock.write(&describe(std::process::id()));
                Ok(Some(lock))
            }
            Err(fs::TryLockError::WouldBlock) => Err(holder(file)),
            Err(fs::TryLockError::Error(_)) => Ok(None),
        }
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn write(&mut self, text: &str) -> std::io::Result<()> {
        self.file.set_len(0)?;
        self.file.rewind()?;
        self.file.write_all(text.as_bytes())
    }
}

impl Drop for PortLock {
    fn drop(&mut self) {
        let _ = self.file.set_len(0);
    }
}

/// What the holder of a lock has written.
fn holder(file: File) -> String {
    let mut text = String::new();
    // Nothing yet, if it has just locked it.
    let _ = file.take(LONGEST).read_to_string(&mut text);
    if text.is_empty() {
        return "another program".to_owned();
    }
    format!("{} (a Ctrl-C there stops what it moves)", text.escape_default())
}

/// The program of a process, in words: `lost-motion board jog --port bench (process 4711)`.
fn describe(process: u32) -> String {
    let line = fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
    let mut words = line.split(|byte| *byte == 0).map(String::from_utf8_lossy);
    let program = words.next().unwrap_or_default().into_owned();
    let name =
        Path::new(&program).file_name().map_or_else(|| "a program".into(), |name| name.to_string_lossy());
    let rest: String = words.filter(|word| !word.is_empty()).map(|word| format!(" {word}")).collect();
    format!("{name}{rest} (process {process})")
}

/// Another process that has a file open, in words; `None` if there is none that the system shows to this user.
#[must_use]
pub fn other_user_of(path: &Path) -> Option<String> {
    let path = fs::canonicalize(path).ok()?;
    let processes = fs::read_dir("/proc").ok()?.flatten();
    let ids = processes.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
    ids.filter(|process| *process != std::process::id()).find_map(|process| {
        let mut files = fs::read_dir(format!("/proc/{process}/fd")).ok()?.flatten();
        files.any(|file| fs::read_link(file.path()).is_ok_and(|to| to == path)).then(|| describe(process))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of this test, which ends with it.
    struct Folder(PathBuf);

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    /// The second one is refused with the name of this process; after the first has ended, the port is free. A lock that cannot be made
    /// refuses nobody.
    #[test]
    fn a_port_has_one_holder_whose_name_is_told() {
        let folder = Folder(std::env::temp_dir().join(format!("port-lock-{}", std::process::id())));
        let path = folder.0.join("locks").join("link.lock");
        let first = PortLock::take(&path).unwrap();
        assert!(first.is_some());
        let name = format!("(process {})", std::process::id());
        for _ in 0..2 {
            let refused = PortLock::take(&path).unwrap_err();
            assert!(refused.contains(&name) && refused.contains("board-"), "{refused}");
        }
        drop(first);
        // A process that another test starts has the lock, too, until its own program begins.
        let mut free = None;
        for _ in 0..500 {
            free = PortLock::take(&path).ok().flatten();
            if free.is_some() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        assert!(free.is_some());
        assert!(PortLock::take(Path::new("/proc/no-such-folder/link.lock")).unwrap().is_none());
    }

    /// A process that reads from a file is found; this process is not.
    #[test]
    fn another_program_that_has_a_port_open_is_found() {
        let folder = Folder(std::env::temp_dir().join(format!("port-user-{}", std::process::id())));
        fs::create_dir_all(&folder.0).unwrap();
        let path = folder.0.join("port");
        let file = File::create(&path).unwrap();
        assert_eq!(other_user_of(&path), None);
        let mut other =
            std::process::Command::new("sleep").arg("60").stdin(File::open(&path).unwrap()).spawn().unwrap();
        // Between fork and exec the new process has no command line yet.
        let command_line = format!("/proc/{}/cmdline", other.id());
        for _ in 0..500 {
            if fs::read(&command_line).is_ok_and(|line| line.starts_with(b"sleep")) {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        let found = other_user_of(&path);
        other.kill().unwrap();
        other.wait().unwrap();
        drop(file);
        assert_eq!(found, Some(format!("sleep 60 (process {})", other.id())));
        assert_eq!(other_user_of(&path), None);
    }
}
