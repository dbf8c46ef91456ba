//! Logs of other programs.
//!
//! A foreign file is converted to a [`Log`] in four steps, each of which reports its assumptions:
//!
//! - [`read`]: bytes to a [`table`] of columns, by the [`mod@format`] that is recognised or requested: [`separated`] [`text`] of any
//!   [`dialect`], [`labelled`] rows, [`twincat`], [`matlab`], [`numpy`], [`parquet_table`], [`mcap_messages`]
//! - [`columns`]: by the [`request`] of the user, which column is which channel, with the
//!   [`conversion`] of its [`unit`](mod@unit); [`names`]: which column was meant
//! - [`ballbar`]: or the columns of a table of radii, which is not a log
//! - [`groups`]: columns of several clocks as rows of one
//! - [`clock`]: the times of a uniform clock; lost, repeated and late rows are counted and corrected; a velocity is replaced by its
//!   [`integral`]
//!
//! [`accelerations`] are no log, and have their own type.
//!
//! [`any_log`] also reads this program's own logs; every command that takes a log uses it. [`save`] writes a log as CSV, Parquet or MCAP.
//!
//! No data are invented: a channel that is not mapped is not in the log, and a time that neither the file nor the user gives is an error.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod accelerations;
pub mod any_log;
pub mod arrays;
pub mod ballbar;
pub mod budget;
pub mod clock;
pub mod columns;
pub mod conversion;
pub mod dialect;
pub mod format;
pub mod groups;
pub mod integral;
pub mod labelled;
pub mod matlab;
pub mod mcap_chunks;
pub mod mcap_messages;
pub mod names;
pub mod numbers;
pub mod numpy;
pub mod parquet_table;
pub mod read;
pub mod request;
// A page writes no files.
#[cfg(not(target_family = "wasm"))]
pub mod save;
pub mod separated;
pub mod table;
pub mod text;
pub mod twincat;
pub mod unit;

use ballbar::BallbarTable;
use files::error::InputError;
use files::log::Log;

use request::Request;

/// A log, with the assumptions and changes made during its conversion.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The log.
    pub log: Log,
    /// One sentence for each assumption and change.
    pub notes: Vec<String>,
}

/// The content of a foreign file.
#[derive(Clone, Debug)]
pub enum Foreign {
    /// A log.
    Log(Imported),
    /// A table of radii.
    Ballbar(BallbarTable),
}

/// Reads a foreign log or table of radii from its bytes; `source` is its name for messages.
///
/// # Errors
/// If it has no table of numbers, or lacks a requested column or time.
pub fn foreign(bytes: &[u8], source: &str, request: &Request) -> Result<Foreign, InputError> {
    let mut notes = Vec::new();
    let mut table = read::table(bytes, request.preset, source, &mut notes)?;
    if ballbar::is_asked(&table, request) {
        return Ok(Foreign::Ballbar(ballbar::of(&table, request, source, notes)?));
    }
    let mut chosen = columns::choose(&table, request, source, &mut notes)?;
    groups::join(&mut table, &mut chosen, source, &mut notes)?;
    let log = clock::uniform(&table, chosen, request.rate_hz, source, &mut notes)?;
    Ok(Foreign::Log(Imported { log, notes }))
}

/// Reads a foreign log from its bytes; `source` is its name for messages.
///
/// # Errors
/// As [`foreign`], and a table of radii, which is not a log.
pub fn of_bytes(bytes: &[u8], source: &str, request: &Request) -> Result<Imported, InputError> {
    match foreign(bytes, source, request)? {
        Foreign::Log(imported) => Ok(imported),
        Foreign::Ballbar(_) => Err(ballbar::no_log(source)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use request::Mapping;

    proptest! {
        /// Any text is a log or one line of an error.
        #[test]
        fn no_text_causes_a_panic(text in "([-0-9.,;\t a\u{b5}#e]{0,24}\n){0,12}", rate in proptest::option::of(1e-3..1e6_f64)) {
            let mappings = vec![Mapping { ours: "x_motor_mm".to_owned(), theirs: "1".to_owned() }];
            let request = Request { mappings, rate_hz: rate, ..Request::default() };
            if let Err(error) = of_bytes(text.as_bytes(), "a.txt", &request) {
                prop_assert_eq!(error.to_string().lines().count(), 1);
            }
        }
    }
}
