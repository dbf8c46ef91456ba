//! The lines of a text as rows of cells, with the number of their line.
//!
//! The tables of `import` are of numbers alone; here a cell may be the sign of an approach.

use import::dialect::{Dialect, Separator};

/// A line of cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// Cells, trimmed.
    pub cells: Vec<String>,
}

/// The rows of a text, and how their numbers are written.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// The last line before the first row of numbers, with as many cells; `None`: there is none.
    pub header: Option<Row>,
    /// From the first line with numbers on, whatever the number of their cells.
    pub rows: Vec<Row>,
    /// Usual number of cells.
    pub width: usize,
    /// Separator and decimal sign.
    pub dialect: Dialect,
}

/// Fewest cells of a row: run, target and reading.
const MIN_CELLS: usize = 3;

/// Separators, of which the one with the most rows is taken; of several, the one with the most cells.
const SEPARATORS: [Separator; 4] =
    [Separator::Character('\t'), Separator::Character(';'), Separator::Character(','), Separator::Space];

impl Rows {
    /// The rows of a text; `None` if no separator makes rows of three cells.
    #[must_use]
    pub fn of(text: &str) -> Option<Self> {
        let lines: Vec<(usize, &str)> = (1..)
            .zip(text.lines())
            .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with(['#', '%']))
            .collect();
        let split = |separator: Separator| {
            let dialect = Dialect { separator, has_decimal_comma: false };
            lines.iter().map(|(_, line)| dialect.cells(line).len()).collect::<Vec<_>>()
        };
        let scored = SEPARATORS.map(|separator| (usual(&split(separator)), separator));
        let ((count, width), separator) =
            scored.into_iter().reduce(|best, other| if other.0 > best.0 { other } else { best })?;
        if count == 0 {
            return None;
        }
        let plain = Dialect { separator, has_decimal_comma: false };
        let all: Vec<Row> = lines
            .iter()
            .map(|&(line, text)| Row {
                line,
                cells: plain.cells(text).into_iter().map(str::to_owned).collect(),
            })
            .collect();
        let dialect = Dialect { separator, has_decimal_comma: has_decimal_comma(separator, &all) };
        let is_data = |row: &Row| {
            let numbers = row.cells.iter().filter(|cell| number(dialect, cell).is_some()).count();
            row.cells.len() == width && numbers >= 2
        };
        let first = all.iter().position(is_data)?;
        let header = all[..first].iter().rev().find(|row| row.cells.len() == width).cloned();
        Some(Self { header, rows: all[first..].to_vec(), width, dialect })
    }
}

/// Number of lines with the most usual number of cells of at least [`MIN_CELLS`], and this number.
fn usual(widths: &[usize]) -> (usize, usize) {
    let mut counts = std::collections::BTreeMap::new();
    for width in widths.iter().filter(|width| **width >= MIN_CELLS) {
        *counts.entry(*width).or_insert(0_usize) += 1;
    }
    counts.into_iter().map(|(width, count)| (count, width)).max().unwrap_or((0, 0))
}

/// Whether numbers have a comma as decimal sign: cells with commas are digits on both sides of one, and none has a point.
fn has_decimal_comma(separator: Separator, rows: &[Row]) -> bool {
    let with_comma = Dialect { separator, has_decimal_comma: true };
    let cells = || rows.iter().flat_map(|row| &row.cells);
    let is_number = |cell: &&String| cell.contains(',') && number(with_comma, cell).is_some();
    let is_point = |cell: &&String| {
        cell.contains('.') && number(Dialect { separator, has_decimal_comma: false }, cell).is_some()
    };
    separator != Separator::Character(',')
        && cells().filter(is_number).count() > cells().filter(is_point).count()
}

/// The finite number in a cell, with − for a minus sign as well.
#[must_use]
pub fn number(dialect: Dialect, cell: &str) -> Option<f64> {
    let cell = cell.replace('−', "-");
    let numbers = Dialect { separator: Separator::Character('\t'), ..dialect }.numbers(&cell)?;
    numbers.first().copied().filter(|number| number.is_finite() && numbers.len() == 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_and_decimal_commas_are_found() {
        for (text, commas) in [
            ("run,approach,target_mm,measured_mm\n1,+,0.5,0.51\n1,-,0.5,0.52\n", false),
            ("run;approach;target_mm;measured_mm\n1;+;0,5;0,51\n1;-;0,5;0,52\n", true),
            ("run\tapproach\ttarget mm\tmeasured mm\n1\t+\t0,5\t0,51\n1\t−\t0,5\t0,52\n", true),
            ("run approach target_mm measured_mm\n1 + 0.5 0.51\n1 - 0.5 0.52\n", false),
        ] {
            let rows = Rows::of(text).unwrap();
            assert_eq!(
                (rows.width, rows.rows.len(), rows.dialect.has_decimal_comma),
                (4, 2, commas),
                "{text}"
            );
            assert_eq!(rows.header.unwrap().cells[0], "run");
            assert_eq!((number(rows.dialect, &rows.rows[0].cells[2]), rows.rows[1].line), (Some(0.5), 3));
        }
    }

    #[test]
    fn remarks_before_the_header_are_passed_over() {
        let rows = Rows::of("Laser 3\n\n# by hand\nrun;way;t;m\n1;+;0;0,1\nend\n").unwrap();
        assert_eq!(rows.header.unwrap().line, 4);
        assert_eq!(rows.rows.iter().map(|row| row.line).collect::<Vec<_>>(), [5, 6]);
        assert!(Rows::of("Dear all,\nhello\n").is_none() && Rows::of("").is_none());
    }

    #[test]
    fn a_minus_sign_is_read_as_such() {
        let dialect = Dialect { separator: Separator::Space, has_decimal_comma: false };
        assert_eq!(number(dialect, "−1.5"), Some(-1.5));
        assert_eq!((number(dialect, "x"), number(dialect, ""), number(dialect, "+")), (None, None, None));
    }
}
