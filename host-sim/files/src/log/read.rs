//! Reading a log: strict, so that nothing is computed from a table that is not what it seems.

use std::fmt::Display;
use std::fs;
use std::io::{self, Read};
use std::path::Path;
use std::str;

use csv::{ByteRecord, Reader, ReaderBuilder};
use flate2::read::MultiGzDecoder;

use super::clock::{self, Irregular};
use super::{AxisLog, Channel, Log, Unit};
use crate::axis_name::is_axis_name;
use crate::error::{InputError, line_at, quoted, shortened};
use crate::number;

const TIME: &str = "time_s";
const ALLOWED: &str = "time_s, NAME_command|motor|table|tool_mm|deg or NAME_force|added_force_n|nm";
const GZIP: [u8; 2] = [0x1f, 0x8b];
const BYTE_ORDER_MARK: &str = "\u{feff}";

impl Log {
    /// Reads a log; `-` is standard input, and gzip is recognised by its name or its first bytes.
    ///
    /// # Errors
    /// If it cannot be read, is no table of the known columns, or is not uniformly sampled.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let source = path.display().to_string();
        Self::parse(&table_bytes(path, &source)?, &source)
    }

    /// Reads a log from the bytes of a CSV file; `source` is for messages.
    ///
    /// # Errors
    /// If the bytes are no table of the known columns, or not uniformly sampled.
    pub fn parse(bytes: &[u8], source: &str) -> Result<Self, InputError> {
        let text = checked_text(bytes, source)?;
        let table = Table { text, source };
        let mut rows = table.rows();
        let mut record = ByteRecord::new();
        table.next(&mut rows, &mut record)?;
        let header = Header::parse(&table, &record)?;
        let (columns, decimals) = table.columns(&header, &mut rows)?;
        let times_s = &columns[header.time];
        if times_s.len() < 2 {
            let found = if times_s.is_empty() { "none" } else { "one" };
            return Err(InputError::expected(source, "two samples or more", found));
        }
        let sample_time_s = clock::sample_time_s(times_s, decimals)
            .map_err(|irregular| table.irregular(times_s, &irregular))?;
        let start_s = times_s[0];
        Ok(Self { source: source.to_owned(), start_s, sample_time_s, axes: header.axes(columns) })
    }
}

/// The bytes of a table, unpacked; `-` is standard input.
///
/// # Errors
/// If they cannot be read, or are half a gzip file.
pub fn table_bytes(path: &Path, source: &str) -> Result<Vec<u8>, InputError> {
    let bytes = if source == "-" { stdin() } else { fs::read(path) };
    let bytes = bytes.map_err(|cause| InputError::unreadable(source, &cause))?;
    let named_gzip = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("gz"));
    if bytes.starts_with(&GZIP) || (named_gzip && !bytes.is_empty()) {
        unpacked(&bytes, source)
    } else {
        Ok(bytes)
    }
}

fn stdin() -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::stdin().lock().read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn unpacked(bytes: &[u8], source: &str) -> Result<Vec<u8>, InputError> {
    let mut unpacked = Vec::with_capacity(8 * bytes.len());
    match MultiGzDecoder::new(bytes).read_to_end(&mut unpacked) {
        Ok(_) => Ok(unpacked),
        Err(cause) => Err(InputError::saying(source, format!("expected a whole gzip file: {cause}"))),
    }
}

/// The bytes as a text that is not empty, without its byte order mark.
///
/// # Errors
/// If they are no text, or an empty one.
pub fn checked_text<'a>(bytes: &'a [u8], source: &str) -> Result<&'a str, InputError> {
    let not_text = |at: usize| {
        let found = format!("byte 0x{:02X}", bytes[at]);
        InputError::expected(source, "a CSV text in UTF-8", found).at_line(line_at(bytes, at))
    };
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

/// The text of a log, and what to call it.
struct Table<'a> {
    text: &'a str,
    source: &'a str,
}

impl<'a> Table<'a> {
    fn rows(&self) -> Reader<&'a [u8]> {
        let mut builder = ReaderBuilder::new();
        // Rows of another length are refused here, with our words.
        builder.has_headers(false).flexible(true).from_reader(self.text.as_bytes())
    }

    /// The next row, if there is one.
    fn next(&self, rows: &mut Reader<&'a [u8]>, record: &mut ByteRecord) -> Result<bool, InputError> {
        rows.read_byte_record(record).map_err(|error| InputError::saying(self.source, error.to_string()))
    }

    /// All values, column by column, and the most decimals that a time was printed with.
    fn columns(
        &self,
        header: &Header,
        rows: &mut Reader<&'a [u8]>,
    ) -> Result<(Vec<Vec<f64>>, usize), InputError> {
        let mut record = ByteRecord::new();
        let mut columns = vec![Vec::new(); header.names.len()];
        let mut decimals = 0;
        while self.next(rows, &mut record)? {
            if record.len() != columns.len() {
                let what = format!("{} values as in the header", columns.len());
                return Err(self.refuse(&record, &what, record.len()));
            }
            let fields = columns.iter_mut().zip(&record).zip(&header.names).enumerate();
            for (i, ((column, field), name)) in fields {
                let refuse = |what| self.refuse(&record, what, number::found(field)).at_key(name);
                let value = if i == header.time { number::finite(field) } else { number::measured(field) };
                let value = value.map_err(refuse)?;
                column.push(value);
            }
            decimals = decimals.max(printed_decimals(&record[header.time]));
        }
        Ok((columns, decimals))
    }

    fn refuse(&self, record: &ByteRecord, what: &str, found: impl Display) -> InputError {
        let error = InputError::expected(self.source, what, found);
        error.at_line(self.line(record))
    }

    /// Counted from the row's first byte: the reader's own count stands still at blank lines and
    /// is one short at CRLF.
    fn line(&self, record: &ByteRecord) -> usize {
        let bytes = self.text.as_bytes();
        let start = record.position().map_or(0, csv::Position::byte);
        let start = usize::try_from(start).unwrap_or(usize::MAX).min(bytes.len());
        let blank = bytes[start..].iter().take_while(|byte| b"\r\n".contains(byte)).count();
        line_at(bytes, start + blank)
    }

    fn irregular(&self, times_s: &[f64], irregular: &Irregular) -> InputError {
        let time_s = times_s[irregular.sample];
        let expected_s = decimal(irregular.expected_s);
        let what = if irregular.backwards {
            format!("a time after {}", decimal(times_s[irregular.sample - 1]))
        } else {
            format!("{expected_s} (uniform sampling without gaps)")
        };
        // One more row than samples: the header.
        let record = self.rows().into_byte_records().nth(irregular.sample + 1);
        let error = match record {
            Some(Ok(record)) => self.refuse(&record, &what, decimal(time_s)),
            _ => InputError::expected(self.source, what, decimal(time_s)),
        };
        error.at_key(TIME)
    }
}

