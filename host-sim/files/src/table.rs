//! CSV tables of numbers with one header line. Invalid cells are errors that contain line and column.
//!
//! Logs and friction maps are such tables; the permitted columns are defined in their modules.

use std::fmt::Display;
use std::fs;
use std::io::{self, Read};
use std::path::Path;

use csv::{ByteRecord, Reader, ReaderBuilder};
use flate2::read::MultiGzDecoder;

use crate::error::{InputError, line_at, quoted};

/// First two bytes of a gzip file (RFC 1952).
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BYTE_ORDER_MARK: &str = "\u{feff}";

/// Largest absolute value of a measured value, in mm, degrees, N or N·m. A larger one has a wrong unit or decimal point.
const MAX_MEASURED: f64 = 1e9;

/// Reads the bytes of a file; `-` is standard input. A gzip file, recognised by the suffix `.gz` or by its first bytes, is
/// decompressed.
///
/// # Errors
/// If the file cannot be read, or is an incomplete gzip file.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, InputError> {
    let source = path.display().to_string();
    let bytes = if source == "-" { read_stdin() } else { fs::read(path) };
    let bytes = bytes.map_err(|cause| InputError::unreadable(&source, &cause))?;
    let has_suffix = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("gz"));
    if bytes.starts_with(&GZIP_MAGIC) || (has_suffix && !bytes.is_empty()) {
        unpack(&bytes, &source)
    } else {
        Ok(bytes)
    }
}

fn read_stdin() -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::stdin().lock().read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn unpack(packed: &[u8], source: &str) -> Result<Vec<u8>, InputError> {
    // The compression ratio of logs is about 8.
    let mut bytes = Vec::with_capacity(8 * packed.len());
    match MultiGzDecoder::new(packed).read_to_end(&mut bytes) {
        Ok(_) => Ok(bytes),
        Err(cause) => Err(InputError::new(source, format!("expected a complete gzip file: {cause}"))),
    }
}

/// The bytes as text, without the byte order mark.
fn decode<'a>(bytes: &'a [u8], source: &str) -> Result<&'a str, InputError> {
    let not_text = |at: usize| {
        let found = format!("byte 0x{:02X}", bytes[at]);
        InputError::expected(source, "a CSV text in UTF-8", found).at_line(line_at(bytes, at))
    };
    // A zero byte is valid UTF-8, but indicates a binary file.
    if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
        return Err(not_text(at));
    }
    let text = str::from_utf8(bytes).map_err(|error| not_text(error.valid_up_to()))?;
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    if text.trim().is_empty() {
        return Err(InputError::expected(source, "a header line", "an empty file"));
    }
    Ok(text)
}

/// A table that is read row by row.
pub struct Table<'a> {
    source: &'a str,
    text: &'a str,
    reader: Reader<&'a [u8]>,
    /// The last row that was read.
    record: ByteRecord,
    header_line: usize,
    names: Vec<String>,
}

impl<'a> Table<'a> {
    /// Reads the header; `source` is the file name for error messages.
    ///
    /// # Errors
    /// If the bytes are not UTF-8, or the text is empty.
    pub fn parse(bytes: &'a [u8], source: &'a str) -> Result<Self, InputError> {
        let text = decode(bytes, source)?;
        let mut table = Self {
            source,
            text,
            reader: reader(text),
            record: ByteRecord::new(),
            header_line: 1,
            names: Vec::new(),
        };
        table.advance()?;
        table.header_line = table.line_of(&table.record);
        table.names = table.record.iter().map(|name| trimmed(name).to_owned()).collect();
        Ok(table)
    }

    /// Names of the columns, trimmed.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The next row; `None` after the last one.
    ///
    /// # Errors
    /// If the number of cells differs from that of the header.
    pub fn next_row(&mut self) -> Result<Option<Row<'_>>, InputError> {
        if !self.advance()? {
            return Ok(None);
        }
        let (found, columns) = (self.record.len(), self.names.len());
        if found != columns {
            let expected = format!("{columns} values as in the header");
            let error = InputError::expected(self.source, expected, found);
            return Err(error.at_line(self.line_of(&self.record)));
        }
        Ok(Some(Row { table: self }))
    }

    /// An error at the header line.
    pub fn header_error(&self, expected: impl Display, found: impl Display) -> InputError {
        InputError::expected(self.source, expected, found).at_line(self.header_line)
    }

    /// An error at the line of a row, counted from 0 after the header. Reads the table again up to this row.
    pub fn row_error(&self, row: usize, expected: impl Display, found: impl Display) -> InputError {
        let error = InputError::expected(self.source, expected, found);
        match reader(self.text).into_byte_records().nth(row + 1) {
            Some(Ok(record)) => error.at_line(self.line_of(&record)),
            _ => error,
        }
    }

    fn advance(&mut self) -> Result<bool, InputError> {
        let read = self.reader.read_byte_record(&mut self.record);
        read.map_err(|error| InputError::new(self.source, error.to_string()))
    }

    /// The line of a row, computed from the position of its first byte. The line count of the reader stops at blank lines
    /// and is too small by one with CRLF.
    fn line_of(&self, record: &ByteRecord) -> usize {
        let bytes = self.text.as_bytes();
        let start = record.position().map_or(0, csv::Position::byte);
        let start = usize::try_from(start).unwrap_or(usize::MAX).min(bytes.len());
        let blank = bytes[start..].iter().take_while(|byte| b"\r\n".contains(byte)).count();
        line_at(bytes, start + blank)
    }
}

