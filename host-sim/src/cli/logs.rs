//! Logs of the arguments: our own, and binary files whose columns have our names and units.

use std::path::{Path, PathBuf};

use files::error::InputError;
use files::log::Log;

use ::import::request::Request;

/// Where a file is to go that is no log.
const ADVICE: &str = "lost-motion import converts logs of other programs, with --map, --unit and --rate";

/// Reads logs. What was assumed of a binary file is told on stderr.
///
/// # Errors
/// The first file that is no log; if it looks like that of another program, with what converts it.
pub fn read(paths: &[PathBuf]) -> Result<Vec<Log>, InputError> {
    paths.iter().map(|path| read_one(path)).collect()
}

fn read_one(path: &Path) -> Result<Log, InputError> {
    let advised = |error: InputError| if path.is_file() { error.with_advice(ADVICE) } else { error };
    if ::import::is_binary(path) {
        let imported = ::import::import(path, &Request::default()).map_err(advised)?;
        for note in imported.notes {
            eprintln!("{}: {note}", imported.log.source);
        }
        return Ok(imported.log);
    }
    let is_csv =
        path.extension().is_none_or(|own| ["csv", "gz"].iter().any(|other| own.eq_ignore_ascii_case(other)));
    Log::read(path).map_err(|error| if is_csv { error } else { advised(error) })
}
