//! `lost-motion budget`: what each cause of a model costs at the tool.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::compensate::{input_or_failure, motions_of};
use super::outputs::{check_json_and_page, print, write_json};
use super::progress::Progress;
use ::budget::{Budget, json, text};
use commissioning::compensate::motions_within::{Travel, standard};
use files::error::InputError;
use model::machine::Machine;

/// Arguments of `budget`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model: a machine file with its effects, as `trace --model` writes it.
    #[arg(long)]
    model: PathBuf,
    /// Motion; may be given several times; default: a circle, corners, a small part and a travel of each axis.
    #[arg(long)]
    motion: Vec<PathBuf>,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs the command.
///
/// # Errors
/// Invalid input, a model that cannot be simulated, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs: Vec<&Path> =
        [&arguments.model].into_iter().chain(&arguments.motion).map(PathBuf::as_path).collect();
    let page = pages::file_in(arguments.report.as_ref());
    check_json_and_page(&inputs, arguments.json.as_ref(), page.as_ref())?;
    let model = Machine::read(&arguments.model)?;
    let model_file = arguments.model.display().to_string();
    let travels = Travel::of(&model);
    if travels.is_empty() {
        return Err(
            InputError::expected(&model_file, "a linear axis, whose path can be wrong", "none").into()
        );
    }
    let tests = match &arguments.motion[..] {
        [] => standard(&travels),
        paths => motions_of(paths, 0.0)?,
    };
    let progress = Progress::start();
    progress.show("simulating the motions with and without each cause");
    let budget = Budget::of(&model, &tests, arguments.seed)
        .map_err(|error| input_or_failure(error, &model, &model_file))?;
    drop(progress);
    write_json(arguments.json.as_ref(), &json::Document::of(&budget))?;
    let mut output = text::of(&budget);
    if let Some(folder) = &arguments.report {
        let path = report::budget_page::write(folder, &budget)?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)
}
