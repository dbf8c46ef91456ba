//! Output files that are written completely or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::{Builder, NamedTempFile};
use thiserror::Error;

use crate::leftovers;

/// Why a folder is refused in the place of a file.
const IS_FOLDER: &str = "expected a file, found a folder";

/// A file that could not be written. A previous file of that name is unchanged.
#[derive(Debug, Error)]
#[error("{}: not written: {cause}", path.display())]
pub struct OutputError {
    /// The file.
    pub path: PathBuf,
    /// The cause. It is not declared as the error's source, as the message contains it and a printed chain would repeat it.
    pub cause: io::Error,
}

/// Writes the output of `fill` to a temporary file in the same folder, then renames the file.
///
/// A path that is not a regular file (a pipe, `/dev/null`) is written in place, as renaming would replace it.
///
/// # Errors
/// If `fill` fails, or the folder is missing, not writable or full.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    let written = match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => Err(io::Error::other(IS_FOLDER)),
        Ok(metadata) if !metadata.is_file() => write_in_place(path, fill),
        // A link is kept; its target is replaced.
        Ok(_) => fs::canonicalize(path).and_then(|target| replace(&target, fill)),
        Err(_) => replace(path, fill),
    };
    written.map_err(|cause| OutputError { path: path.to_owned(), cause })
}

fn check_no_folder(path: &Path) -> io::Result<()> {
    if path.is_dir() { Err(io::Error::other(IS_FOLDER)) } else { Ok(()) }
}

/// Checks that there is a folder for a file that will be written, and that the file is not itself a folder.
///
/// # Errors
/// If there is none, or the file is one.
pub fn check_folder(path: &Path) -> Result<(), OutputError> {
    let checked = check_no_folder(path).and_then(|()| existing_folder_of(path));
    checked.map(drop).map_err(|cause| OutputError { path: path.to_owned(), cause })
}

/// Creates a folder with its parents, unless it exists.
///
/// # Errors
/// If it cannot be created.
pub fn create_folder(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(|cause| OutputError { path: path.to_owned(), cause })
}

/// Removes a file, if there is one.
///
/// # Errors
/// If it cannot be removed.
pub fn remove(path: &Path) -> Result<(), OutputError> {
    match fs::remove_file(path) {
        Err(cause) if cause.kind() != io::ErrorKind::NotFound => {
            Err(OutputError { path: path.to_owned(), cause })
        }
        _ => Ok(()),
    }
}

/// Checks that a file can be written in a folder that may have to be created with its parents.
///
/// # Errors
/// If the file is a folder, or what exists of its path is none.
pub fn check_new_folder(path: &Path) -> Result<(), OutputError> {
    let existing = folder_of(path).ancestors().find(|folder| folder.exists());
    let checked = check_no_folder(path).and_then(|()| match existing {
        Some(existing) if !existing.is_dir() => {
            Err(io::Error::other(format!("expected a folder, found a file: {}", existing.display())))
        }
        _ => Ok(()),
    });
    checked.map_err(|cause| OutputError { path: path.to_owned(), cause })
}

/// The folder of a file, which need not exist; `.` for a file name alone.
#[must_use]
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn existing_folder_of(path: &Path) -> io::Result<&Path> {
    let folder = folder_of(path);
    if folder.is_dir() {
        Ok(folder)
    } else {
        Err(io::Error::other(format!("there is no folder {}", folder.display())))
    }
}

fn write_in_place(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut buffer = BufWriter::new(File::options().write(true).open(path)?);
    fill(&mut buffer)?;
    buffer.flush()
}

/// Temporary files that have not been renamed yet.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes all partly written files; called when the program is interrupted.
pub fn remove_unfinished() {
    let mut unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
    for path in unfinished.drain(..) {
        drop(fs::remove_file(path));
    }
}

/// Registers a temporary file in [`UNFINISHED`] until this guard is dropped.
struct Unfinished(PathBuf);

impl Unfinished {
    fn new(path: &Path) -> Self {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).retain(|path| *path != self.0);
    }
}

fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut temporary = temporary_beside(path)?;
    let _unfinished = Unfinished::new(temporary.path());
    let mut buffer = BufWriter::new(temporary.as_file_mut());
    fill(&mut buffer)?;
    buffer.flush()?;
    drop(buffer);
    // Without this, a power failure after the rename may leave an empty file.
    temporary.as_file().sync_all()?;
    temporary.persist(path).map(drop).map_err(|refused| refused.error)
}

