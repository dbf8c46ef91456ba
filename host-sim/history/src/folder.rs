//! The traces in a folder and below it, by date.

use std::fs;
use std::path::{Path, PathBuf};

use files::error::InputError;
use jiff::civil::Date;

use crate::record::Record;
use crate::{model_file, trace_json};

/// The traces of one machine, earliest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Folder {
    /// The traces, at least one.
    pub records: Vec<Record>,
    /// All files of the folder that are results or models, also those that were left out: none may be overwritten.
    pub files: Vec<PathBuf>,
    /// What was left out, a sentence each.
    pub notes: Vec<String>,
}

/// Reads all JSON files and machine files of a folder and of the folders in it. A machine file beside a JSON file of its name is the
/// model of that trace and is not read.
///
/// # Errors
/// A folder or file that cannot be read, a trace without a date, traces of more than one machine, no trace.
pub fn read(folder: &Path) -> Result<Folder, InputError> {
    let shown = folder.display().to_string();
    let mut paths = Vec::new();
    collect(folder, &mut paths)?;
    paths.sort();
    let (mut records, mut others) = (Vec::new(), 0_usize);
    for path in &paths {
        let is_model = has_extension(path, "toml");
        if is_model && paths.contains(&path.with_extension("json")) {
            continue;
        }
        let source = path.display().to_string();
        let text = fs::read_to_string(path).map_err(|error| InputError::unreadable(&source, &error))?;
        let day = date_in(path.strip_prefix(folder).unwrap_or(path));
        let record = if is_model {
            model_file::read(&text, &source, day)?
        } else {
            trace_json::read(&text, &source, day)?
        };
        match record {
            Some(record) => records.push(record),
            None => others += 1,
        }
    }
    if records.is_empty() {
        let expected = "the JSON of `lost-motion trace --json`, or its models, in it";
        return Err(InputError::expected(&shown, expected, "none"));
    }
    records.sort_by(|a, b| (a.day, &a.source).cmp(&(b.day, &b.source)));
    check_machine(&records)?;
    let mut notes = Vec::new();
    if others > 0 {
        notes.push(format!("{others} other files (.json, .toml) are no traces and were left out."));
    }
    Ok(Folder { records, files: paths, notes })
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<(), InputError> {
    let unreadable = |error| InputError::unreadable(&folder.display().to_string(), &error);
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        // A link may lead back to a folder above it.
        if path.is_dir() && !path.is_symlink() {
            collect(&path, paths)?;
        } else if has_extension(&path, "json") || has_extension(&path, "toml") {
            paths.push(path);
        }
    }
    Ok(())
}

/// The date in the name of a file, else in that of the closest folder that has one: 2026-11-27 or 20261127.
fn date_in(path: &Path) -> Option<Date> {
    path.ancestors().filter_map(|part| part.file_name()?.to_str()).find_map(date_in_name)
}

fn date_in_name(name: &str) -> Option<Date> {
    let is_digit = |at: Option<&u8>| at.is_some_and(u8::is_ascii_digit);
    let bytes = name.as_bytes();
    let starts = 0..bytes.len();
    starts.into_iter().find_map(|start| {
        [(10, "%Y-%m-%d"), (8, "%Y%m%d")].into_iter().find_map(|(length, format)| {
            let end = start + length;
            // A longer number is no date.
            let stands_alone = (start == 0 || !is_digit(bytes.get(start - 1))) && !is_digit(bytes.get(end));
            let part = name.get(start..end).filter(|_| stands_alone)?;
            Date::strptime(format, part).ok()
        })
    })
}

/// Files that name their machine or its serial number name the same.
fn check_machine(records: &[Record]) -> Result<(), InputError> {
    for (what, of) in [
        ("machine", (|record| record.machine.as_ref()) as fn(&Record) -> Option<&String>),
        ("serial number", |record| record.serial.as_ref()),
    ] {
        let mut named = records.iter().filter_map(|record| Some((record, of(record)?)));
        let Some((first, expected)) = named.next() else { continue };
        if let Some((other, found)) = named.find(|(_, name)| *name != expected) {
            let expected = format!("traces of one machine ({what} {expected}, as in {})", first.source);
            return Err(InputError::expected(&other.source, expected, found));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_stand_in_names_of_files_or_folders() {
        let day = |year, month, day| Some(Date::new(year, month, day).unwrap());
        for (path, expected) in [
            ("2026-11-27.json", day(2026, 11, 27)),
            ("mill_2026-11-27_after.json", day(2026, 11, 27)),
            ("20260105.json", day(2026, 1, 5)),
            ("2025-02-28/x-2.json", day(2025, 2, 28)),
            ("2025-02-28/2025-03-01.json", day(2025, 3, 1)),
            // The 30th of February, a longer number, and a part of a date are none.
            ("2025-02-30.json", None),
            ("120260105.json", None),
            ("2026-11.json", None),
        ] {
            assert_eq!(date_in(Path::new(path)), expected, "{path}");
        }
    }
}
