//! `lost-motion compensate`: from a model to the compensation that the controller applies.

use std::path::{Path, PathBuf};

use anyhow::{Error, Result};
use serde_json::{Value, json};

use super::compensation::check_margins;
use super::input_error::Inputs;
use super::margins::LimitArguments;
use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use commissioning::compensate::counted_motions::{self, SETTLE_S};
use commissioning::compensate::planning::Planning;
use commissioning::compensate::prediction::{PredictionError, TestMotion};
use commissioning::compensate::{CompensationFile, standard_motions, text};
use commissioning::margins::MarginLimits;
use commissioning::margins::axis_margins::{self, AxisMargins, MarginError};
use controls::{Control, ControlFile};
use files::error::InputError;
use files::output::{create_folder, write_whole};
use model::machine::Machine;
use plant::instruments::Instruments;

/// Arguments of `compensate`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model: a machine file with the effects found, as `trace --model` writes it.
    #[arg(long)]
    model: PathBuf,
    /// Compensation file to write (TOML).
    #[arg(long)]
    out: PathBuf,
    /// Motion whose contour error counts; may be given several times; default: a circle and corners, or the travel
    /// in which the errors of the model are known.
    #[arg(long)]
    motion: Vec<PathBuf>,
    /// Write what is compensated and what is not as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Also write files for another control.
    #[arg(long, value_enum, requires = "out_dir")]
    format: Option<Control>,
    /// Folder for the files of --format; made if it is missing.
    #[arg(long, value_name = "DIR", requires = "format")]
    out_dir: Option<PathBuf>,
    /// Time on the session clock at which the compensation is set, s.
    #[arg(long, default_value_t = 0.0, value_name = "SECONDS")]
    set_at_s: f64,
    /// Seed of the sensors' noise in the prediction.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    limits: LimitArguments,
}

/// Runs the command.
///
/// # Errors
/// Invalid input, a model that cannot be simulated, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs: Vec<&Path> =
        [&arguments.model].into_iter().chain(&arguments.motion).map(PathBuf::as_path).collect();
    let control_file = arguments.out_dir.as_ref().map(|folder| folder.join("README.txt"));
    let outputs = [
        Output::File("--out", Some(&arguments.out)),
        Output::File("--json", arguments.json.as_ref()),
        Output::InNewFolder("--out-dir", control_file.as_ref()),
    ];
    check_outputs(&inputs, &outputs)?;
    if !(arguments.set_at_s >= 0.0 && arguments.set_at_s.is_finite()) {
        return Err(InputError::expected(
            "--set-at-s",
            "a time of at least 0 s",
            format!("{:?}", arguments.set_at_s),
        )
        .into());
    }
    let limits = arguments.limits.checked()?;
    let model = Machine::read(&arguments.model)?;
    let model_file = arguments.model.display().to_string();
    let mut tests = test_motions(&arguments.motion, &model, arguments.set_at_s)?;
    let mut watched = standard_motions::all(&model, &tests, arguments.set_at_s)?;
    if arguments.format.is_some() {
        tests.iter_mut().chain(&mut watched).for_each(|test| test.settle_s = SETTLE_S);
    }
    let planning = Planning {
        model: &model,
        model_file: &model_file,
        tests: &tests,
        watched: &watched,
        instruments: Instruments::of(&model, arguments.seed),
        set_at_s: arguments.set_at_s,
    };
    let progress = Progress::start();
    progress.show("simulating the motions with and without each compensation");
    let plan = planning.plan().map_err(|error| input_or_failure(error, &model, &model_file))?;
    drop(progress);
    check_margins(&plan.file, &model_file, &model, limits)?;
    let toml = plan.file.to_toml()?;
    let mut json = commissioning::compensate::json::of(&plan);
    let margins = LoopsBeforeAfter::of(&model, &plan.file, limits).ok();
    json["margins"] = margins.as_ref().map(|margins| margins.json(limits)).unwrap_or_default();
    // One after the other: Ctrl-C in between, or while the margins are computed, would leave one without the other.
    write_whole(&arguments.out, |out| out.write_all(toml.as_bytes()))?;
    write_json(arguments.json.as_ref(), &json)?;
    let mut remarks = margins.map(|margins| margins.remarks(limits)).unwrap_or_default();
    if let (Some(control), Some(folder)) = (arguments.format, &arguments.out_dir) {
        remarks.push(for_control(control, &model, &plan.file, folder)?);
    }
    print(&[vec![text::of(&plan)], remarks].concat().join("\n\n"))
}

