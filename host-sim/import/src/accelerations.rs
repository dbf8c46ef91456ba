//! Accelerations of a sensor at the tool, as Klipper records them: `#time,accel_x,accel_y,accel_z` in s and mm/s².
//!
//! They are no log: a log has positions, to which accelerations cannot be integrated without drift. What they show are resonances.

use std::path::Path;

use files::error::InputError;
use files::head::Head;

use crate::budget::Budget;
use crate::format::Format;
use crate::separated;
use crate::table::ForeignTable;

/// Names of the columns of the axes.
const AXES: [(&str, &str); 3] = [("x", "accel_x"), ("y", "accel_y"), ("z", "accel_z")];

/// Share of rows that may be lost: a spectrum of the others is too wrong beyond it.
const MOST_LOST: f64 = 0.02;

/// Whether a text is a table of accelerations. Newer versions of Klipper write a line of statistics before the header.
#[must_use]
pub fn is_table(text: &str) -> bool {
    text.lines().take(2).any(|line| line.trim_end() == "#time,accel_x,accel_y,accel_z")
}

/// Accelerations at a uniform rate.
#[derive(Clone, Debug)]
pub struct Accelerations {
    /// File name, for messages.
    pub source: String,
    /// Samples per second: those between the first and the last time.
    pub rate_hz: f64,
    /// Name of each axis of the sensor, and its accelerations, m/s².
    pub axes: Vec<(&'static str, Vec<f64>)>,
    /// What was assumed.
    pub notes: Vec<String>,
}

/// Reads a table of accelerations; `-` is standard input, and gzip is recognised.
///
/// # Errors
/// If the file is no such table, its times do not increase, or more than 2 % of its rows are lost.
pub fn read(path: &Path) -> Result<Accelerations, InputError> {
    let source = path.display().to_string();
    let bytes = Budget::file().read(Head::open(path, &source)?.into_input(), &source)?;
    parse(&String::from_utf8_lossy(&bytes), &source)
}

/// Reads a table of accelerations; `source` is its name for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, source: &str) -> Result<Accelerations, InputError> {
    if !is_table(text) {
        let first = text.lines().next().unwrap_or_default();
        let expected = "accelerations as Klipper records them, with the header #time,accel_x,accel_y,accel_z";
        return Err(InputError::expected(source, expected, files::error::quoted(first)));
    }
    let mut notes = Vec::new();
    let table = separated::parse(text, Some(Format::Klipper), source, &mut notes)?;
    // The first note tells the format, of which there is only one here.
    notes.drain(..1);
    let times_s = column(&table, "time", source)?;
    let rate_hz = rate_hz(times_s, source, &mut notes)?;
    let axis = |(axis, name): (&'static str, &str)| {
        let mm_per_s2 = column(&table, name, source)?;
        Ok((axis, mm_per_s2.iter().map(|value| 1e-3 * value).collect()))
    };
    let axes = AXES.into_iter().map(axis).collect::<Result<_, InputError>>()?;
    Ok(Accelerations { source: source.to_owned(), rate_hz, axes, notes })
}

fn column<'a>(table: &'a ForeignTable, name: &str, source: &str) -> Result<&'a [f64], InputError> {
    let column = table.columns.iter().find(|column| column.name == name);
    let column = column.ok_or_else(|| InputError::expected(source, format!("a column {name}"), "none"))?;
    match column.values.iter().position(|value| !value.is_finite()) {
        Some(row) => {
            let found = format!("none in row {} of numbers", row + 1);
            Err(InputError::expected(source, "a number", found).at_key(name))
        }
        None => Ok(&column.values),
    }
}

/// The rate of rows at these times, of which few may be lost.
fn rate_hz(times_s: &[f64], source: &str, notes: &mut Vec<String>) -> Result<f64, InputError> {
    let steps_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if let Some(row) = steps_s.iter().position(|step| *step <= 0.0) {
        let found = format!("{} after {} in row {} of numbers", times_s[row + 1], times_s[row], row + 2);
        return Err(InputError::expected(source, "times that increase", found).at_key("time"));
    }
    let median_s = numerics::median(&steps_s)
        .ok_or_else(|| InputError::expected(source, "two rows of numbers or more", times_s.len()))?;
    let lost: f64 =
        steps_s.iter().map(|step| (step / median_s).round() - 1.0).filter(|lost| *lost > 0.0).sum();
    if lost > MOST_LOST * times_s.len() as f64 {
        let expected = format!("at most {} % of the rows lost", 100.0 * MOST_LOST);
        return Err(InputError::expected(source, expected, format!("{lost} of {}", times_s.len())));
    }
    if lost > 0.0 {
        notes.push(format!("{lost} of {} rows are lost; the spectrum is that of the others", times_s.len()));
    }
    Ok(steps_s.len() as f64 / (times_s[times_s.len() - 1] - times_s[0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `AccelQueryHelper.write_to_file` prints them, six decimals each.
    fn rows(times_ms: impl Iterator<Item = u32>) -> String {
        let row = |ms: u32| format!("{:.6},{:.6},{:.6},{:.6}\n", 1e-3 * f64::from(ms), 1500.0, -2.5, 9810.0);
        "#time,accel_x,accel_y,accel_z\n".to_owned() + &times_ms.map(row).collect::<String>()
    }

    #[test]
    fn accelerations_are_read_in_si_at_their_rate() {
        for head in ["", "##{'queries': 12}\n"] {
            let read = parse(&(head.to_owned() + &rows(100..300)), "a.csv").unwrap();
            // 199 steps of 1 ms, each time rounded to 1 µs.
            assert!((read.rate_hz - 1000.0).abs() < 0.02, "{}", read.rate_hz);
            let first: Vec<_> =
                read.axes.iter().map(|(axis, values)| (*axis, values[0], values.len())).collect();
            assert_eq!(first, [("x", 1.5, 200), ("y", -2.5e-3, 200), ("z", 9.81, 200)]);
        }
    }

    #[test]
    fn few_lost_rows_are_told_and_many_refused() {
        let read = parse(&rows((0..1000).filter(|row| *row != 70 && *row != 71)), "a.csv").unwrap();
        assert!(read.notes.iter().any(|note| note.starts_with("2 of 998 rows are lost")), "{:?}", read.notes);
        let error = parse(&rows((0..1000).filter(|row| row % 20 != 7)), "a.csv").unwrap_err();
        assert_eq!(error.to_string(), "a.csv: expected at most 2 % of the rows lost, found 50 of 950");
        let error = parse(&rows([0, 1, 2, 2, 3].into_iter()), "a.csv").unwrap_err();
        assert_eq!(
            error.to_string(),
            "a.csv: time: expected times that increase, found 0.002 after 0.002 in row 4 of numbers"
        );
        let error = parse("time,x\n0,1\n1,2\n", "a.csv").unwrap_err().to_string();
        assert!(error.starts_with("a.csv: expected accelerations as Klipper records them"), "{error}");
    }
}
