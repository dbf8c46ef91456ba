//! From rows of cells to the readings of a test. A line that is no reading is named; if few are not, the others are used.

use files::error::{InputError, quoted};
use files::table::MAX_MEASURED;

use super::columns::{self, Column, Request, Role};
use super::measured::{Reading, Test, Way};
use super::plausible;
use super::raw::Raw;
use super::rows::{Row, Rows, number};

/// Largest share of lines that may be no readings.
const MAX_LEFT_OUT: f64 = 0.25;

/// Most lines that are named one by one.
const MAX_NAMED: usize = 5;

/// Words for the approach in + direction; a number above 0, too.
const POSITIVE: [&str; 8] = ["+", "positive", "pos", "up", "forward", "fwd", "↑", "f"];

/// Words for the approach in − direction; a number below 0, too.
const NEGATIVE: [&str; 10] = ["-", "−", "–", "negative", "neg", "down", "reverse", "rev", "backward", "↓"];

/// The test in a text; `source` is the name of the file for messages.
///
/// # Errors
/// No rows, columns that are missing, more than a quarter of the lines that are no reading, readings that are not near the targets.
pub fn of_text(
    text: &str,
    source: &str,
    request: &Request,
    mut notes: Vec<String>,
) -> Result<Test, InputError> {
    let Some(rows) = Rows::of(text) else {
        let first = text.lines().find(|line| !line.trim().is_empty());
        let found = first.map_or_else(|| "an empty file".to_owned(), quoted);
        let expected = "a table with at least the columns run, target_mm and measured_mm";
        return Err(InputError::expected(source, expected, found));
    };
    let columns = columns::choose(&rows, request, source, &mut notes)?;
    let (mut raw, mut refused) = (Vec::new(), Vec::new());
    for row in &rows.rows {
        match read(row, &rows, &columns) {
            Ok(reading) => raw.push(reading),
            Err((key, expected, found)) => {
                let error = InputError::expected(source, expected, found).at_line(row.line);
                refused.push(if key.is_empty() { error } else { error.at_key(key) });
            }
        }
    }
    let share = refused.len() as f64 / rows.rows.len().max(1) as f64;
    if share > MAX_LEFT_OUT {
        return Err(refused.swap_remove(0));
    }
    note_refused(&refused, &mut notes);
    let is_deviation = columns.iter().any(|column| column.role == Role::Deviation);
    if is_deviation {
        plausible::deviations(&mut raw, source, &mut notes)?;
    } else {
        plausible::in_millimetres(&mut raw, source, &mut notes)?;
    }
    infer_ways(&mut raw, &mut notes);
    let test = assembled(raw, source, notes).checked()?;
    Ok(broken_off(test))
}

