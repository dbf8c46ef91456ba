//! Reading a log.

use std::path::Path;

use super::clock::{self, Irregular};
use super::{AxisLog, Channel, Log, Quantity, Unit};
use crate::axis_name::is_axis_name;
use crate::error::{InputError, quoted, shortened};
use crate::table::Table;

/// Name of the column of the times.
pub const TIME: &str = "time_s";
/// What the columns of a log may be called, for messages.
pub const ALLOWED: &str = "time_s, or, of an axis x: x_command_mm, x_motor_mm, x_table_mm, x_tool_mm, x_force_n, x_added_force_n, x_temperature_c (rotary: _deg and _nm)";

impl Log {
    /// Reads a log; `-` is standard input, and gzip is recognised by the suffix or the first bytes.
    ///
    /// # Errors
    /// If the file cannot be read, is not a table with the known columns, or is not uniformly sampled.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let source = path.display().to_string();
        Self::of_table(Table::open(path, &source)?, &source)
    }

    /// Reads a log from the bytes of a CSV file; `source` is the file name for error messages.
    ///
    /// # Errors
    /// If the bytes are not a table with the known columns, or not uniformly sampled.
    pub fn parse(bytes: &[u8], source: &str) -> Result<Self, InputError> {
        Self::of_table(Table::parse(bytes, source)?, source)
    }

    /// Reads a log from an opened table; `source` is the file name for error messages.
    ///
    /// # Errors
    /// As [`Log::parse`].
    pub fn of_table(table: Table<'_>, source: &str) -> Result<Self, InputError> {
        Rows::of_table(table, source)?.uniform()
    }
}

/// The rows of a log, at times that may be uneven.
#[derive(Debug)]
pub struct Rows {
    source: String,
    /// Times of the rows, s.
    pub times_s: Vec<f64>,
    /// The axes, with a sample of each channel for each row.
    pub axes: Vec<AxisLog>,
    /// The period of a uniform clock with these times, s, or why there is none.
    period_s: Result<f64, InputError>,
}

impl Rows {
    /// Reads the rows of a log from an opened table; `source` is the file name for error messages.
    ///
    /// # Errors
    /// If the table has other columns than those of a log, or fewer than two rows.
    pub fn of_table(mut table: Table<'_>, source: &str) -> Result<Self, InputError> {
        let header = Header::parse(&table)?;
        let (mut columns, decimals) = read_columns(&mut table, header.time)?;
        let times_s = std::mem::take(&mut columns[header.time]);
        if times_s.len() < 2 {
            let found = if times_s.is_empty() { "none" } else { "one" };
            return Err(InputError::expected(source, "two samples or more", found));
        }
        let period_s = clock::sample_time_s(&times_s, decimals)
            .map_err(|irregular| irregular_time(&table, &times_s, &irregular));
        Ok(Self { source: source.to_owned(), times_s, axes: header.axes(columns), period_s })
    }

    /// Whether the times are those of a uniform clock.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        self.period_s.is_ok()
    }

    /// Whether a time is before that of the row before by more than a period: another recording, or a clock that was set.
    #[must_use]
    pub fn goes_back(&self) -> bool {
        let steps: Vec<f64> = self.times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let period_s = numerics::median(&steps).unwrap_or_default();
        steps.iter().any(|&step_s| step_s < -period_s)
    }

    /// The log.
    ///
    /// # Errors
    /// If the times are not those of a uniform clock.
    pub fn uniform(self) -> Result<Log, InputError> {
        Ok(Log::new(self.source, self.times_s[0], self.period_s?, self.axes))
    }
}

/// All values, column by column, and the largest number of decimals of a printed time.
fn read_columns(table: &mut Table<'_>, time: usize) -> Result<(Vec<Vec<f64>>, usize), InputError> {
    let mut columns = vec![Vec::new(); table.names().len()];
    let mut decimals = 0;
    while let Some(row) = table.next_row()? {
        for (i, column) in columns.iter_mut().enumerate() {
            column.push(if i == time { row.finite(i)? } else { row.measured(i)? });
        }
        decimals = decimals.max(printed_decimals(row.text(time)));
    }
    Ok((columns, decimals))
}

fn irregular_time(table: &Table<'_>, times_s: &[f64], irregular: &Irregular) -> InputError {
    let expected = if irregular.is_backward {
        format!("a time after {}", rounded(times_s[irregular.sample - 1]))
    } else {
        format!("{} (uniform sampling without gaps)", rounded(irregular.expected_s))
    };
    table.row_error(irregular.sample, expected, rounded(times_s[irregular.sample])).at_key(TIME)
}