/// A reader that accepts rows of any length, so that [`Table::next_row`] reports the error.
fn reader(text: &str) -> Reader<&[u8]> {
    ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes())
}

/// A row; the number of its cells is that of the columns.
pub struct Row<'t> {
    table: &'t Table<'t>,
}

impl Row<'_> {
    /// Text of a cell, trimmed.
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn text(&self, column: usize) -> &str {
        trimmed(&self.table.record[column])
    }

    /// The cell as a finite number.
    ///
    /// # Errors
    /// If the cell does not contain a finite number.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn finite(&self, column: usize) -> Result<f64, InputError> {
        let parsed = self.text(column).parse().ok().filter(|value: &f64| value.is_finite());
        parsed.ok_or_else(|| self.cell_error(column, "a finite number"))
    }

    /// The cell as a measured value in mm, degrees, N or N·m: a number from −10⁹ to 10⁹.
    ///
    /// # Errors
    /// If the cell does not contain such a number.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn measured(&self, column: usize) -> Result<f64, InputError> {
        let value = self.finite(column)?;
        if value.abs() > MAX_MEASURED {
            return Err(self.cell_error(column, "a number from −1e9 to 1e9"));
        }
        Ok(value)
    }

    /// An error at a cell, which quotes the text of the cell.
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn cell_error(&self, column: usize, expected: &str) -> InputError {
        let text = String::from_utf8_lossy(&self.table.record[column]);
        let found = if text.trim().is_empty() { "nothing".to_owned() } else { quoted(&text) };
        let error = InputError::expected(self.table.source, expected, found);
        error.at_line(self.table.line_of(&self.table.record)).at_key(&self.table.names[column])
    }
}

/// A cell, trimmed. It is valid UTF-8, as the whole text is and commas and quotes are single bytes.
fn trimmed(cell: &[u8]) -> &str {
    str::from_utf8(cell).unwrap_or_default().trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str) -> Result<Vec<f64>, InputError> {
        let mut table = Table::parse(text.as_bytes(), "t.csv")?;
        let mut sums = Vec::new();
        while let Some(row) = table.next_row()? {
            sums.push(row.finite(0)? + row.measured(1)?);
        }
        Ok(sums)
    }

    #[test]
    fn spaces_blank_lines_and_quotes_are_ignored() {
        let text = "\u{feff} a ,\"b\"\r\n\r\n1, 2\r\n 3 ,\"4\"\r\n\r\n";
        assert_eq!(Table::parse(text.as_bytes(), "t.csv").unwrap().names(), ["a", "b"]);
        assert_eq!(rows(text).unwrap(), [3.0, 7.0]);
    }

    #[test]
    fn errors_name_line_column_and_cell() {
        let message = |text: &str| rows(text).unwrap_err().to_string();
        assert_eq!(message("a,b\n\n1,x\n"), "t.csv: line 3: b: expected a finite number, found \"x\"");
        assert_eq!(message("a,b\r\n1, \r\n"), "t.csv: line 2: b: expected a finite number, found nothing");
        assert_eq!(
            message("a,b\n1,2e9\n"),
            "t.csv: line 2: b: expected a number from −1e9 to 1e9, found \"2e9\""
        );
        assert_eq!(message("a,b\n1\n"), "t.csv: line 2: expected 2 values as in the header, found 1");
        assert!(rows("a,b\n2e9,1\n").is_ok());
    }

    #[test]
    fn errors_of_header_and_row_contain_the_line() {
        let table = Table::parse(b"\na,b\n1,2\n\n3,4\n", "t.csv").unwrap();
        assert_eq!(table.header_error("X", "Y").to_string(), "t.csv: line 2: expected X, found Y");
        assert_eq!(table.row_error(1, "X", "Y").to_string(), "t.csv: line 5: expected X, found Y");
    }
}
