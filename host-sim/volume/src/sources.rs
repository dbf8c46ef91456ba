//! Reads the files of a survey.

use circle::measured::Measured;
use circle::radius_table::Nominal;
use files::error::InputError;
use files::head::Head;
use files::table::Table;
use import::any_log::{self, Content};
use import::budget::Budget;
use import::request::Request;

use super::measurement::Group;
use super::survey::{Measurement, Survey, What};

/// The measurements of a survey as equations. `request` says how logs of other programs are read.
///
/// # Errors
/// The first file that is not what the survey says.
pub fn read(survey: &Survey, request: &Request) -> Result<Vec<Group>, InputError> {
    survey.measurements.iter().map(|measurement| group(measurement, request)).collect()
}

fn group(measurement: &Measurement, request: &Request) -> Result<Group, InputError> {
    match measurement.what {
        What::Positioning(axis) => {
            let path = &measurement.files[0];
            let source = path.display().to_string();
            let bytes = Budget::file().read(Head::open(path, &source)?.into_input(), &source)?;
            let test = positions::read(&bytes, &source, &positions::columns::Request::default())?;
            Group::of_test(&test, axis, measurement)
        }
        What::Circle { plane, radius_mm } => {
            let (measured, notes) = circle_of(measurement, radius_mm, request)?;
            let mut group = Group::of_circle(&measured, plane, measurement)?;
            group.notes.splice(0..0, notes);
            Ok(group)
        }
    }
}

/// A circle from one or two logs, or from one or two tables of radii, with what was assumed of the files.
fn circle_of(
    measurement: &Measurement,
    radius_mm: Option<f64>,
    request: &Request,
) -> Result<(Measured, Vec<String>), InputError> {
    let sources: Vec<String> = measurement.files.iter().map(|path| path.display().to_string()).collect();
    let (mut tables, mut logs, mut all_notes) = (Vec::new(), Vec::new(), Vec::new());
    for (path, source) in measurement.files.iter().zip(&sources) {
        match any_log::content(Head::open(path, source)?, source, request)? {
            Content::Log(imported) => {
                all_notes.extend(imported.notes);
                logs.push(imported.log);
            }
            Content::Radii(input, notes) => {
                all_notes.extend(notes);
                tables.push((Table::of_input(input, source)?, source.clone()));
            }
        }
    }
    match (tables.first(), logs.first(), radius_mm) {
        (Some((_, table)), _, None) => {
            return Err(InputError::expected(table, "radius_mm of its [[circle]] in the survey", "none"));
        }
        (None, Some(log), Some(radius_mm)) => {
            let expected = "no radius_mm of its [[circle]] in the survey, as a log has its own";
            return Err(InputError::expected(&log.source, expected, radius_mm));
        }
        _ => {}
    }
    let nominal = Nominal { radius_mm, ..Nominal::default() };
    Ok((Measured::of_files(&logs, tables, nominal)?, all_notes))
}