/// A time rounded to nanoseconds, which removes the rounding error of binary fractions.
fn rounded(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}

/// Number of digits after the decimal point; 0 without a point.
fn printed_decimals(time: &str) -> usize {
    time.split_once('.').map_or(0, |(_, decimals)| decimals.len())
}

/// Contents of the columns.
struct Header {
    /// Column of the times.
    time: usize,
    /// Axis (an index into `axes`) and channel of each column; `None` for `time_s`.
    channels: Vec<Option<(usize, Channel)>>,
    axes: Vec<AxisLog>,
}

impl Header {
    fn parse(table: &Table<'_>) -> Result<Self, InputError> {
        let names = table.names();
        if let [only] = names
            && let Some(other) = only.chars().find(|c| matches!(c, ';' | '\t'))
        {
            return Err(table.header_error("commas between the columns", quoted(&other.to_string())));
        }
        let mut header = Self { time: 0, channels: Vec::new(), axes: Vec::new() };
        for (index, name) in names.iter().enumerate() {
            let added = header.add(names, index);
            added.map_err(|(expected, found)| table.header_error(expected, found).at_key(&visible(name)))?;
        }
        let Some(time) = header.channels.iter().position(Option::is_none) else {
            return Err(table.header_error("this column", "none").at_key(TIME));
        };
        if header.axes.is_empty() {
            return Err(table.header_error(format!("a column of an axis ({ALLOWED})"), "none"));
        }
        Ok(Self { time, ..header })
    }

    /// Adds the next of the columns. An error contains what was expected and what was found.
    fn add(&mut self, names: &[String], index: usize) -> Result<(), (String, String)> {
        let (before, name) = (&names[..index], &names[index]);
        if before.contains(name) {
            return Err(("one column of this name".to_owned(), "a second one".to_owned()));
        }
        if name == TIME {
            self.channels.push(None);
            return Ok(());
        }
        let Some((axis, channel, unit)) = channel_of(name) else {
            return Err((format!("a column {ALLOWED}"), quoted(name)));
        };
        let known = self.axes.iter().position(|known| known.name == axis);
        let axis = known.unwrap_or_else(|| {
            let of_others = || unit_of_axis(axis, names.iter().map(String::as_str));
            self.axes.push(AxisLog::new(axis, unit.or_else(of_others).unwrap_or(Unit::Millimetre)));
            self.axes.len() - 1
        });
        let expected = self.axes[axis].unit;
        if let Some(unit) = unit.filter(|unit| *unit != expected) {
            let has_unit = |channel: Channel| channel.quantity() != Quantity::Temperature;
            let is_of_axis = |(of, channel): (usize, Channel)| of == axis && has_unit(channel);
            let first = self.channels.iter().position(|column| column.is_some_and(is_of_axis));
            let first = first.map_or("", |column| &before[column]);
            let expected = expected.suffix(channel);
            return Err((format!("unit {expected} as in {first}"), unit.suffix(channel).into()));
        }
        self.channels.push(Some((axis, channel)));
        Ok(())
    }

    /// The axes with the samples of their channels.
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

/// The name of a column in a message. The first line of a file may contain any text.
fn visible(name: &str) -> String {
    if name.is_empty() { "unnamed column".to_owned() } else { shortened(name) }
}

/// The unit of an axis, by the first of these columns that shows it.
pub fn unit_of_axis<'a>(axis: &str, names: impl Iterator<Item = &'a str>) -> Option<Unit> {
    names.filter_map(channel_of).find_map(|(of, _, unit)| unit.filter(|_| of == axis))
}

/// Axis, channel and unit from the name of a column. The longest suffix is used: `x_added_force_n` is not the force of an
/// axis `x_added`. `None`: it is no channel. A temperature does not show the unit of its axis.
#[must_use]
pub fn channel_of(name: &str) -> Option<(&str, Channel, Option<Unit>)> {
    let suffixes = Channel::ALL.iter().rev().flat_map(|&channel| {
        Unit::ALL.map(|unit| (format!("_{}_{}", channel.word(), unit.suffix(channel)), channel, unit))
    });
    let mut matching = suffixes.filter_map(|(suffix, channel, unit)| {
        let unit = (channel.quantity() != Quantity::Temperature).then_some(unit);
        name.strip_suffix(suffix.as_str()).map(|axis| (axis, channel, unit))
    });
    matching.next().filter(|(axis, ..)| is_axis_name(axis))
}
