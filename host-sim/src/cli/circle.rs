//! `lost-motion circle`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::limits::{self, ToolLimitArguments};
use super::logs;
use super::outputs::{check_json_and_page, print, write_json};
use super::progress::Progress;
use super::reading::ReadingArguments;
use ::circle::measured::Measured;
use ::circle::radius_table::Nominal;
use ::circle::{Analysis, analyse, json, text};
use ::import::any_log::{self, Content};
use budget::limits::{Circular, Judgement, Limit, Limited, of_circle};
use files::error::{InputError, quoted};
use files::head::Head;
use files::table::Table;

/// Arguments of `circle`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Log with the command and a measured position of two axes, or a ballbar's table of `radius_mm` or `radius_um` over `angle_deg`
    /// or `time_s` (CSV, .csv.gz, or - for stdin), or either of another program, see below; two of them, one for each direction.
    #[arg(required = true, num_args = 1..=2)]
    log: Vec<PathBuf>,
    /// Nominal radius of a ballbar's table.
    #[arg(long, value_name = "MM")]
    radius: Option<f64>,
    /// Constant speed of a ballbar's table without angles.
    #[arg(long, value_name = "MM_PER_MIN")]
    feed: Option<f64>,
    /// Angle at which a ballbar's table without angles starts, degrees.
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_hyphen_values = true)]
    start: f64,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    #[command(flatten)]
    limits: ToolLimitArguments,
    #[command(flatten)]
    reading: ReadingArguments,
}

/// Runs the command.
///
/// # Errors
/// Input that is no circle, output that cannot be written; with `--check`, a limit that is not known to be kept.
pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs: Vec<&Path> = arguments.log.iter().map(PathBuf::as_path).collect();
    let page = pages::file_in(arguments.report.as_ref());
    check_json_and_page(&inputs, arguments.json.as_ref(), page.as_ref())?;
    let progress = Progress::start();
    progress.show("reading");
    let measured = read(arguments)?;
    progress.show("evaluating the circle");
    let analysis = analyse(measured)?;
    drop(progress);
    let limits = judged(&analysis, arguments.limits.all());
    let document = Limited { result: json::of(&analysis), limits };
    write_json(arguments.json.as_ref(), &document)?;
    let limits = document.limits;
    let mut output = text::of(&analysis) + &limits::text(&limits);
    if let Some(folder) = &arguments.report {
        let path = report::circle_page::write(folder, &analysis, &limits)?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)?;
    arguments.limits.checked(&limits)
}

/// The limits, judged by the circular deviation.
fn judged(analysis: &Analysis, limits: &[Limit]) -> Vec<Judgement> {
    let Analysis { measured, figures, residual_um, .. } = analysis;
    let of = pages::file_name(&measured.source);
    let (is_at_tool, um) = (measured.is_at_tool(), figures.full_circular_um());
    of_circle(limits, &Circular { of, is_at_tool, um, noise_um: *residual_um })
}

/// The circle of one or two logs, or of one or two tables. What was assumed of a foreign file is told on stderr.
fn read(arguments: &Arguments) -> Result<Measured, InputError> {
    let nominal = nominal(arguments)?;
    let request = arguments.reading.request()?;
    let sources: Vec<String> = arguments.log.iter().map(|path| path.display().to_string()).collect();
    let (mut tables, mut logs) = (Vec::new(), Vec::new());
    for (path, source) in arguments.log.iter().zip(&sources) {
        match any_log::content(Head::open(path, source)?, source, &request)? {
            Content::Log(imported) => logs.push(logs::told(imported)),
            Content::Radii(input, notes) => {
                logs::tell(source, &notes);
                tables.push((Table::of_input(input, source)?, source.clone()));
            }
        }
    }
    Measured::of_files(&logs, tables, nominal)
}

/// The nominal values, checked.
fn nominal(arguments: &Arguments) -> Result<Nominal, InputError> {
    let positive = |flag, value: Option<f64>| match value {
        Some(value) if !(value.is_finite() && value > 0.0) => {
            Err(InputError::expected(flag, "a positive number", quoted(&value.to_string())))
        }
        value => Ok(value),
    };
    if !arguments.start.is_finite() {
        return Err(InputError::expected("--start", "an angle", quoted(&arguments.start.to_string())));
    }
    Ok(Nominal {
        radius_mm: positive("--radius", arguments.radius)?,
        feed_mm_per_min: positive("--feed", arguments.feed)?,
        start_deg: arguments.start,
    })
}
