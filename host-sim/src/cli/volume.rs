//! `lost-motion volume`.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use super::reading::ReadingArguments;
use ::volume::analysis::Verdict;
use ::volume::survey::Survey;
use ::volume::{Analysis, analyse, beckhoff, grid, linuxcnc, sources, text};
use files::document::read_text;
use files::error::{InputError, quoted};
use files::output::write_whole;

/// A control with tables for the whole volume.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Control {
    /// Beckhoff `TwinCAT` CNC: tables of the volumetric compensation.
    Beckhoff,
    /// LinuxCNC: a kinematics component.
    Linuxcnc,
}

impl Control {
    /// The name of its file.
    const fn file(self) -> &'static str {
        match self {
            Self::Beckhoff => beckhoff::FILE,
            Self::Linuxcnc => linuxcnc::FILE,
        }
    }

    /// The text of its file.
    fn text(self, analysis: &Analysis) -> String {
        match self {
            Self::Beckhoff => beckhoff::csv(analysis),
            Self::Linuxcnc => linuxcnc::component(analysis),
        }
    }
}

/// Arguments of `volume`.
#[derive(clap::Args)]
pub struct Arguments {
    /// File that says which circles and positioning tests were taken, and where.
    #[arg(long)]
    survey: PathBuf,
    /// Write the error of the tool on a grid over the measured volume (CSV).
    #[arg(long)]
    out: Option<PathBuf>,
    /// Largest step of the grid.
    #[arg(long, value_name = "MM", default_value_t = 50.0, requires = "out")]
    step: f64,
    /// Write tables for a control.
    #[arg(long, requires = "out_dir")]
    format: Option<Control>,
    /// Folder of the tables for a control.
    #[arg(long, value_name = "DIR", requires = "format")]
    out_dir: Option<PathBuf>,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArguments,
}

/// Runs the command.
///
/// # Errors
/// A survey or measurement that cannot be used, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let name = arguments.survey.display().to_string();
    let survey = Survey::parse(&read_text(&arguments.survey)?, &arguments.survey)?;
    let measured = survey.measurements.iter().flat_map(|measurement| &measurement.files);
    let inputs: Vec<&Path> =
        std::iter::once(&arguments.survey).chain(measured).map(PathBuf::as_path).collect();
    let page = pages::file_in(arguments.report.as_ref());
    let control = arguments.format.zip(arguments.out_dir.as_ref());
    let table = control.map(|(format, folder)| folder.join(format.file()));
    let outputs = [
        Output::File("--out", arguments.out.as_ref()),
        Output::InNewFolder("--out-dir", table.as_ref()),
        Output::File("--json", arguments.json.as_ref()),
        Output::InNewFolder("--report", page.as_ref()),
    ];
    check_outputs(&inputs, &outputs)?;
    let request = arguments.reading.request()?;
    let progress = Progress::start();
    progress.show("reading the measurements");
    let groups = sources::read(&survey, &request)?;
    progress.show("fitting the errors");
    let analysis = analyse(survey.chain, groups)?;
    drop(progress);
    check_step(arguments, &analysis, &name)?;
    write_json(arguments.json.as_ref(), &analysis)?;
    let mut output = text::of(&analysis);
    let is_refuted = analysis.verdict == Verdict::Refuted;
    if !is_refuted {
        if let Some(path) = &arguments.out {
            let csv = grid::csv(&analysis, arguments.step);
            write_whole(path, |out| out.write_all(csv.as_bytes()))?;
            output += &format!("\n\nTable: {}", path.display());
        }
        if let (Some((format, folder)), Some(path)) = (control, &table) {
            let text = format.text(&analysis);
            files::output::create_folder(folder)?;
            write_whole(path, |out| out.write_all(text.as_bytes()))?;
            output += &format!("\n\nControl: {}", path.display());
        }
    }
    if let Some(folder) = &arguments.report {
        let path = report::volume_page::write(folder, &analysis)?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)?;
    if is_refuted && (arguments.out.is_some() || arguments.format.is_some()) {
        bail!(
            "no table was written: a measurement is worse with the errors found; a table from before is as it was"
        );
    }
    Ok(())
}

/// The step of the grid must be positive and leave a file of a sensible size.
fn check_step(arguments: &Arguments, analysis: &Analysis, survey: &str) -> Result<(), InputError> {
    let step_mm = arguments.step;
    if !(step_mm.is_finite() && step_mm > 0.0) {
        return Err(InputError::expected("--step", "a number above 0", quoted(&step_mm.to_string())));
    }
    let points = grid::points(analysis, step_mm);
    if arguments.out.is_some() && points > grid::MAX_POINTS as f64 {
        let expected = format!("a step with at most {} points in the volume of {survey}", grid::MAX_POINTS);
        return Err(InputError::expected("--step", expected, format!("{points}")));
    }
    Ok(())
}
