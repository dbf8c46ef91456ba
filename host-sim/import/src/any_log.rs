//! A log of our own or of another program, by its first line.
//!
//! A header with `time_s` and names of channels alone is that of our own log: a cell that is no number is an error, and rows at uneven
//! times are resampled as those of a foreign log, unless they go back. A header that has some of our names is taken for ours too if another one is nearly ours, so
//! that a misspelt column is an error and not left out; what the user says of the file makes it a foreign one. Every other file is imported,
//! unless it has no row of numbers: then it is told what a log of ours has.

use std::io::{Cursor, Read};
use std::path::Path;

use files::error::InputError;
use files::head::Head;
use files::log::{Log, Rows, TIME, channel_of};
use files::table::Table;

use crate::budget::Budget;
use crate::names::misspelt;
use crate::read::may_be_table;
use crate::request::Request;
use crate::{Foreign, Imported, ballbar, clock, foreign};

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
#[derive(Debug)]
enum Whose {
    /// `time_s` and channels alone, or nothing at all.
    Ours,
    /// Some names are ours, and another one is nearly ours, or there are no times.
    Nearly {
        /// The name of ours that the other one means.
        meant: Option<String>,
    },
    /// None is, or the others are further columns.
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
            let mut imported = own(head, source)?;
            if !request.is_empty() {
                let note = "its columns are those of a log of ours: --map, --unit, --rate and --preset are not applied to it";
                imported.notes.push(note.to_owned());
            }
            Ok(Foreign::Log(imported))
        }
        Whose::Nearly { meant } if request.is_empty() => {
            let advice =
                meant.map_or_else(|| ADVICE.to_owned(), |meant| format!("did you mean {meant}? {ADVICE}"));
            own(head, source).map(Foreign::Log).map_err(|error| error.with_advice(&advice))
        }
        Whose::Nearly { .. } | Whose::Foreign => {
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

/// Reads a log of ours; rows at uneven times are resampled, which is told.
fn own(head: Head<'_>, source: &str) -> Result<Imported, InputError> {
    let rows = Rows::of_table(Table::of_input(head.into_input(), source)?, source)?;
    let mut notes = Vec::new();
    let log = if rows.is_uniform() || rows.goes_back() {
        rows.uniform()?
    } else {
        clock::of_rows(rows, source, &mut notes)?
    };
    Ok(Imported { log, notes })
}

fn whose(head: &Head<'_>) -> Whose {
    let names = head.names();
    let is_ours = |name: &String| name == TIME || channel_of(name).is_some();
    let has_times = names.iter().any(|name| name == TIME);
    if head.is_blank() || names.iter().all(is_ours) && has_times {
        return Whose::Ours;
    }
    if !names.iter().any(is_ours) {
        return Whose::Foreign;
    }
    let meant = names.iter().find_map(|name| misspelt(name));
    if has_times && meant.is_none() { Whose::Foreign } else { Whose::Nearly { meant } }
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
        assert!(
            message.contains("(did you mean x_command_mm? a log of another program is read with"),
            "{message}"
        );
        let timeless = "x_command_mm,x_motor_mm\n0,1\n1,2\n2,3\n";
        assert!(read(timeless, &Request::default()).unwrap_err().contains("time_s: expected this column"));
        let imported = read(timeless, &at_2_khz()).unwrap();
        assert!((imported.log.sample_time_s - 0.5e-3).abs() < 1e-12 && imported.log.axes.len() == 1);
    }

    /// A line of 1 mm/s at 1 kHz, with rows changed; `None` removes one.
    fn line(change: impl Fn(usize, String) -> Option<String>) -> String {
        let row = |i: usize| change(i, format!("{:.6},{:.6}", 1e-3 * i as f64, 1e-3 * i as f64));
        let rows: String = (0..500).filter_map(row).map(|row| row + "\n").collect();
        format!("time_s,x_motor_mm\n{rows}")
    }

    /// The rows of the line, and which samples are no measurement.
    fn assert_on_line(text: &str, interpolated: &[std::ops::Range<usize>]) -> Vec<String> {
        let Imported { log, notes } = read(text, &Request::default()).unwrap();
        assert_eq!((log.len(), log.interpolated.as_slice()), (500, interpolated), "{notes:?}");
        for (i, x) in log.axes[0].motor.as_ref().unwrap().iter().enumerate() {
            assert!((x - 1e-3 * i as f64).abs() < 1e-6, "{i}: {x}");
        }
        notes
    }

    /// A lost row, a repeated one, and one that is late by 0.3 samples are no measurement; 30 µs of jitter are within the tenth of a sample
    /// from which a row is late.
    #[test]
    fn our_own_log_with_uneven_rows_is_resampled_and_this_is_told() {
        let lost =
            assert_on_line(&line(|i, row| (i != 100).then_some(row)), std::slice::from_ref(&(100..101)));
        assert!(lost[0].contains("1 of 500 rows are lost"), "{lost:?}");
        let repeated = line(|i, row| Some(if i == 200 { format!("{row}\n{row}") } else { row }));
        let repeated = assert_on_line(&repeated, &[]);
        assert!(repeated[0].contains("1 of 501 rows repeat a time"), "{repeated:?}");
        let at = |i: usize, late_ms: f64| {
            let time_s = 1e-3 * (i as f64 + late_ms);
            format!("{time_s:.7},{time_s:.7}")
        };
        let late = line(|i, row| Some(if i == 300 { at(i, 0.3) } else { row }));
        let late = assert_on_line(&late, std::slice::from_ref(&(300..301)));
        assert!(late[0].contains("1 of 500 rows are late or early"), "{late:?}");
        let jitter = |i: usize| {
            if i.is_multiple_of(499) { 0.0 } else { 0.03 * ((i * 7919) % 201) as f64 / 100.0 - 0.03 }
        };
        let Imported { log, .. } = read(&line(|i, _| Some(at(i, jitter(i)))), &Request::default()).unwrap();
        assert!(log.len() == 500 && log.interpolated.is_empty());
    }

    /// Two recordings, one after the other.
    #[test]
    fn our_own_log_whose_time_goes_back_is_refused() {
        let text = line(|_, row| Some(row));
        let twice = format!("{text}{}", text.split_once('\n').unwrap().1);
        let message = read(&twice, &Request::default()).unwrap_err();
        assert_eq!(message, "a.csv: line 502: time_s: expected a time after 0.499, found 0");
    }

    #[test]
    fn comments_and_further_columns_of_our_own_log_are_left_out() {
        let text = line(|i, row| Some(if i == 100 { format!("# a pause\n{row}") } else { row }));
        assert!(assert_on_line(&text, &[]).is_empty());
        let text = line(|_, row| Some(row + ",3000")).replace("motor_mm", "motor_mm,spindle_rpm");
        let notes = assert_on_line(&text, &[]);
        assert!(notes.iter().any(|note| note == "not used: \"spindle_rpm\""), "{notes:?}");
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
