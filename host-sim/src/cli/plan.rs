//! `lost-motion plan`: the motion that decides what a model leaves open.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::Result;

use super::outputs::{Output, check_outputs, print, write_json};
use super::progress::Progress;
use budget::motions::Travel;
use files::error::InputError;
use files::output::write_whole;
use model::machine::Machine;
use motion_plan::program::{self, Dialect};
use motion_plan::{Limits, choice, json, text};

/// Arguments of `plan`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Model: a machine file with its effects, their intervals and rivals, as `trace --model` writes it.
    #[arg(long)]
    model: PathBuf,
    /// Motion file to write.
    #[arg(long)]
    out: PathBuf,
    /// Also write the motion as G-code.
    #[arg(long)]
    gcode: Option<PathBuf>,
    /// Control that reads the G-code: linuxcnc, siemens or fanuc.
    #[arg(long, value_name = "CONTROL", default_value = "linuxcnc", requires = "gcode")]
    control: Dialect,
    /// Ends of an axis's travel, mm: `x=0:300`. Default: its soft limits, else the travel of its maps, else -33:33. May be given several
    /// times; axes that are not linear, or excluded by `x=none`, do not move.
    #[arg(long, value_name = "AXIS=FROM:TO", allow_hyphen_values = true)]
    travel: Vec<TravelOf>,
    /// Greatest feed, mm/min.
    #[arg(long, value_name = "MM_PER_MIN", default_value_t = 3000.0)]
    feed: f64,
    /// Greatest acceleration along the path, m/s².
    #[arg(long, value_name = "M_PER_S2", default_value_t = 1.0)]
    acceleration: f64,
    /// Longest time, s.
    #[arg(long, default_value_t = 60.0)]
    seconds: f64,
    /// Narrow the intervals of values that are wider than this part of the value on either side, percent.
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0)]
    within: f64,
    /// Write what is expected as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// The travel of an axis; none: it does not move.
#[derive(Clone, Debug)]
struct TravelOf {
    axis: String,
    ends_mm: Option<[f64; 2]>,
}

impl FromStr for TravelOf {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected AXIS=FROM:TO in mm, as x=0:300, or AXIS=none".to_owned();
        let (axis, ends) = text.split_once('=').ok_or_else(expected)?;
        let axis = axis.to_owned();
        if ends == "none" {
            return Ok(Self { axis, ends_mm: None });
        }
        let (from, to) = ends.split_once(':').ok_or_else(expected)?;
        let [from, to] = [from, to].map(|end| end.trim().parse().ok().filter(|mm: &f64| mm.is_finite()));
        match (from, to) {
            (Some(from), Some(to)) if from < to => Ok(Self { axis, ends_mm: Some([from, to]) }),
            _ => Err(expected()),
        }
    }
}

/// Runs the command.
///
/// # Errors
/// Invalid input, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let outputs = [
        Output::File("--out", Some(&arguments.out)),
        Output::File("--gcode", arguments.gcode.as_ref()),
        Output::File("--json", arguments.json.as_ref()),
    ];
    check_outputs(&[arguments.model.as_path()], &outputs)?;
    let model = Machine::read(&arguments.model)?;
    let limits = limits(arguments, &model)?;
    let progress = Progress::start();
    progress.show("simulating what each motion tells");
    let mut plan = choice::plan(&model, &limits, 0.01 * arguments.within);
    drop(progress);
    plan.notes.extend(notes(&limits));
    if let Some(motion) = &plan.motion {
        let toml =
            motion.to_toml("Written by lost-motion plan: the motion that decides what a model leaves open.");
        write_whole(&arguments.out, |out| out.write_all(toml.as_bytes()))?;
        if let Some(path) = &arguments.gcode {
            let program = program::of(motion, arguments.control);
            write_whole(path, |out| out.write_all(program.as_bytes()))?;
        }
    }
    write_json(arguments.json.as_ref(), &json::of(&plan))?;
    print(&text::of(&plan))
}

fn limits(arguments: &Arguments, model: &Machine) -> Result<Limits, InputError> {
    let positive = |flag: &str, value: f64| {
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(InputError::expected(flag, "a number above 0", value))
        }
    };
    let mut travels = Travel::of(model);
    for own in &arguments.travel {
        let Some(index) = travels.iter().position(|travel| travel.axis == own.axis) else {
            let names: Vec<String> = Travel::of(model).into_iter().map(|travel| travel.axis).collect();
            let expected = format!("a linear axis of the model ({})", names.join(", "));
            return Err(InputError::expected("--travel", expected, files::error::quoted(&own.axis)));
        };
        match own.ends_mm {
            Some(ends_mm) => travels[index].ends_mm = ends_mm,
            None => drop(travels.remove(index)),
        }
    }
    if travels.is_empty() {
        let model = arguments.model.display().to_string();
        return Err(InputError::expected(&model, "a linear axis that may move", "none"));
    }
    travels.truncate(motion::MAX_AXES);
    positive("--within", arguments.within)?;
    Ok(Limits {
        travels,
        speed_mm_s: positive("--feed", arguments.feed)? / 60.0,
        acceleration_m_per_s2: positive("--acceleration", arguments.acceleration)?,
        seconds: positive("--seconds", arguments.seconds)?,
    })
}

/// Where the motion goes, and what it does not know.
fn notes(limits: &Limits) -> [String; 2] {
    let travels: Vec<String> = limits
        .travels
        .iter()
        .map(|travel| format!("{} from {:.3} to {:.3} mm", travel.axis, travel.ends_mm[0], travel.ends_mm[1]))
        .collect();
    [
        format!("It stays within {}; without a workpiece and a tool.", travels.join(", ")),
        "Expected are the intervals of a log of it alone with command, motor, table, tool and force, whose noise is that of the \
         sensors; what the model does not describe widens them."
            .to_owned(),
    ]
}
