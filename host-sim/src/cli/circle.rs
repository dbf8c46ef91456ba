//! `lost-motion circle`.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use anyhow::Result;

use super::help;
use super::logs;
use super::outputs::{check_json_and_page, print, write_json};
use super::progress::Progress;
use super::reading::ReadingArguments;
use ::circle::measured::Measured;
use ::circle::radius_table::Nominal;
use ::circle::{analyse, json, text};
use ::import::request::Request;
use ::import::{Foreign, any_log, ballbar};
use files::error::{InputError, quoted};
use files::head::Head;
use files::log::Log;
use files::table::Table;

/// Arguments of `circle`.
#[derive(clap::Args)]
#[command(after_help = help::CIRCLE)]
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
    reading: ReadingArguments,
}

/// Runs the command.
///
/// # Errors
/// Input that is no circle, output that cannot be written.
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
    write_json(arguments.json.as_ref(), &json::of(&analysis))?;
    let mut output = text::of(&analysis);
    if let Some(folder) = &arguments.report {
        let path = report::circle_page::write(folder, &analysis)?;
        output += &format!("\n\nReport: {}", path.display());
    }
    print(&output)
}

/// A log, or a table of radii.
enum Input<'a> {
    Log(Log),
    Table(Box<Table<'a>>),
}

/// The circle of one or two logs, or of one or two tables.
fn read(arguments: &Arguments) -> Result<Measured, InputError> {
    let nominal = nominal(arguments)?;
    let request = arguments.reading.request()?;
    let sources: Vec<String> = arguments.log.iter().map(|path| path.display().to_string()).collect();
    let (mut tables, mut logs) = (Vec::new(), Vec::new());
    for (path, source) in arguments.log.iter().zip(&sources) {
        match input(path, source, &request)? {
            Input::Table(table) => tables.push((*table, source.clone())),
            Input::Log(log) => logs.push(log),
        }
    }
    match (&tables[..], &logs[..]) {
        (_, []) => Measured::of_radius_tables(tables, nominal),
        ([], logs) if nominal != Nominal::default() => {
            let expected = "a table with radius_mm or radius_um beside --radius, --feed or --start";
            Err(InputError::expected(&logs[0].source, expected, "a log"))
        }
        ([], logs) => Measured::of_logs(logs),
        ([(_, table), ..], logs) => {
            let expected = format!("a table with radius_mm or radius_um, as {table}");
            Err(InputError::expected(&logs[0].source, expected, "a log"))
        }
    }
}

/// Opens a file. What was assumed of a foreign one is told on stderr.
fn input<'a>(path: &Path, source: &'a str, request: &Request) -> Result<Input<'a>, InputError> {
    let head = Head::open(path, source)?;
    if ballbar::has_radius(&head.names()) {
        return Ok(Input::Table(Box::new(Table::of_input(head.into_input(), source)?)));
    }
    match any_log::log_or_ballbar(head, source, request)? {
        Foreign::Log(imported) => Ok(Input::Log(logs::told(imported))),
        Foreign::Ballbar(table) => {
            logs::tell(source, &table.notes);
            let csv = Box::new(Cursor::new(table.csv()));
            Ok(Input::Table(Box::new(Table::of_input(csv, source)?)))
        }
    }
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
