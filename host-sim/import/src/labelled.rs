//! Logs of earlier versions of `halscope` (LinuxCNC, `src/hal/utils/scope_files.c`): each row has the name of each channel before its value.
//!
//! ```text
//! Sampling period is 1000000 ns
//!
//! joint.0.pos-cmd +0.10000000000000 joint.0.pos-fb +0.09990000000000
//! ```

use files::error::InputError;

use crate::format::Format;
use crate::separated::sampling_period_s;
use crate::table::{ForeignColumn, ForeignTable};

/// The names of a row, and its values; `None` if names and numbers do not alternate.
fn row(line: &str) -> Option<(Vec<&str>, Vec<f64>)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let pairs = words.chunks_exact(2);
    let is_name = |word: &str| word.parse::<f64>().is_err();
    if words.is_empty() || !pairs.remainder().is_empty() || !pairs.clone().all(|pair| is_name(pair[0])) {
        return None;
    }
    let values = pairs.clone().map(|pair| pair[1].parse().ok().filter(|value: &f64| value.is_finite()));
    Some((pairs.map(|pair| pair[0]).collect(), values.collect::<Option<_>>()?))
}

/// Whether a text is such a log: a sampling period, and a first row of names and values.
#[must_use]
pub fn is_log(text: &str) -> bool {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    lines.next().and_then(sampling_period_s).is_some() && lines.next().and_then(row).is_some()
}

/// Reads such a log. Rows that are incomplete, as the last one may be, or that have other names are left out, which is told.
///
/// # Errors
/// If it has fewer than two rows.
pub fn parse(
    text: &str,
    preset: Option<Format>,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<ForeignTable, InputError> {
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let period_s = lines.next().and_then(|(_, line)| sampling_period_s(line));
    let mut first = None;
    let (mut columns, mut left_out): (Vec<ForeignColumn>, usize) = (Vec::new(), 0);
    for (number, line) in lines {
        let Some((names, values)) = row(line) else {
            left_out += 1;
            continue;
        };
        if columns.is_empty() {
            first = Some(number);
            columns.extend(names.iter().map(|name| ForeignColumn::new((*name).to_owned(), None, Vec::new())));
        }
        if !columns.iter().map(|column| column.name.as_str()).eq(names) {
            left_out += 1;
            continue;
        }
        columns.iter_mut().zip(values).for_each(|(column, value)| column.values.push(value));
    }
    let rows = columns.first().map_or(0, |column| column.values.len());
    if rows < 2 {
        return Err(InputError::expected(source, "two rows of numbers or more", rows));
    }
    notes.push(format!("{}: {rows} rows of {} columns", Format::Halscope.said(preset), columns.len()));
    if left_out > 0 {
        notes.push(format!("{left_out} lines are no row and left out"));
    }
    Ok(ForeignTable { format: Format::Halscope, columns, period_s, header_line: first })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "Sampling period is 500000 ns \n\na +1.0 b -2.5 \na +2.0 b +3.5 \na +3.0 c +1.0 \na +4.0 \nb";

    /// Two rows; one has another name, one lacks a value, and the last one is cut.
    #[test]
    fn names_before_each_value_are_those_of_the_columns() {
        assert!(is_log(TEXT));
        let mut notes = Vec::new();
        let table = parse(TEXT, None, "a.log", &mut notes).unwrap();
        let columns: Vec<(&str, &[f64])> =
            table.columns.iter().map(|column| (column.name.as_str(), column.values.as_slice())).collect();
        assert_eq!(columns, [("a", &[1.0, 2.0][..]), ("b", &[-2.5, 3.5])]);
        assert!((table.period_s.unwrap() - 5e-4).abs() < 1e-12);
        assert!(notes.iter().any(|note| note == "3 lines are no row and left out"), "{notes:?}");
    }

    #[test]
    fn other_texts_are_no_such_log() {
        for text in [
            "",
            "a 1 b 2\na 2 b 3\n",
            "# Sampling period is 1000 ns\na;b\n1;2\n",
            "Sampling period is 1000 ns\n1 2\n",
        ] {
            assert!(!is_log(text), "{text}");
        }
    }
}
