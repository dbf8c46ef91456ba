//! From the bytes of a file to its columns, in whatever format they are.

use files::error::InputError;

use crate::arrays;
use crate::budget::Budget;
use crate::dialect::Dialect;
use crate::format::Format;
use crate::table::{ForeignColumn, ForeignTable};
use crate::{accelerations, labelled, matlab, mcap_messages, numpy, parquet_table, separated, text, twincat};

/// The columns of a file; `preset` is the format, if it is not to be recognised by content.
///
/// # Errors
/// If the file is not of that format, is broken, or unpacks to more than [`Budget::file`].
pub fn table(
    bytes: &[u8],
    preset: Option<Format>,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<ForeignTable, InputError> {
    let format = preset.or_else(|| Format::of_binary(bytes));
    let columns = match format {
        Some(Format::Matlab) => arrays::columns(matlab::arrays(bytes, Budget::file(), source, notes)?, notes),
        Some(Format::Numpy) => arrays::columns(numpy::arrays(bytes, Budget::file(), source, notes)?, notes),
        Some(Format::Parquet) => parquet_table::columns(bytes, Budget::file(), source, notes)?,
        Some(Format::Mcap) => mcap_messages::columns(bytes, Budget::file(), source, notes)?,
        _ => return of_text(&text::decode(bytes, source, notes)?, preset, source, notes),
    };
    binary(format.unwrap_or(Format::Text), preset, columns, source, notes)
}

/// Whether bytes may be a table: a binary file of a known format, or a text with a row of numbers.
#[must_use]
pub fn may_be_table(bytes: &[u8]) -> bool {
    let has_rows = |text: String| {
        let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
        Dialect::of(&lines).is_some()
    };
    let is_table = |text: String| labelled::is_log(&text) || has_rows(text);
    Format::of_binary(bytes).is_some() || text::decode(bytes, "", &mut Vec::new()).is_ok_and(is_table)
}

/// The columns of a text.
fn of_text(
    text: &str,
    preset: Option<Format>,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<ForeignTable, InputError> {
    let recognised = || match text {
        _ if accelerations::is_table(text) => Some(Format::Klipper),
        _ if twincat::is_export(text) => Some(Format::Twincat),
        _ => None,
    };
    match preset.or_else(recognised) {
        Some(Format::Klipper) => Err(InputError::new(
            source,
            "accelerations that Klipper recorded: a log has positions and forces, to which accelerations cannot be integrated without \
             drift; `lost-motion resonances` finds the resonances in them",
        )),
        Some(Format::Twincat) => twincat::parse(text, preset, source, notes),
        Some(Format::Halscope) | None if labelled::is_log(text) => {
            labelled::parse(text, preset, source, notes)
        }
        _ => separated::parse(text, preset, source, notes),
    }
}

/// The table of a binary file.
fn binary(
    format: Format,
    preset: Option<Format>,
    columns: Vec<ForeignColumn>,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<ForeignTable, InputError> {
    if columns.is_empty() {
        let read = notes.last().map_or("none", String::as_str);
        return Err(InputError::expected(source, "columns of numbers", read));
    }
    notes.push(format!("{}: {} columns", format.said(preset), columns.len()));
    Ok(ForeignTable { format, columns, period_s: None, header_line: None })
}
