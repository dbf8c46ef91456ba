//! A trace, as `lost-motion trace`.

use budget::traced::Document;
use contour::log_error::LogError;
use model::machine::Machine;
use report::sentences;
use report::trace_page::{self, Extra};
use serde_json::{Value, json};

use crate::log_file;
use crate::request::{DroppedFile, Trace};
use trace::Progress;

/// The result as the JSON of the command line, the page, the better machine file, and its sentences.
///
/// # Errors
/// Logs or a machine file that cannot be used, in one line.
pub fn of_logs(request: &Trace, files: &[DroppedFile<'_>], progress: &Progress<'_>) -> Result<Value, String> {
    progress("reading the logs");
    let [fit, held_out] = log_file::logs(files)?;
    let machine = Machine::parse(&request.machine, "machine file").map_err(|error| error.to_string())?;
    let (machine, mut notes) = init::estimate::unknown_values(&machine, &fit, progress);
    let contour_errors = LogError::all(fit.iter().chain(&held_out));
    let trace = trace::requested(&machine, [&fit, &held_out], trace::Request::default(), progress)
        .map_err(|error| error.to_string())?;
    progress("simulating what each cause costs");
    let budget = budget::traced::budget(&trace).unwrap_or_else(|error| {
        notes.push(format!("No error budget: {error}."));
        None
    });
    let document = trace::json::Document::of(&trace, &contour_errors, false);
    let document = Document::of(document, budget.as_ref(), &[]);
    let document = serde_json::to_value(&document).map_err(|error| error.to_string())?;
    let title = format!("Lost motion of {}", trace.machine().name);
    let extra = Extra { title, contour_errors, budget, lead: notes, ..Extra::default() };
    Ok(json!({
        "json": document,
        "page": trace_page::html(&trace, &extra),
        "model": trace.better_machine().to_toml(),
        "summary": sentences::summary(&trace, extra.budget.as_ref()),
    }))
}
