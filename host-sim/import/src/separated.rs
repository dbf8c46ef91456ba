//! A table of numbers in a text, with its header.
//!
//! Lines of a text that are no rows, such as `overrun` of halsampler, are counted and told.

use files::error::{InputError, quoted};

use crate::dialect::Dialect;
use crate::format::Format;
use crate::table::{ForeignColumn, ForeignTable};
use crate::unit;

/// Line number, from 1, and text.
type Line<'a> = (usize, &'a str);

/// Reads a text; `preset` is the format if the user names it.
///
/// # Errors
/// If no line is a row of numbers, or there are fewer than two.
pub fn parse(
    text: &str,
    preset: Option<Format>,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<ForeignTable, InputError> {
    let all = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let (comments, lines): (Vec<Line<'_>>, Vec<Line<'_>>) = all.partition(|(_, line)| is_comment(line));
    let texts: Vec<&str> = lines.iter().map(|(_, line)| *line).collect();
    let Some(dialect) = Dialect::of(&texts) else {
        let found = texts.first().map_or("an empty file".to_owned(), |line| quoted(line));
        return Err(InputError::expected(source, "rows of numbers", found));
    };
    let parsed: Vec<Option<Vec<f64>>> = texts.iter().map(|line| dialect.numbers(line)).collect();
    let width = usual_width(&parsed);
    let is_row = |numbers: &Vec<f64>| numbers.len() == width;
    let first = parsed.iter().position(|row| row.as_ref().is_some_and(is_row)).unwrap_or(0);
    let header = Header::of(dialect, &texts[..first], width);
    let header_line = lines[first.saturating_sub(usize::from(header.is_some()))].0;
    let header = header.or_else(|| Header::of_comment(dialect, &comments, lines[first].0, width));
    let mut columns = vec![Vec::new(); width];
    let mut skipped: Vec<Line<'_>> = Vec::new();
    for (&line, row) in lines.iter().zip(parsed).skip(first) {
        let Some(row) = row.filter(is_row) else {
            skipped.push(line);
            continue;
        };
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    let rows = columns.first().map_or(0, Vec::len);
    if rows < 2 {
        return Err(InputError::expected(source, "two rows of numbers or more", rows));
    }
    let period_s = comments.iter().find_map(|(_, line)| sampling_period_s(line));
    let period_s = period_s.or_else(|| texts[..first].iter().find_map(|line| sampling_period_s(line)));
    let format = preset.unwrap_or_else(|| recognised(period_s, header.as_ref(), &texts));
    notes.push(format!("{}: {rows} rows of {width} columns", format.said(preset)));
    note_skipped(&skipped, notes);
    let names = header.unwrap_or_else(|| Header::numbered(width)).0;
    let columns = names.into_iter().zip(columns);
    let columns = columns.map(|((name, unit), values)| ForeignColumn::new(name, unit, values)).collect();
    Ok(ForeignTable { format, columns, period_s, header_line: Some(header_line) })
}

/// What wrote a text: halscope names the sampling period; halsampler has neither names nor separators.
fn recognised(period_s: Option<f64>, header: Option<&Header>, texts: &[&str]) -> Format {
    match (period_s, header) {
        (Some(_), _) => Format::Halscope,
        (None, None) if texts.iter().all(|line| !line.contains([',', ';', '\t'])) => Format::Halsampler,
        _ => Format::Text,
    }
}

/// The number of cells that most rows of numbers have.
fn usual_width(parsed: &[Option<Vec<f64>>]) -> usize {
    let mut counts = std::collections::BTreeMap::new();
    for numbers in parsed.iter().flatten() {
        *counts.entry(numbers.len()).or_insert(0usize) += 1;
    }
    counts.into_iter().max_by_key(|(_, count)| *count).map_or(0, |(width, _)| width)
}

/// Whether a line is a comment: it begins with `#`, `%` or `//`.
fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    ["#", "%", "//"].iter().any(|sign| line.starts_with(sign))
}

/// The sampling period of a line `# Sampling period is 1000000 ns`, or in `nSec`, s.
#[must_use]
pub fn sampling_period_s(line: &str) -> Option<f64> {
    let line = line.to_lowercase();
    let mut words = line.split_once("sampling period is")?.1.split_whitespace();
    let (number, unit) = (words.next()?.parse::<f64>().ok()?, words.next()?);
    unit::Quantity::Time.factor(unit).map(|factor| factor * number).filter(|period_s| *period_s > 0.0)
}

/// Names and units of the columns.
struct Header(Vec<(String, Option<String>)>);

impl Header {
    /// The header of a table: the last line before the rows with as many cells, or the last two if the second has units alone.
    fn of(dialect: Dialect, before: &[&str], width: usize) -> Option<Self> {
        let cells: Vec<Vec<&str>> = before.iter().map(|line| dialect.cells(line)).collect();
        let (last, others) = cells.split_last()?;
        let is_units =
            |cells: &[&str]| cells.iter().all(|cell| cell.is_empty() || unit::is_unit(inner(cell)));
        match others.last() {
            Some(names) if last.len() == width && is_units(last) && names.len() == width => {
                let unit = |cell: &&str| (!cell.is_empty()).then(|| inner(cell).to_owned());
                let named = names.iter().zip(last).map(|(name, cell)| ((*name).to_owned(), unit(cell)));
                Some(Self(named.collect()))
            }
            _ if last.len() == width => {
                let named = last.iter().map(|cell| {
                    let (name, unit) = unit::split(cell);
                    (name.to_owned(), unit.map(str::to_owned))
                });
                Some(Self(named.collect()))
            }
            _ => None,
        }
    }

    /// The header in the last comment before the first row, as `numpy.savetxt` writes it.
    fn of_comment(dialect: Dialect, comments: &[Line<'_>], first_row: usize, width: usize) -> Option<Self> {
        let (_, line) = comments.iter().rev().find(|(number, _)| *number < first_row)?;
        let names = line.trim_start().trim_start_matches(['#', '%', '/']);
        if width < 2 || sampling_period_s(line).is_some() || dialect.numbers(names).is_some() {
            return None;
        }
        Self::of(dialect, &[names], width)
    }

    fn numbered(width: usize) -> Self {
        Self((1..=width).map(|number| (number.to_string(), None)).collect())
    }
}

/// A unit without its brackets.
fn inner(cell: &str) -> &str {
    cell.trim_matches(['(', ')', '[', ']']).trim()
}

fn note_skipped(skipped: &[Line<'_>], notes: &mut Vec<String>) {
    if let Some((number, line)) = skipped.first() {
        let count = skipped.len();
        let lines = if count == 1 { "line is" } else { "lines are" };
        notes.push(format!(
            "{count} {lines} no row and left out, the first in line {number}: {}",
            quoted(line)
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> (ForeignTable, Vec<String>) {
        let mut notes = Vec::new();
        let table = parse(text, None, "a.txt", &mut notes).unwrap();
        (table, notes)
    }

    fn names(table: &ForeignTable) -> Vec<(&str, Option<&str>)> {
        table.columns.iter().map(|column| (column.name.as_str(), column.unit.as_deref())).collect()
    }

    #[test]
    fn headers_have_units_in_brackets_or_in_a_line_of_their_own() {
        let (table, _) = parsed("t (ms);X cmd (in)\n0;1\n1;2\n");
        assert_eq!(names(&table), [("t", Some("ms")), ("X cmd", Some("in"))]);
        let (table, _) = parsed("Recorder 3\nt\tx\n[s]\t[µm]\n0,0\t1,5\n0,1\t2,5\n");
        assert_eq!(names(&table), [("t", Some("s")), ("x", Some("µm"))]);
        assert_eq!(table.columns[1].values, [1.5, 2.5]);
        assert_eq!((table.header_line, table.format), (Some(3), Format::Text));
    }

    #[test]
    fn a_table_without_header_has_numbered_columns() {
        let (table, notes) = parsed("0 0.5 1.0 \n1 0.6 1.1 \noverrun\n3 0.8 1.3 \n");
        assert_eq!(names(&table), [("1", None), ("2", None), ("3", None)]);
        assert_eq!((table.format, table.columns[0].values.len()), (Format::Halsampler, 3));
        assert!(
            notes[1].contains("1 line is no row") && notes[1].contains("line 3: \"overrun\""),
            "{notes:?}"
        );
    }

    #[test]
    fn the_period_of_a_comment_is_read() {
        let (table, _) =
            parsed("# Sampling period is 1000000 nSec\njoint.0.pos-cmd;joint.0.pos-fb\n0.1;0.2\n0.3;0.4\n");
        assert_eq!((table.period_s, table.format), (Some(1e-3), Format::Halscope));
        assert_eq!(names(&table)[1].0, "joint.0.pos-fb");
    }

    /// `numpy.savetxt(…, header="t x")` puts the names into a comment; a remark of as many words as columns is no harm, as it is only named.
    #[test]
    fn a_header_may_be_a_comment() {
        let (table, _) = parsed("# made by hand, in a hurry\n# t x\n0 0.5\n1 0.6\n");
        assert_eq!(names(&table), [("t", None), ("x", None)]);
        let (table, _) = parsed("# a remark on it\n0 0.5\n1 0.6\n");
        assert_eq!(names(&table), [("1", None), ("2", None)]);
    }

    #[test]
    fn a_text_without_numbers_is_refused() {
        for text in ["", "a,b\nc,d\n", "1,2\n"] {
            assert!(parse(text, None, "a.txt", &mut Vec::new()).is_err(), "{text}");
        }
    }
}
