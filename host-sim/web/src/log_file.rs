//! A dropped file as a log, or what is missing to read it.

use files::error::InputError;
use files::head::Head;
use files::log::{AxisLog, Channel, Log, Unit};
use files::segments::unpacked;
use import::any_log::{self, Content};
use import::budget::Budget;
use import::{Imported, ballbar, read};
use serde_json::{Value, json};

use crate::request::DroppedFile;

/// What a file holds, packed by gzip or not.
///
/// # Errors
/// As [`any_log::read`].
pub fn content<'a>(file: &DroppedFile<'a>) -> Result<Content<'a>, InputError> {
    let input = unpacked(Box::new(file.bytes), false, &file.name)?;
    any_log::content(Head::of(input, &file.name)?, &file.name, &file.reading)
}

/// The logs of files, those of the fit and those that are held out.
///
/// # Errors
/// The first file that is no log.
pub fn logs(files: &[DroppedFile<'_>]) -> Result<[Vec<Log>; 2], String> {
    let [mut fit, mut held_out] = [const { Vec::new() }; 2];
    for file in files {
        match content(file).map_err(|error| error.to_string())? {
            Content::Log(imported) if file.is_held_out => held_out.push(imported.log),
            Content::Log(imported) => fit.push(imported.log),
            Content::Radii(..) => return Err(ballbar::no_log(&file.name).to_string()),
        }
    }
    Ok([fit, held_out])
}

/// What the page shows of a file.
#[must_use]
pub fn look(file: &DroppedFile<'_>) -> Value {
    match content(file) {
        Ok(Content::Log(Imported { log, notes })) => json!({
            "name": file.name,
            "kind": "log",
            "seconds": log.sample_time_s * log.len() as f64,
            "rate_hz": 1.0 / log.sample_time_s,
            "axes": log.axes.iter().map(axis).collect::<Value>(),
            "notes": notes,
        }),
        Ok(Content::Radii(input, notes)) => json!({
            "name": file.name,
            "kind": "radii",
            "columns": Head::of(input, &file.name).map_or_else(|_| Vec::new(), |head| head.names()),
            "notes": notes,
        }),
        Err(error) => {
            let columns = columns(file);
            let has_columns = columns.as_array().is_some_and(|columns| !columns.is_empty());
            let error = error.to_string();
            let error = if has_columns { problem(&error) } else { without_advice(&error) };
            json!({"name": file.name, "kind": "unknown", "error": error, "columns": columns})
        }
    }
}

/// An error without what a command line would need.
fn without_advice(error: &str) -> String {
    error.replace(&format!(" ({})", any_log::ADVICE), "").replace(&format!(" {})", any_log::ADVICE), ")")
}

/// The problem of a file whose columns are chosen below it: the page has no flags.
fn problem(error: &str) -> String {
    /// What the import asks for by flags, and the words of the page.
    const BY_FLAGS: [(&str, &str); 4] = [
        (" (--map time_s=THEIRS), or --rate HZ", ", or the samples per second"),
        (
            "an angle (--map angle_deg=THEIRS) or a time (--map time_s=THEIRS, --rate HZ)",
            "an angle or a time",
        ),
        ("is --unit right?", "is its unit right?"),
        ("--map: ", ""),
    ];
    if error.contains("--map OURS=THEIRS for") {
        return "No column has a known name. Choose below what each column is.".to_owned();
    }
    let words = BY_FLAGS.iter().fold(without_advice(error), |text, (flag, words)| text.replace(flag, words));
    format!("{words}. Choose below what each column is.")
}

fn axis(axis: &AxisLog) -> Value {
    let has = Channel::ALL.into_iter().filter(|channel| axis.channel(*channel).is_some());
    json!({
        "name": axis.name,
        "unit": if axis.unit == Unit::Degree { "deg" } else { "mm" },
        "columns": has.map(|channel| axis.column(channel)).collect::<Value>(),
    })
}

/// The columns of a file whose channels are not known, each with its unit and its first values.
fn columns(file: &DroppedFile<'_>) -> Value {
    /// Values that are shown of a column.
    const SHOWN: usize = 3;
    let read = || -> Result<Value, InputError> {
        let bytes = Budget::file().read(unpacked(Box::new(file.bytes), false, &file.name)?, &file.name)?;
        let table = read::table(&bytes, file.reading.preset, &file.name, &mut Vec::new())?;
        let shown = table.columns.iter().map(|column| {
            let first: Vec<f64> = column.values.iter().take(SHOWN).copied().collect();
            json!({"name": column.name, "unit": column.unit, "first": first})
        });
        Ok(shown.collect())
    };
    read().unwrap_or_else(|_| json!([]))
}