/// Writes the files of another control, and what they do not say into its README.txt; the text for the terminal.
fn for_control(control: Control, model: &Machine, file: &CompensationFile, folder: &Path) -> Result<String> {
    let written = controls::write(control, model, file);
    if written.files.is_empty() {
        let remarks = written.remarks.join("\n");
        return Ok(format!("Nothing of this compensation can be written for this control.\n{remarks}")
            .trim()
            .to_owned());
    }
    let remarks: String = written.remarks.iter().map(|remark| format!("- {remark}\n")).collect();
    let readme = ControlFile { name: "README.txt".to_owned(), text: remarks.clone() };
    create_folder(folder)?;
    for file in written.files.iter().chain([&readme]) {
        write_whole(&folder.join(&file.name), |out| out.write_all(file.text.as_bytes()))?;
    }
    let names: Vec<&str> = written.files.iter().map(|file| file.name.as_str()).collect();
    Ok(format!("{}: {}\n{}", folder.display(), names.join(", "), remarks.trim_end()))
}

/// Margins with the settings of the model and with those of the compensation.
struct LoopsBeforeAfter {
    before: Vec<AxisMargins>,
    after: Vec<AxisMargins>,
}

impl LoopsBeforeAfter {
    fn of(
        model: &Machine,
        file: &CompensationFile,
        limits: MarginLimits,
    ) -> std::result::Result<Self, MarginError> {
        let instruments = Instruments::of(model, 0);
        Ok(Self {
            before: axis_margins::of_machine(model, &instruments, limits)?,
            after: axis_margins::of_machine(&file.applied_to(model), &instruments, limits)?,
        })
    }

    fn json(&self, limits: MarginLimits) -> Value {
        let [before, after] =
            [&self.before, &self.after].map(|axes| commissioning::margins::json::of(axes, limits));
        json!({"before": before, "after": after})
    }

    /// The axes whose loops do not have the margins, as they did not before.
    fn remarks(&self, limits: MarginLimits) -> Vec<String> {
        let MarginLimits { gain_db, phase_deg } = limits;
        let below = self.after.iter().filter(|axis| !axis.meet(limits));
        let remark = |axis: &AxisMargins| {
            format!(
                "{}: a loop has margins below {gain_db} dB and {phase_deg}°, as without the compensation, which makes none lower.",
                axis.axis
            )
        };
        below.map(remark).collect()
    }
}

/// The motions of files, or the default ones.
pub fn test_motions(paths: &[PathBuf], model: &Machine, start_s: f64) -> Result<Vec<TestMotion>, InputError> {
    if paths.is_empty() { counted_motions::default(model, start_s) } else { motions_of(paths, start_s) }
}

/// The motions of these files.
pub fn motions_of(paths: &[PathBuf], start_s: f64) -> Result<Vec<TestMotion>, InputError> {
    paths.iter().map(|path| TestMotion::read(path, start_s)).collect()
}

/// A model that lacks a key, or a setting that the controller refuses, is an error of the input.
pub fn input_or_failure(error: PredictionError, machine: &Machine, machine_file: &str) -> Error {
    match error {
        PredictionError::Input(error) => error.into(),
        PredictionError::Simulation { motion, error } => {
            Inputs { machine, machine_file, motion_file: &motion }.error(error)
        }
        PredictionError::Beyond { part, refused } => {
            let problem = format!(
                "the compensation of {part} is beyond what the controller takes: {}: {}",
                refused.setting(),
                refused.problem()
            );
            InputError::new(machine_file, problem).at_key(&format!("axis.{}", refused.axis)).into()
        }
        error => InputError::new(machine_file, error.to_string()).into(),
    }
}
