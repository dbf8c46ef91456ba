//! Outputs: files, which must not overwrite inputs, and stdout.

use std::io::{ErrorKind, Write, stdout};
use std::path::{Path, PathBuf};

use serde::Serialize;

use files::error::{InputError, quoted};
use files::output::write_whole;

/// Checks that no output overwrites an input or another output. `outputs` are the flags and their paths.
pub fn check_outputs(inputs: &[&Path], outputs: &[(&str, Option<&PathBuf>)]) -> Result<(), InputError> {
    let canonical = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let in_folder = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
        path.canonicalize().ok().or_else(in_folder).filter(|path| !path.exists() || path.is_file())
    };
    let mut taken: Vec<PathBuf> = inputs.iter().filter_map(|path| canonical(path)).collect();
    for (flag, path) in outputs {
        let Some(path) = path.and_then(|path| canonical(path)) else { continue };
        if taken.contains(&path) {
            let expected = "a file that is neither an input nor another output";
            return Err(InputError::expected(flag, expected, quoted(&path.display().to_string())));
        }
        taken.push(path);
    }
    Ok(())
}

/// Writes a result as JSON, if a path is given.
///
/// # Errors
/// If the file cannot be written.
pub fn write_json(path: Option<&PathBuf>, value: &impl Serialize) -> anyhow::Result<()> {
    let Some(path) = path else { return Ok(()) };
    let text = serde_json::to_string_pretty(value)?;
    Ok(write_whole(path, |out| out.write_all(text.as_bytes()))?)
}

/// Prints the result on stdout. A closed pipe is not an error: all files have been written before.
pub fn print(text: &str) -> anyhow::Result<()> {
    match writeln!(stdout().lock(), "{text}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