/// A temporary file in the folder of `path`, so that renaming does not cross file systems.
fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = existing_folder_of(path)?;
    leftovers::remove_in(folder);
    let prefix = leftovers::prefix();
    let mut builder = Builder::new();
    builder.prefix(&prefix);
    set_permissions(&mut builder);
    let temporary = builder.tempfile_in(folder)?;
    leftovers::mark(temporary.as_file());
    Ok(temporary)
}

/// Sets the permissions of new files, which the umask reduces. The default of temporary files is private.
#[cfg(unix)]
fn set_permissions(builder: &mut Builder<'_, '_>) {
    use std::os::unix::fs::PermissionsExt;

    builder.permissions(fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn set_permissions(_builder: &mut Builder<'_, '_>) {}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_new_folder_is_below_folders_and_its_file_is_no_folder() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("file"), "text").unwrap();
        assert!(check_new_folder(&path("a/b/page.html")).is_ok());
        let message = check_new_folder(&path("file/b/page.html")).unwrap_err().to_string();
        assert!(message.ends_with(&format!("expected a folder, found a file: {}", path("file").display())));
        let message = check_new_folder(folder.path()).unwrap_err().to_string();
        assert!(message.ends_with("expected a file, found a folder"));
        assert!(!path("a").exists());
    }

    #[test]
    fn a_file_in_a_folder_that_exists_is_no_folder_itself() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_folder(&folder.path().join("out.csv")).is_ok());
        let message = check_folder(&folder.path().join("missing/out.csv")).unwrap_err().to_string();
        assert!(message.contains("out.csv: not written: there is no folder"), "{message}");
        let message = check_folder(folder.path()).unwrap_err().to_string();
        assert!(message.ends_with("not written: expected a file, found a folder"), "{message}");
    }

    #[test]
    fn a_file_is_removed_and_no_file_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, "text").unwrap();
        assert!(remove(&path).is_ok() && !path.exists());
        assert!(remove(&path).is_ok());
        assert!(remove(folder.path()).is_err());
    }

    #[test]
    fn a_complete_output_replaces_the_previous_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.json");
        for text in ["first, and longer", "second"] {
            write_whole(&path, |out| out.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(names(folder.path()), ["out.json"]);
    }

    #[test]
    fn a_failure_keeps_the_previous_file_and_leaves_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.json");
        fs::write(&path, "before").unwrap();
        let half = |out: &mut dyn Write| {
            out.write_all(b"half")?;
            Err(io::Error::other("the other half is missing"))
        };
        let error = write_whole(&path, half).unwrap_err().to_string();
        assert!(error.contains("out.json: not written: the other half is missing"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        assert_eq!(names(folder.path()), ["out.json"]);
    }

    #[test]
    fn the_error_names_the_path() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("missing").join("out.csv");
        let error = write_whole(&missing, |_| Ok(())).unwrap_err().to_string();
        assert!(error.contains("out.csv: not written: there is no folder"), "{error}");
        let error = write_whole(folder.path(), |_| Ok(())).unwrap_err().to_string();
        assert!(error.contains("expected a file, found a folder"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn an_output_has_the_permissions_of_a_new_file() {
        use std::os::unix::fs::PermissionsExt;

        let folder = tempfile::tempdir().unwrap();
        let mode = |name| fs::metadata(folder.path().join(name)).unwrap().permissions().mode();
        fs::write(folder.path().join("plain"), "").unwrap();
        write_whole(&folder.path().join("ours"), |_| Ok(())).unwrap();
        assert_eq!(mode("ours"), mode("plain"));
    }

    #[cfg(unix)]
    #[test]
    fn links_and_sockets_are_kept() {
        use std::os::unix::fs::FileTypeExt;

        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        fs::write(&target, "before").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        write_whole(&link, |out| out.write_all(b"after")).unwrap();
        assert_eq!(fs::read_to_string(&target).unwrap(), "after");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());

        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        assert!(write_whole(&socket, |_| Ok(())).is_err());
        assert!(fs::metadata(&socket).unwrap().file_type().is_socket());
    }
}
