//! `lost-motion positions`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::outputs::{Output, check_outputs, print, write_json};
use ::import::budget::Budget;
use ::import::request::{Mapping, UnitOf};
use ::positions::columns::Request;
use ::positions::measured::Test;
use ::positions::source::Feedback;
use ::positions::{Analysis, Options, analyse, files_axis, json, machine_file, read, text};
use files::axis_name::{AXIS_NAME, is_axis_name};
use files::error::{InputError, quoted};
use files::head::Head;
use files::output::write_whole;
use model::machine::Machine;

/// What closes the position loop.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Closes {
    /// The encoder or resolver of the motor.
    Motor,
    /// A linear scale.
    Scale,
}

/// Arguments of `positions`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Readings of a positioning test (CSV, .csv.gz, .rtl, or - for stdin): `run`, `approach` (+ or -), `target_mm` and `measured_mm` or
    /// `deviation_um`, and `time_s` if known; may be given several times.
    #[arg(long, required = true)]
    fit: Vec<PathBuf>,
    /// Runs of the axis that take no part but in the final residuals; may be given several times.
    #[arg(long)]
    validate: Vec<PathBuf>,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    /// Write a machine file with the effects found.
    #[arg(long)]
    model: Option<PathBuf>,
    /// Declared machine, to which --model adds the effects. Default: nothing is known of it.
    #[arg(long, requires = "model")]
    machine: Option<PathBuf>,
    /// Name of the axis. Default: the name of the file if it is one letter, otherwise x.
    #[arg(long)]
    axis: Option<String>,
    /// What closes the position loop, if it is known: it tells errors of the screw from those of the scale.
    #[arg(long)]
    feedback: Option<Closes>,
    /// Column of the file: `measured_mm=Actual`. Without a header, columns are counted from 1.
    #[arg(long = "map", value_name = "OURS=THEIRS")]
    mappings: Vec<Mapping>,
    /// Unit of a column, if its header does not say it: `measured_mm=um`, `target_mm=in`, `time_s=min`.
    #[arg(long = "unit", value_name = "OURS=UNIT")]
    units: Vec<UnitOf>,
}

/// Runs the command.
///
/// # Errors
/// Input that is no positioning test, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs: Vec<&Path> = arguments
        .fit
        .iter()
        .chain(&arguments.validate)
        .chain(&arguments.machine)
        .map(PathBuf::as_path)
        .collect();
    let page = pages::file_in(arguments.report.as_ref());
    let outputs = [
        Output::File("--json", arguments.json.as_ref()),
        Output::InNewFolder("--report", page.as_ref()),
        Output::File("--model", arguments.model.as_ref()),
    ];
    check_outputs(&inputs, &outputs)?;
    let options = options(arguments)?;
    let request = Request { mappings: arguments.mappings.clone(), units: arguments.units.clone() };
    let tests =
        |paths: &[PathBuf]| paths.iter().map(|path| test(path, &request)).collect::<Result<Vec<_>, _>>();
    let fitted = tests(&arguments.fit)?.into_iter().reduce(Test::followed_by);
    let Some(fitted) = fitted else {
        return Err(InputError::expected("--fit", "a file", "none").into());
    };
    let analysis = analyse(fitted, tests(&arguments.validate)?, &options)?;
    let model = model(arguments, &analysis)?;
    write_json(arguments.json.as_ref(), &json::of(&analysis))?;
    let mut output = text::of(&analysis);
    if let (Some(path), Some((toml, notes))) = (&arguments.model, model) {
        write_whole(path, |out| out.write_all(toml.as_bytes()))?;
        output += &format!("\n{}\nModel: {}", notes.join("\n"), path.display());
    }
    if let Some(folder) = &arguments.report {
        let path = report::positions_page::write(folder, &analysis)?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)
}

fn options(arguments: &Arguments) -> Result<Options, InputError> {
    let axis = match &arguments.axis {
        Some(name) if !is_axis_name(name) => {
            return Err(InputError::expected("--axis", AXIS_NAME, quoted(name)));
        }
        Some(name) => name.clone(),
        None => arguments.fit.first().map_or_else(|| "x".to_owned(), |path| files_axis(path)),
    };
    let feedback = match arguments.feedback {
        None => Feedback::Unknown,
        Some(Closes::Motor) => Feedback::Motor,
        Some(Closes::Scale) => Feedback::Scale,
    };
    Ok(Options { axis, feedback })
}

/// The test in a file; `-` is standard input, and gzip is recognised.
fn test(path: &Path, request: &Request) -> Result<Test, InputError> {
    let source = path.display().to_string();
    let bytes = Budget::file().read(Head::open(path, &source)?.into_input(), &source)?;
    read(&bytes, &source, request)
}

/// The text of the machine file, checked as its reader does, and what is said about it.
fn model(arguments: &Arguments, analysis: &Analysis) -> Result<Option<(String, Vec<String>)>, InputError> {
    let Some(path) = &arguments.model else { return Ok(None) };
    let file = arguments.machine.as_ref().map(|path| path.display().to_string());
    let declared = arguments.machine.as_ref().map(|path| Machine::read(path)).transpose()?;
    let declared = declared.zip(file.as_deref());
    let (machine, notes) = machine_file::of(analysis, declared)?;
    let toml = machine.to_toml();
    Machine::parse(&toml, &path.display().to_string())?;
    Ok(Some((toml, notes)))
}
