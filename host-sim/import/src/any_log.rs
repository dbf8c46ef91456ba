//! A log of our own or of another program, by its first line.
//!
//! A header with `time_s` and names of channels alone is that of our own log, and only its strict reader reads it. A header that has some of
//! our names is taken for ours too, so that a misspelt column is an error and not left out; what the user says of the file makes it a
//! foreign one. Every other file is imported, unless it has no row of
//! numbers: then it is told what a log of ours has.

use std::io::{Cursor, Read};
use std::path::Path;

use files::error::InputError;
use files::head::Head;
use files::log::{Log, TIME, channel_of};
use files::table::Table;

use crate::budget::Budget;
use crate::read::may_be_table;
use crate::request::Request;
use crate::{Foreign, Imported, ballbar, foreign};

/// What to do about a file that is no log.
pub const ADVICE: &str = "a log of another program is read with --map OURS=THEIRS, --unit, --rate and --preset: lost-motion import --help";

/// What a file of a circle holds.
pub enum Content<'a> {
    /// A log.
    Log(Imported),
    /// A ballbar's table of radii in our columns, and what was assumed of it.
    Radii(Box<dyn Read + 'a>, Vec<String>),
}

/// Whose the header of a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Whose {
    /// `time_s` and channels alone, or nothing at all.
    Ours,
    /// Some names are ours.
    Partly,
    /// None is.
    Foreign,
}

/// Reads a log; `-` is standard input, and gzip is recognised.
///
/// # Errors
/// Of our own log as [`Log::read`], of any other file as [`foreign`], with what reads a foreign one if `request` is empty.
pub fn read(path: &Path, request: &Request) -> Result<Imported, InputError> {
    let source = path.display().to_string();
    of_head(Head::open(path, &source)?, &source, request)
}

/// Reads a log of which the first line is known; `source` is its name for messages.
///
/// # Errors
/// As [`read`].
pub fn of_head(head: Head<'_>, source: &str, request: &Request) -> Result<Imported, InputError> {
    match log_or_ballbar(head, source, request)? {
        Foreign::Log(imported) => Ok(imported),
        Foreign::Ballbar(_) => Err(ballbar::no_log(source)),
    }
}

/// Reads a log, or a table of radii of another program, of which the first line is known; `source` is its name for messages.
///
/// # Errors
/// As [`read`].
pub fn log_or_ballbar(head: Head<'_>, source: &str, request: &Request) -> Result<Foreign, InputError> {
    let advised = |error: InputError| if request.is_empty() { error.with_advice(ADVICE) } else { error };
    match whose(&head) {
        Whose::Ours => {
            let log = own(head, source)?;
            let note = "its columns are those of a log of ours: --map, --unit, --rate and --preset are not applied to it";
            let notes = if request.is_empty() { Vec::new() } else { vec![note.to_owned()] };
            Ok(Foreign::Log(Imported { log, notes }))
        }
        Whose::Partly if request.is_empty() => {
            let log = own(head, source).map_err(advised)?;
            Ok(Foreign::Log(Imported { log, notes: Vec::new() }))
        }
        Whose::Partly | Whose::Foreign => {
            let bytes = Budget::file().read(head.into_input(), source)?;
            if request.is_empty() && !may_be_table(&bytes) {
                let log = Log::parse(&bytes, source).map_err(advised)?;
                return Ok(Foreign::Log(Imported { log, notes: Vec::new() }));
            }
            foreign(&bytes, source, request).map_err(advised)
        }
    }
}

/// Reads a log, or opens a table of radii, of ours or of another program; `source` is its name for messages.
///
/// # Errors
/// As [`read`].
pub fn content<'a>(head: Head<'a>, source: &str, request: &Request) -> Result<Content<'a>, InputError> {
    if ballbar::has_radius(&head.names()) {
        return Ok(Content::Radii(head.into_input(), Vec::new()));
    }
    Ok(match log_or_ballbar(head, source, request)? {
        Foreign::Log(imported) => Content::Log(imported),
        Foreign::Ballbar(table) => Content::Radii(Box::new(Cursor::new(table.csv())), table.notes),
    })
}