/// A time without the noise of its last bits.
fn decimal(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}

/// Digits after the point. A time with an exponent counts as exact.
fn printed_decimals(field: &[u8]) -> usize {
    let field = field.trim_ascii();
    match field.iter().position(|&byte| byte == b'.') {
        Some(point) => field.len() - point - 1,
        None => 0,
    }
}

/// What the columns are.
struct Header {
    names: Vec<String>,
    time: usize,
    /// Axis (an index into `axes`) and channel of each column but `time_s`.
    channels: Vec<Option<(usize, Channel)>>,
    axes: Vec<AxisLog>,
}

impl Header {
    fn parse(table: &Table<'_>, record: &ByteRecord) -> Result<Self, InputError> {
        let refuse = |what: &str, found: String| table.refuse(record, what, found);
        let text = |field: &[u8]| String::from_utf8_lossy(field.trim_ascii()).into_owned();
        let names: Vec<String> = record.iter().map(text).collect();
        if let [only] = &names[..]
            && let Some(other) = only.chars().find(|c| matches!(c, ';' | '\t'))
        {
            return Err(refuse("commas between the columns", quoted(&other.to_string())));
        }
        let mut header = Self { names, time: 0, channels: Vec::new(), axes: Vec::new() };
        for index in 0..header.names.len() {
            header
                .add(index)
                .map_err(|(what, found)| refuse(&what, found).at_key(&shown(&header.names[index])))?;
        }
        let Some(time) = header.channels.iter().position(Option::is_none) else {
            return Err(refuse("this column", "none".to_owned()).at_key(TIME));
        };
        if header.axes.is_empty() {
            return Err(refuse(&format!("a column of an axis ({ALLOWED})"), "none".to_owned()));
        }
        Ok(Self { time, ..header })
    }

    /// Finds out what a column is; what was expected and what was found, if it is nothing.
    fn add(&mut self, index: usize) -> Result<(), (String, String)> {
        let name = self.names[index].clone();
        if self.names[..index].contains(&name) {
            return Err(("one column of this name".to_owned(), "a second one".to_owned()));
        }
        if name == TIME {
            self.channels.push(None);
            return Ok(());
        }
        let Some((axis, channel, unit)) = split(&name) else {
            return Err((format!("a column {ALLOWED}"), quoted(&name)));
        };
        let known = self.axes.iter().position(|known| known.name == axis);
        let axis = known.unwrap_or_else(|| {
            self.axes.push(AxisLog::new(axis, unit));
            self.axes.len() - 1
        });
        let wanted = self.axes[axis].unit;
        if unit != wanted {
            let first = self.channels.iter().position(|c| c.is_some_and(|(a, _)| a == axis));
            let first = first.map_or("", |column| &self.names[column]);
            let wanted = wanted.suffix(channel);
            return Err((format!("unit {wanted} as {first} has it"), unit.suffix(channel).into()));
        }
        self.channels.push(Some((axis, channel)));
        Ok(())
    }

    fn axes(self, columns: Vec<Vec<f64>>) -> Vec<AxisLog> {
        let mut axes = self.axes;
        for (column, channel) in columns.into_iter().zip(self.channels) {
            if let Some((axis, channel)) = channel {
                *axes[axis].channel_mut(channel) = Some(column);
            }
        }
        axes
    }
}

/// A column's name in a message: whatever was found there, short and visible.
fn shown(name: &str) -> String {
    if name.is_empty() { "unnamed column".to_owned() } else { shortened(name) }
}

/// Axis, channel and unit of a column. The longest ending wins: `x_added_force_n` is not the force
/// of an axis `x_added`.
fn split(name: &str) -> Option<(&str, Channel, Unit)> {
    let endings = Channel::ALL.iter().rev().flat_map(|&channel| {
        Unit::ALL.map(|unit| (format!("_{}_{}", channel.word(), unit.suffix(channel)), channel, unit))
    });
    let mut matching = endings.filter_map(|(ending, channel, unit)| {
        name.strip_suffix(ending.as_str()).map(|axis| (axis, channel, unit))
    });
    matching.next().filter(|(axis, ..)| is_axis_name(axis))
}
