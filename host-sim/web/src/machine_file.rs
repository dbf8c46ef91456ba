//! A machine file from logs, as `lost-motion init`.

use init::known::{self, Known};
use model::machine::Machine;
use serde_json::{Value, json};

use crate::log_file;
use crate::request::{DroppedFile, Init};
use trace::Progress;

/// The text of the machine file, and what was found and what stays unknown.
///
/// # Errors
/// Logs or words that cannot be used, in one line.
pub fn of_logs(request: &Init, files: &[DroppedFile<'_>], progress: &Progress<'_>) -> Result<Value, String> {
    progress("reading the logs");
    let [fit, held_out] = log_file::logs(files)?;
    let logs = [fit, held_out].concat();
    let known = request.known.iter().map(|text| text.parse::<Known>()).collect::<Result<Vec<_>, _>>()?;
    let declared = match request.machine.trim() {
        "" => init::unknown("machine", &logs),
        text => Machine::parse(text, "machine file"),
    };
    let made = declared.and_then(|declared| known::with(&declared, &known, "form"));
    let initial = made.and_then(|declared| init::machine(&declared, &logs, progress));
    let initial = initial.map_err(|error| error.to_string())?;
    let names: Vec<String> = files.iter().map(|file| file.name.clone()).collect();
    Ok(json!({
        "machine": init::written::file(&initial, &names),
        "summary": init::written::summary(&initial),
    }))
}