/// A cell that is no value: column, what was expected, what was found.
type Refused = (&'static str, String, String);

fn read(row: &Row, rows: &Rows, columns: &[Column]) -> Result<Raw, Refused> {
    if row.cells.len() != rows.width {
        return Err((
            "",
            format!("{} values as in the other lines", rows.width),
            row.cells.len().to_string(),
        ));
    }
    let column = |role: Role| columns.iter().find(|column| column.role == role);
    let value = |role: Role| -> Result<Option<f64>, Refused> {
        let Some(column) = column(role) else { return Ok(None) };
        let cell = &row.cells[column.index];
        let value = number(rows.dialect, cell).map(|number| column.factor * number);
        match value.filter(|value| value.abs() <= MAX_MEASURED) {
            Some(value) => Ok(Some(value)),
            None if cell.is_empty() => Err((role.name(), "a number".to_owned(), "nothing".to_owned())),
            None => Err((role.name(), "a number from −1e9 to 1e9".to_owned(), quoted(cell))),
        }
    };
    let way = match column(Role::Approach).map(|column| row.cells[column.index].as_str()) {
        None => None,
        Some(cell) => Some(way(cell).ok_or_else(|| ("approach", "+ or -".to_owned(), quoted(cell)))?),
    };
    let measured = value(Role::Measured)?.or(value(Role::Deviation)?);
    Ok(Raw {
        run: column(Role::Run).map_or_else(String::new, |column| row.cells[column.index].clone()),
        way,
        target_mm: value(Role::Target)?.unwrap_or_default(),
        value: measured.unwrap_or_default(),
        time_s: value(Role::Time)?,
        line: row.line,
    })
}

fn way(cell: &str) -> Option<Way> {
    let word = cell.to_lowercase();
    let sign = word.replace('−', "-").parse::<f64>().ok();
    match () {
        () if POSITIVE.contains(&word.as_str()) || sign.is_some_and(|sign| sign > 0.0) => Some(Way::Positive),
        () if NEGATIVE.contains(&word.as_str()) || sign.is_some_and(|sign| sign < 0.0) => Some(Way::Negative),
        () => None,
    }
}

fn note_refused(refused: &[InputError], notes: &mut Vec<String>) {
    notes.extend(refused.iter().take(MAX_NAMED).map(|error| format!("Left out: {error}.")));
    if refused.len() > MAX_NAMED {
        notes.push(format!("Left out: {} more lines that are no readings.", refused.len() - MAX_NAMED));
    }
}

/// Without a column of approaches, the direction in which the targets of a run follow each other. A target that is repeated is the turn.
fn infer_ways(raw: &mut [Raw], notes: &mut Vec<String>) {
    if raw.iter().all(|reading| reading.way.is_some()) {
        return;
    }
    notes.push(
        "The file has no approaches: they are taken from the order of the targets in each run.".to_owned(),
    );
    let steps: Vec<f64> = (0..raw.len())
        .map(|i| {
            let step = |from: usize, to: usize| match (raw.get(from), raw.get(to)) {
                (Some(a), Some(b)) if a.run == b.run => b.target_mm - a.target_mm,
                _ => 0.0,
            };
            let before = i.checked_sub(1).map_or(0.0, |previous| step(previous, i));
            if before == 0.0 { step(i, i + 1) } else { before }
        })
        .collect();
    for (reading, step) in raw.iter_mut().zip(steps) {
        reading.way.get_or_insert(if step < 0.0 { Way::Negative } else { Way::Positive });
    }
}

fn assembled(raw: Vec<Raw>, source: &str, notes: Vec<String>) -> Test {
    let mut runs: Vec<String> = Vec::new();
    let mut readings = Vec::new();
    for reading in raw {
        let run = runs.iter().position(|run| *run == reading.run).unwrap_or_else(|| {
            runs.push(reading.run.clone());
            runs.len() - 1
        });
        readings.push(Reading {
            run,
            way: reading.way.unwrap_or(Way::Positive),
            target_mm: reading.target_mm,
            deviation_um: reading.value,
            time_s: reading.time_s,
            line: reading.line,
        });
    }
    let number = |run: &String| run.replace(',', ".").parse().ok().filter(|number: &f64| number.is_finite());
    let run_numbers = runs.iter().map(|run| number(run).unwrap_or(f64::NAN)).collect();
    Test { source: source.to_owned(), readings, run_numbers, notes }
}

/// Names runs that have fewer readings than the others; they are used.
fn broken_off(mut test: Test) -> Test {
    let of_run = |run: usize| test.readings.iter().filter(move |reading| reading.run == run);
    let counts: Vec<usize> = (0..test.runs()).map(|run| of_run(run).count()).collect();
    let usual =
        numerics::median(&counts.iter().map(|count| *count as f64).collect::<Vec<_>>()).unwrap_or(0.0);
    let mut notes = Vec::new();
    for (run, count) in counts.iter().enumerate().filter(|(_, count)| (**count as f64) < usual) {
        let last = of_run(run).next_back().map_or(0, |reading| reading.line);
        notes.push(format!(
            "{}: line {last}: run {} ends after {count} of {usual} readings, which are used.",
            test.source,
            run + 1
        ));
    }
    test.notes.extend(notes);
    test
}
