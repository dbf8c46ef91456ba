//! `lost-motion plan`: the shortest motion that decides what a trace left open.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Result, bail};

use super::gcode::Format;
use super::logs;
use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use super::reading::ReadingArguments;
use ::plan::limits::StatedLimits;
use ::plan::{MotionLimits, Plan, Planning};
use files::error::InputError;
use files::output::write_whole;
use model::machine::Machine;

/// What to do with the log of the motion.
const WITH_EARLIER_LOGS: &str = "\nTrace its log together with the logs that you have, if their times are of one clock: an effect that makes either of them worse is not stated as certain.";

/// Arguments of `plan`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Machine file that `trace --model` has written: its ambiguous effects are what the motion is to decide.
    #[arg(long)]
    model: PathBuf,
    /// Log of the machine: the motion stays within its travel, speed and acceleration, and its channels are those that will be
    /// logged. May be given several times.
    #[arg(long, value_name = "LOG")]
    within: Vec<PathBuf>,
    /// Travel of an axis that the motion may use, mm or degrees, `x=-50..200`. Default: that of the logs, otherwise 95 % of `travel_mm` of the model.
    #[arg(long, value_name = "AXIS=FROM..TO", allow_hyphen_values = true)]
    travel: Vec<Travel>,
    /// Largest speed of each axis, mm/s. Default: that of the logs, otherwise `fastest_mm_per_s`, which is never exceeded.
    #[arg(long, value_name = "MM_PER_S")]
    speed_mm_per_s: Option<f64>,
    /// Largest acceleration of each axis, m/s². Default: that of the logs.
    #[arg(long, value_name = "M_PER_S2")]
    acceleration_m_per_s2: Option<f64>,
    /// Longest duration of the motion, s.
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    time_s: f64,
    /// Also narrow the 95 % interval of each value of an effect to this percentage of the value, on either side.
    #[arg(long, value_name = "PERCENT")]
    interval_percent: Option<f64>,
    /// Motion file to write.
    #[arg(long, value_name = "MOTION.toml")]
    out: PathBuf,
    /// Also write the motion as a program of the control of `--format`.
    #[arg(long, value_name = "FILE", requires = "format")]
    gcode: Option<PathBuf>,
    /// The control.
    #[arg(long, requires = "gcode")]
    format: Option<Format>,
    /// Write the plan as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArguments,
}

/// The travel of an axis.
#[derive(Clone)]
struct Travel {
    axis: String,
    mm: [f64; 2],
}

impl FromStr for Travel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let of = || {
            let (axis, range) = text.split_once('=')?;
            let (from, to) = range.split_once("..")?;
            let mm: [f64; 2] = [from.trim().parse().ok()?, to.trim().parse().ok()?];
            let is_travel = !axis.is_empty() && mm.iter().all(|mm| mm.is_finite()) && mm[0] < mm[1];
            is_travel.then(|| Self { axis: axis.trim().to_owned(), mm })
        };
        of().ok_or_else(|| "expected an axis with the ends of its travel, such as x=-50..200".to_owned())
    }
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, limits that nobody states, output that cannot be written; if no motion within the limits
/// decides anything.
pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs: Vec<&Path> =
        arguments.within.iter().chain([&arguments.model]).map(PathBuf::as_path).collect();
    let outputs = [
        Output::File("--out", Some(&arguments.out)),
        Output::File("--gcode", arguments.gcode.as_ref()),
        Output::File("--json", arguments.json.as_ref()),
    ];
    check_outputs(&inputs, &outputs)?;
    let stated = stated(arguments)?;
    let model = Machine::read(&arguments.model)?;
    let logs = logs::read(&arguments.within, &arguments.reading.request()?)?;
    let model = model.named_as_logs(&logs);
    let limits = MotionLimits::new(&model, &stated, &logs, arguments.time_s)?;
    let progress = Progress::start();
    let planning = Planning {
        model: &model,
        limits: &limits,
        logs: &logs,
        interval_percent: arguments.interval_percent,
    };
    let plan = ::plan::plan(&planning, &|what| progress.show(what));
    drop(progress);
    write(arguments, &plan)?;
    print(&plan.text())?;
    if plan.motion.is_some() && !logs.is_empty() {
        print(WITH_EARLIER_LOGS)?;
    }
    if plan.motion.is_none() && plan.has_goals() {
        bail!("no motion is written");
    }
    Ok(())
}

/// The limits of the command line.
fn stated(arguments: &Arguments) -> Result<StatedLimits, InputError> {
    let numbers = [
        ("--speed-mm-per-s", arguments.speed_mm_per_s),
        ("--acceleration-m-per-s2", arguments.acceleration_m_per_s2),
        ("--time-s", Some(arguments.time_s)),
        ("--interval-percent", arguments.interval_percent),
    ];
    for (option, number) in numbers {
        if let Some(number) = number.filter(|number| !(number.is_finite() && *number > 0.0)) {
            return Err(InputError::expected(option, "a finite number above 0", number));
        }
    }
    Ok(StatedLimits {
        travel_mm: arguments.travel.iter().map(|travel| (travel.axis.clone(), travel.mm)).collect(),
        speed_mm_s: arguments.speed_mm_per_s,
        acceleration_m_per_s2: arguments.acceleration_m_per_s2,
    })
}

/// Writes the motion, its program and the JSON.
fn write(arguments: &Arguments, plan: &Plan) -> Result<()> {
    let source = arguments.out.display().to_string();
    if let Some(candidate) = &plan.motion {
        let program = match (&arguments.gcode, arguments.format, candidate.motion.motion()) {
            (Some(path), Some(format), Some(motion)) => Some((path, format.program(motion, &source)?)),
            _ => None,
        };
        let text = candidate.motion.to_toml("Planned to decide what a trace left open.");
        write_whole(&arguments.out, |out| out.write_all(text.as_bytes()))?;
        if let Some((path, program)) = program {
            write_whole(path, |out| out.write_all(program.as_bytes()))?;
        }
    }
    write_json(arguments.json.as_ref(), &plan.json())
}