fn own(head: Head<'_>, source: &str) -> Result<Log, InputError> {
    Log::of_table(Table::of_input(head.into_input(), source)?, source)
}

fn whose(head: &Head<'_>) -> Whose {
    let names = head.names();
    let is_ours = |name: &String| name == TIME || channel_of(name).is_some();
    match () {
        () if head.is_blank() => Whose::Ours,
        () if names.iter().all(is_ours) && names.iter().any(|name| name == TIME) => Whose::Ours,
        () if names.iter().any(is_ours) => Whose::Partly,
        () => Whose::Foreign,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, request: &Request) -> Result<Imported, String> {
        let head = Head::of(Box::new(text.as_bytes()), "a.csv").unwrap();
        of_head(head, "a.csv", request).map_err(|error| error.to_string())
    }

    fn at_2_khz() -> Request {
        Request { rate_hz: Some(2000.0), ..Request::default() }
    }

    const OURS: &str = "time_s,x_motor_mm\n0,1\n0.001,2\n0.002,3\n";

    /// The rate is not applied to our own log, and that is told.
    #[test]
    fn our_own_log_is_read_as_such() {
        let log = Log::parse(OURS.as_bytes(), "a.csv").unwrap();
        let plain = read(OURS, &Request::default()).unwrap();
        assert!(plain.log == log && plain.notes.is_empty());
        let rated = read(OURS, &at_2_khz()).unwrap();
        assert!(rated.log == log && rated.notes.len() == 1 && rated.notes[0].contains("not applied"));
    }

    #[test]
    fn errors_of_our_own_log_keep_their_line_and_have_no_advice() {
        let message = read(&OURS.replace(",2", ",x"), &Request::default()).unwrap_err();
        assert_eq!(message, "a.csv: line 3: x_motor_mm: expected a finite number, found \"x\"");
        assert_eq!(
            read(" \n", &Request::default()).unwrap_err(),
            "a.csv: expected a header line, found an empty file"
        );
    }

    /// A misspelt column, or a lacking time, is an error unless the user says something of the file.
    #[test]
    fn a_header_with_some_of_our_names_is_ours_until_flags_say_otherwise() {
        let misspelt = OURS.replace("time_s,", "time_s,x_comand_mm,").replace("\n0", "\n0,0");
        let message = read(&misspelt, &Request::default()).unwrap_err();
        assert!(message.starts_with("a.csv: line 1: x_comand_mm: expected a column time_s"), "{message}");
        assert!(message.contains("(a log of another program is read with --map"), "{message}");
        let timeless = "x_command_mm,x_motor_mm\n0,1\n1,2\n2,3\n";
        assert!(read(timeless, &Request::default()).unwrap_err().contains("time_s: expected this column"));
        let imported = read(timeless, &at_2_khz()).unwrap();
        assert!((imported.log.sample_time_s - 0.5e-3).abs() < 1e-12 && imported.log.axes.len() == 1);
    }

    #[test]
    fn a_text_without_numbers_is_told_what_our_own_log_has() {
        let message = read("Dear all,\nthe log is attached.\n", &Request::default()).unwrap_err();
        assert!(message.starts_with("a.csv: line 1: Dear all: expected a column time_s"), "{message}");
        assert!(read("Dear all\n", &at_2_khz()).unwrap_err().contains("expected rows of numbers"));
    }

    #[test]
    fn a_foreign_table_with_our_names_needs_no_flags() {
        let imported = read(&OURS.replace(',', ";"), &Request::default()).unwrap();
        let log = Log::parse(OURS.as_bytes(), "a.csv").unwrap();
        assert_eq!(imported.log.axes, log.axes);
        assert!(
            imported.notes.iter().any(|note| note.contains("recognised by content")),
            "{:?}",
            imported.notes
        );
        let message = read("t;x\n0;1\n1;2\n", &Request::default()).unwrap_err();
        assert!(
            message.contains("a.csv: line 1: expected --map OURS=THEIRS")
                && message.ends_with("import --help)"),
            "{message}"
        );
    }
}
