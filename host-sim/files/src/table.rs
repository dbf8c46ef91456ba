//! CSV tables of numbers with one header line. Invalid cells are errors that contain line and column.
//!
//! Logs and friction maps are such tables; the permitted columns are defined in their modules. A file is read in
//! [`segments`](crate::segments), so that its text is never in memory as a whole.

use std::fmt::Display;
use std::io::{Cursor, Read};
use std::path::Path;

use csv::{ByteRecord, Reader, ReaderBuilder};

use crate::error::{InputError, line_at, quoted};
use crate::segments::{Segments, open};

/// Largest absolute value of a measured value, in mm, degrees, N or N·m. A larger one has a wrong unit or decimal point.
pub const MAX_MEASURED: f64 = 1e9;

/// A table that is read row by row.
pub struct Table<'a> {
    source: &'a str,
    segments: Segments<'a>,
    /// Reads the current segment.
    reader: Reader<Cursor<Vec<u8>>>,
    /// The last row that was read.
    record: ByteRecord,
    /// Offset in the current segment up to which its lines are counted, and the line there.
    counted: (usize, usize),
    /// Line of the last row that was read.
    line: usize,
    header_line: usize,
    /// Number of rows that were read.
    rows: usize,
    /// Rows after which the distance to the header's line, in lines, changes, with the new distance: blank lines.
    gaps: Vec<(usize, usize)>,
    names: Vec<String>,
}

impl<'a> Table<'a> {
    /// Opens a file and reads the header; `-` is standard input. A gzip file, recognised by the suffix `.gz` or by its first
    /// bytes, is decompressed. `source` is the file name for error messages.
    ///
    /// # Errors
    /// If the file cannot be read, is an incomplete gzip file, is not UTF-8, or is empty.
    pub fn open(path: &Path, source: &'a str) -> Result<Self, InputError> {
        Self::of_input(open(path, source)?, source)
    }

    /// Reads the header; `source` is the file name for error messages.
    ///
    /// # Errors
    /// If the bytes are not UTF-8, or the text is empty.
    pub fn parse(bytes: &'a [u8], source: &'a str) -> Result<Self, InputError> {
        Self::of_input(Box::new(bytes), source)
    }

