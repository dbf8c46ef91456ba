//! Exports of TwinCAT Scope as text: blocks of columns beside each other, each with its own times in milliseconds.
//!
//! A block begins where the line of names says `Name` again; that cell is above its times, and the names of its channels follow. Blocks of a
//! longer period end earlier, or repeat their rows. The other lines of the header (`SampleTime[ms]`, `Unit`, …) repeat their key
//! in the same way. Separator and decimal sign are those of the computer that exported.

use files::error::{InputError, quoted};

use crate::dialect::Dialect;
use crate::format::Format;
use crate::table::{ForeignColumn, ForeignTable};
use crate::unit;

/// First word of the line of names.
const NAME: &str = "Name";

/// Deviation of the step of the times from the period in the header that is told, as a fraction of it.
const STEP_TOLERANCE: f64 = 0.01;

/// Whether a text begins as an export does.
#[must_use]
pub fn is_export(text: &str) -> bool {
    let first = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
    first.strip_prefix(NAME).is_some_and(|rest| rest.starts_with(['\t', ';', ',']))
}

/// Reads an export; `preset` is the format if the user names it.
///
/// # Errors
/// If there is no line of names, or fewer than two rows of numbers.
pub fn parse(
    text: &str,
    preset: Option<Format>,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<ForeignTable, InputError> {
    let lines: Vec<(usize, &str)> =
        (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()).collect();
    let texts: Vec<&str> = lines.iter().map(|(_, line)| *line).collect();
    let no_rows = || InputError::expected(source, "rows of numbers", "none");
    let dialect = Dialect::of(&texts).ok_or_else(no_rows)?;
    let first = texts.iter().position(|line| dialect.numbers(line).is_some()).ok_or_else(no_rows)?;
    let head: Vec<Vec<&str>> = texts[..first].iter().map(|line| dialect.cells(line)).collect();
    let Some(at) = head.iter().rposition(|cells| cells.first() == Some(&NAME)) else {
        return Err(InputError::expected(source, "a line of names that begins with Name", "none"));
    };
    let header = Header { names: &head[at], others: &head[at + 1..] };
    let rows =
        texts[first..].iter().map(|line| dialect.numbers(line).filter(|row| row.len() <= header.names.len()));
    let (rows, skipped): (Vec<_>, Vec<_>) = rows.partition(Option::is_some);
    let rows: Vec<Vec<f64>> = rows.into_iter().flatten().collect();
    if rows.len() < 2 {
        return Err(InputError::expected(source, "two rows of numbers or more", rows.len()));
    }
    let columns = header.columns(&rows);
    let clocks = columns.iter().filter(|column| column.times.is_none()).count();
    let channels = columns.len() - clocks;
    notes.push(format!(
        "{}: {} rows of {channels} channels in {clocks} groups",
        Format::Twincat.said(preset),
        rows.len()
    ));
    // The last line is EOF.
    if skipped.len() > 1 {
        notes.push(format!("{} lines are no row and left out", skipped.len()));
    }
    header.note_periods(&columns, notes);
    header.note_scales(notes);
    Ok(ForeignTable { format: Format::Twincat, columns, period_s: None, header_line: Some(lines[at].0) })
}

/// The lines before the rows, as cells.
struct Header<'a> {
    names: &'a [&'a str],
    /// The lines after that of the names.
    others: &'a [Vec<&'a str>],
}

