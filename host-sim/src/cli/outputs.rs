//! Outputs: files, which must not overwrite inputs, and stdout.

use std::io::{ErrorKind, Write, stdout};
use std::path::{Path, PathBuf};

use serde::Serialize;

use files::error::{InputError, printable, quoted};
use files::output::{check_folder, check_new_folder, folder_of, write_whole};

/// An output: its flag, and its path if it is given.
#[derive(Clone, Copy, Debug)]
pub enum Output<'a> {
    /// A file in a folder that exists.
    File(&'a str, Option<&'a PathBuf>),
    /// A file in a folder that is created with it.
    InNewFolder(&'a str, Option<&'a PathBuf>),
}

/// Checks, before anything is computed, that every output has a folder and that none overwrites an input or another output.
///
/// # Errors
/// The first output that cannot be written.
pub fn check_outputs(inputs: &[&Path], outputs: &[Output<'_>]) -> anyhow::Result<()> {
    let canonical = |path: &Path| {
        let in_folder = || Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?));
        path.canonicalize().ok().or_else(in_folder).filter(|path| !path.exists() || path.is_file())
    };
    let mut taken: Vec<PathBuf> = inputs.iter().filter_map(|path| canonical(path)).collect();
    for output in outputs {
        let (Output::File(flag, path) | Output::InNewFolder(flag, path)) = output;
        let is_folder = matches!(output, Output::InNewFolder(..));
        let is_dash = |path: &Path| path.as_os_str() == "-";
        if path.is_some_and(|path| is_dash(path) || is_folder && path.parent().is_some_and(is_dash)) {
            let expected = format!(
                "a {}; stdout is for the sentences and tables",
                if is_folder { "folder" } else { "file" }
            );
            return Err(InputError::expected(flag, expected, quoted("-")).into());
        }
        match output {
            Output::File(_, Some(path)) => check_folder(path)?,
            Output::InNewFolder(_, Some(path)) => check_new_folder(path)?,
            _ => {}
        }
        let Some(path) = path.and_then(|path| canonical(path)) else { continue };
        if taken.contains(&path) {
            let expected = "a file that is neither an input nor another output";
            return Err(InputError::expected(flag, expected, quoted(&path.display().to_string())).into());
        }
        taken.push(path);
    }
    Ok(())
}

/// Checks the outputs of a command that writes JSON and a page, as [`check_outputs`]. `page` is the file in the folder of `--report`.
///
/// # Errors
/// As [`check_outputs`].
pub fn check_json_and_page(
    inputs: &[&Path],
    json: Option<&PathBuf>,
    page: Option<&PathBuf>,
) -> anyhow::Result<()> {
    check_outputs(inputs, &[Output::File("--json", json), Output::InNewFolder("--report", page)])
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

/// Prints the result on stdout, without control characters that a name in a file may have. A closed pipe is not an error: all files have
/// been written before.
pub fn print(text: &str) -> anyhow::Result<()> {
    print_to_reader(text).map(drop)
}

/// Prints a line on stdout. False if the pipe is closed: nobody reads it any more.
pub fn print_to_reader(text: &str) -> anyhow::Result<bool> {
    match writeln!(stdout().lock(), "{}", printable(text)) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        written => Ok(written.map(|()| true)?),
    }
}
