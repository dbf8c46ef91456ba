//! A compensation as files of a control, as `lost-motion compensate --format`.

use clap::ValueEnum;
use commissioning::compensate::counted_motions::{self, SETTLE_S};
use commissioning::compensate::planning::Planning;
use commissioning::compensate::{standard_motions, text};
use commissioning::margins::MarginLimits;
use commissioning::margins::change;
use controls::Control;
use model::machine::Machine;
use plant::instruments::Instruments;
use serde_json::{Value, json};

use crate::request::Compensate;
use trace::Progress;

/// The files for the control with their remarks, the compensation file of our own controller, and what is compensated.
///
/// # Errors
/// A model that cannot be simulated, in one line.
pub fn of_model(request: &Compensate, progress: &Progress<'_>) -> Result<Value, String> {
    let control = Control::from_str(&request.control, true)?;
    let model = Machine::parse(&request.model, "machine file").map_err(|error| error.to_string())?;
    progress("simulating the motions with and without each compensation");
    let mut tests = counted_motions::default(&model, 0.0).map_err(|error| error.to_string())?;
    let mut watched = standard_motions::all(&model, &tests, 0.0).map_err(|error| error.to_string())?;
    tests.iter_mut().chain(&mut watched).for_each(|test| test.settle_s = SETTLE_S);
    let planning = Planning {
        model: &model,
        model_file: "machine file",
        tests: &tests,
        watched: &watched,
        instruments: Instruments::of(&model, 1),
        set_at_s: 0.0,
    };
    let plan = planning.plan().map_err(|error| error.to_string())?;
    let after = plan.file.applied_to(&model);
    change::check(&model, &after, MarginLimits::default(), "compensation")
        .map_err(|error| error.to_string())?;
    let written = controls::write(control, &model, &plan.file);
    let files = written.files.iter().map(|file| json!({"name": file.name, "text": file.text}));
    Ok(json!({
        "files": files.collect::<Value>(),
        "remarks": written.remarks,
        "compensation": plan.file.to_toml().map_err(|error| error.to_string())?,
        "summary": text::of(&plan),
    }))
}
