//! Logs of the arguments: our own, and those of other programs.

use std::path::PathBuf;

use files::error::{InputError, in_one_line};
use files::log::Log;

use ::import::Imported;
use ::import::any_log;
use ::import::request::Request;

/// Reads logs. What was assumed of a foreign one is told on stderr.
///
/// # Errors
/// The first file that is no log.
pub fn read(paths: &[PathBuf], request: &Request) -> Result<Vec<Log>, InputError> {
    paths.iter().map(|path| Ok(told(any_log::read(path, request)?))).collect()
}

/// The log, after what was assumed of it was told on stderr.
pub fn told(imported: Imported) -> Log {
    tell(&imported.log.source, &imported.notes);
    imported.log
}

/// Tells on stderr what was assumed of a file.
pub fn tell(source: &str, notes: &[String]) {
    for note in notes {
        eprintln!("{}", in_one_line(&format!("{source}: {note}")));
    }
}
