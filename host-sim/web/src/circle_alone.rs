//! The parts of a circle, as `lost-motion circle`.

use budget::limits::Limited;
use circle::measured::Measured;
use circle::radius_table::Nominal;
use circle::{analyse, json as circle_json, text};
use files::error::InputError;
use files::table::Table;
use import::any_log::Content;
use report::circle_page;
use serde_json::{Value, json};

use crate::log_file::content;
use crate::request::{Circle, DroppedFile};

/// The result as the JSON of the command line, the page, and the sentences.
///
/// # Errors
/// Files that are no circle, in one line.
pub fn of_files(request: &Circle, files: &[DroppedFile<'_>]) -> Result<Value, String> {
    if let Some(radius) = request.radius_mm.filter(|radius| !(radius.is_finite() && *radius > 0.0)) {
        return Err(format!("expected a radius above 0 mm, found {radius}"));
    }
    let analysis = measured(request, files).and_then(analyse).map_err(|error| error.to_string())?;
    Ok(json!({
        "json": Limited { result: circle_json::of(&analysis), limits: Vec::new() },
        "page": circle_page::html(&analysis, &[]),
        "summary": text::of(&analysis),
    }))
}

fn measured(request: &Circle, files: &[DroppedFile<'_>]) -> Result<Measured, InputError> {
    let (mut logs, mut tables) = (Vec::new(), Vec::new());
    for file in files {
        match content(file)? {
            Content::Log(imported) => logs.push(imported.log),
            Content::Radii(input, _) => {
                tables.push((Table::of_input(input, &file.name)?, file.name.clone()));
            }
        }
    }
    // The page keeps a radius that was given for other files.
    let radius_mm = request.radius_mm.filter(|_| logs.is_empty());
    Measured::of_files(&logs, tables, Nominal { radius_mm, ..Nominal::default() })
}