    /// Reads the header of an opened input; `source` is the file name for error messages.
    ///
    /// # Errors
    /// As [`Table::open`], except that the input is already unpacked.
    pub fn of_input(input: Box<dyn Read + 'a>, source: &'a str) -> Result<Self, InputError> {
        let mut segments = Segments::new(input, source);
        let Some(first) = segments.next_segment()?.filter(|text| !text.trim_ascii().is_empty()) else {
            return Err(InputError::expected(source, "a header line", "an empty file"));
        };
        let mut table = Self {
            source,
            segments,
            reader: reader(first),
            record: ByteRecord::new(),
            counted: (0, 1),
            line: 1,
            header_line: 1,
            rows: 0,
            gaps: Vec::new(),
            names: Vec::new(),
        };
        table.advance()?;
        table.header_line = table.line;
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
    /// If the number of cells differs from that of the header, or the file cannot be read on.
    pub fn next_row(&mut self) -> Result<Option<Row<'_, 'a>>, InputError> {
        if !self.advance()? {
            return Ok(None);
        }
        let (found, columns) = (self.record.len(), self.names.len());
        if found != columns {
            let expected = format!("{columns} values as in the header");
            let error = InputError::expected(self.source, expected, found);
            return Err(error.at_line(self.line));
        }
        let distance = self.line - self.header_line - self.rows;
        if self.gaps.last().map_or(1, |(_, distance)| *distance) != distance {
            self.gaps.push((self.rows, distance));
        }
        self.rows += 1;
        Ok(Some(Row { table: self }))
    }

    /// An error at the header line.
    pub fn header_error(&self, expected: impl Display, found: impl Display) -> InputError {
        InputError::expected(self.source, expected, found).at_line(self.header_line)
    }

    /// An error at the line of a row that was read, counted from 0 after the header.
    pub fn row_error(&self, row: usize, expected: impl Display, found: impl Display) -> InputError {
        let before = self.gaps.partition_point(|(first, _)| *first <= row);
        let distance = before.checked_sub(1).map_or(1, |gap| self.gaps[gap].1);
        let error = InputError::expected(self.source, expected, found);
        error.at_line(self.header_line + row + distance)
    }

    /// Reads the next record, of the next segment if there is none left in this one.
    fn advance(&mut self) -> Result<bool, InputError> {
        loop {
            let read = self.reader.read_byte_record(&mut self.record);
            if read.map_err(|error| InputError::new(self.source, error.to_string()))? {
                let start = self.record.position().map_or(0, csv::Position::byte);
                let start = usize::try_from(start).unwrap_or(usize::MAX);
                let text = self.reader.get_ref().get_ref();
                // A comment that ends with the text is read as a record without cells.
                if text.get(start..).is_some_and(|rest| skipped(rest) < rest.len()) {
                    self.line = self.line_at(start);
                    return Ok(true);
                }
            }
            let end = self.reader.get_ref().get_ref().len();
            let line = self.line_at(end);
            let Some(next) = self.segments.next_segment()? else { return Ok(false) };
            self.reader = reader(next);
            self.counted = (0, line);
        }
    }

    /// The line of the record at an offset of the segment, which is at or after that of the last call. The line count of the
    /// reader stops at blank lines and is too small by one with CRLF.
    fn line_at(&mut self, start: usize) -> usize {
        let text = self.reader.get_ref().get_ref();
        let start = start.min(text.len());
        let blank = skipped(&text[start..]);
        let (from, line) = self.counted;
        let line =
            line + line_at(&text[from.min(start + blank)..], start + blank - from.min(start + blank)) - 1;
        self.counted = (start + blank, line);
        line
    }
}

/// First character of a line that is a comment.
const COMMENT: u8 = b'#';

/// A reader that skips comments and accepts rows of any length, so that [`Table::next_row`] reports the error.
fn reader(text: Vec<u8>) -> Reader<Cursor<Vec<u8>>> {
    ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(COMMENT))
        .from_reader(Cursor::new(text))
}

/// Number of bytes before the next record: blank lines and comments.
fn skipped(text: &[u8]) -> usize {
    let mut at = 0;
    loop {
        match text.get(at) {
            Some(b'\r' | b'\n') => at += 1,
            Some(&COMMENT) => {
                at += text[at..].iter().position(|&byte| byte == b'\n').unwrap_or(text.len() - at);
            }
            _ => return at,
        }
    }
}

/// A row; the number of its cells is that of the columns.
pub struct Row<'t, 'a> {
    table: &'t Table<'a>,
}

impl Row<'_, '_> {
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
        error.at_line(self.table.line).at_key(&self.table.names[column])
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
    fn comments_are_skipped_and_counted_as_lines() {
        let text = "# by a tool\na,b\n1,2\n# pause, of 3 s\r\n\n# again\n3,4\n#end";
        assert_eq!(rows(text).unwrap(), [3.0, 7.0]);
        let message = |text: &str| rows(text).unwrap_err().to_string();
        assert_eq!(
            message(&text.replace("3,4", "3,x")),
            "t.csv: line 7: b: expected a finite number, found \"x\""
        );
        let mut table = Table::parse(text.as_bytes(), "t.csv").unwrap();
        while table.next_row().unwrap().is_some() {}
        assert_eq!(table.row_error(1, "X", "Y").to_string(), "t.csv: line 7: expected X, found Y");
    }

    #[test]
    fn errors_of_header_and_row_contain_the_line() {
        let mut table = Table::parse(b"\na,b\n1,2\n\n3,4\n", "t.csv").unwrap();
        while table.next_row().unwrap().is_some() {}
        assert_eq!(table.header_error("X", "Y").to_string(), "t.csv: line 2: expected X, found Y");
        assert_eq!(table.row_error(1, "X", "Y").to_string(), "t.csv: line 5: expected X, found Y");
    }
}