impl Header<'_> {
    /// The cell of a column in the line with a key; empty if there is none.
    fn cell(&self, key: &str, column: usize) -> &str {
        let line = self.others.iter().find(|cells| cells.first() == Some(&key));
        line.and_then(|cells| cells.get(column)).copied().unwrap_or_default()
    }

    /// Name of a channel; of two with the same name, that of their symbol.
    fn name(&self, column: usize) -> &str {
        let name = self.names[column];
        let symbol = self.cell("SymbolName", column);
        let is_repeated = self.names.iter().filter(|other| **other == name).count() > 1;
        if is_repeated && !symbol.is_empty() { symbol } else { name }
    }

    /// The columns of the rows, each group as long as its times.
    fn columns(&self, rows: &[Vec<f64>]) -> Vec<ForeignColumn> {
        let value = |row: &Vec<f64>, column: usize| row.get(column).copied().unwrap_or(f64::NAN);
        let mut times = 0;
        let mut columns = Vec::new();
        for (index, name) in self.names.iter().enumerate() {
            let is_time = *name == NAME;
            if is_time {
                times = index;
            }
            let own = rows.iter().filter(|row| value(row, times).is_finite());
            let values = own.map(|row| value(row, index)).collect();
            let unit = Some(self.cell("Unit", index)).filter(|unit| unit::is_unit(unit));
            columns.push(if is_time {
                let first = self.names.get(index + 1).copied().unwrap_or_default();
                ForeignColumn::new(format!("times of {first}"), Some("ms".to_owned()), values)
            } else {
                let unit = unit.map(str::to_owned);
                ForeignColumn {
                    times: Some(times),
                    ..ForeignColumn::new(self.name(index).to_owned(), unit, values)
                }
            });
        }
        columns
    }

    /// Tells where the times of a group do not step by the period of the header.
    fn note_periods(&self, columns: &[ForeignColumn], notes: &mut Vec<String>) {
        for (index, clock) in columns.iter().enumerate().filter(|(_, column)| column.times.is_none()) {
            let period_ms = self.cell("SampleTime[ms]", index + 1).replace(',', ".").parse::<f64>();
            let steps = clock.values.windows(2).map(|two| two[1] - two[0]);
            let steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
            if let (Ok(period_ms), Some(step_ms)) = (period_ms, numerics::median(&steps))
                && (step_ms - period_ms).abs() > STEP_TOLERANCE * period_ms
            {
                notes.push(format!(
                    "{} step by {step_ms} ms, not by the {period_ms} ms of the header; the times are used",
                    quoted(&clock.name)
                ));
            }
        }
    }

    /// Tells of scales and offsets other than one and zero.
    fn note_scales(&self, notes: &mut Vec<String>) {
        let differs = |key: &str, usual: &str| {
            let columns = (1..self.names.len()).filter(|&column| self.names[column] != NAME);
            columns.map(|column| self.cell(key, column)).any(|cell| !["", key, usual].contains(&cell))
        };
        if differs("ScaleFactor", "1") || differs("Offset", "0") {
            notes.push(
                "ScaleFactor and Offset of the header are not applied: the values are as exported".to_owned(),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXPORT: &str = "Name\tScope\nFile\tC:\\x.svdx\nStarttime of export\t133964386997165000\tMontag\t10:00:00.000\n\n\
        Name\tActPos\tSetPos\tName\tTorque\n\
        SymbolComment\t\t\tSymbolComment\t\n\
        Data-Type\tREAL64\tREAL64\tData-Type\tINT16\n\
        SampleTime[ms]\t0,5\t0,5\tSampleTime[ms]\t2\n\
        Unit\tmm\t\tUnit\tNm\n\
        Offset\t0\t0\tOffset\t3\n\n\
        0\t1,5\t1\t0\t-7\n0,5\t2,5\t2\t1\t-8\n1\t3,5\t3\t2\t-9\n1,5\t4,5\t4\nEOF\n";

    fn parsed(text: &str) -> (ForeignTable, Vec<String>) {
        let mut notes = Vec::new();
        (parse(text, None, "a.csv", &mut notes).unwrap(), notes)
    }

    #[test]
    fn each_group_has_its_own_times() {
        let (table, notes) = parsed(EXPORT);
        let of = |name: &str| table.columns.iter().find(|column| column.name == name).unwrap();
        assert_eq!(of("SetPos").values, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(of("ActPos").values, [1.5, 2.5, 3.5, 4.5]);
        assert_eq!((of("ActPos").unit.as_deref(), of("SetPos").unit.as_deref()), (Some("mm"), None));
        let torque = of("Torque");
        assert_eq!((&torque.values[..], torque.times), (&[-7.0, -8.0, -9.0][..], Some(3)));
        assert_eq!((table.columns[3].values.clone(), table.header_line), (vec![0.0, 1.0, 2.0], Some(5)));
        assert!(notes[0].contains("4 rows of 3 channels in 2 groups"), "{notes:?}");
        assert_eq!(
            notes[1],
            "\"times of Torque\" step by 1 ms, not by the 2 ms of the header; the times are used"
        );
        assert!(notes[2].contains("not applied") && notes.len() == 3, "{notes:?}");
    }

    #[test]
    fn an_export_with_names_alone_is_read() {
        let text = "Name,x,Name,x\n0,1.5,0,7\n1,2.5,1,8\n";
        assert!(is_export(text) && is_export(EXPORT) && !is_export("Names,x\n1,2\n"));
        let (table, _) = parsed(text);
        assert_eq!(table.columns[3].values, [7.0, 8.0]);
    }

    #[test]
    fn a_text_without_names_is_refused() {
        let error = |text: &str| parse(text, None, "a.csv", &mut Vec::new()).unwrap_err().to_string();
        assert!(error("t\tx\n0\t1\n1\t2\n").contains("a line of names that begins with Name"));
        assert!(error("Name\tx\n").contains("rows of numbers"));
        assert!(error("Name\tx\n0\t1\n").contains("two rows of numbers"));
    }
}
