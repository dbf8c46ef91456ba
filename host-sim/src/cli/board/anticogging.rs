//! `lost-motion board anticogging`: the cogging of a motor, learned from slow passes, as a compensation file.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::consent;
use super::port::{AxisArguments, check_value};
use super::record;
use super::upload;
use crate::cli::outputs::{Output, check_outputs, print, write_json};
use crate::cli::progress::Progress;
use crate::cli::stop;
use ::board::{BoardError, Client};
use commissioning::anticogging::passes::{self, Sample};
use commissioning::anticogging::plan::ACCELERATION_M_PER_S2;
use commissioning::anticogging::{AnticoggingFile, Declared, Learned, Plan, PlanError, Wanted, table, text};
use commissioning::compensate::CompensationFile;
use files::error::InputError;
use files::output::write_whole;
use model::axis::Settings;
use model::effects::{EffectModel, TorqueRipple};
use model::machine::Machine;
use shared::interpolate::{BlockOf, PathError};
use shared::link::message::PerAxis;
use shared::link::refusal::Refusal;

/// Speed of the way to the start of the passes, m/s.
const APPROACH_M_PER_S: f64 = 0.02;

/// Standstill before the passes, s.
const DWELL_S: f64 = 0.2;

/// Numbers of passes back and forth: half of them are held out, and the scatter of the others needs two.
const PASSES: std::ops::RangeInclusive<usize> = 4..=30;

/// Farthest end of the travel, mm.
const FARTHEST_MM: f64 = 1e5;

/// Longest measurement, s: its samples are kept in memory.
const LONGEST_S: f64 = 1200.0;

/// Arguments of `board anticogging`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    axis: AxisArguments,
    /// Lower end of the travel; default: some periods about the place of the axis.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    from_mm: Option<f64>,
    /// Upper end of the travel.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    to_mm: Option<f64>,
    /// Speed of the passes; default: the greatest at which the velocity loop holds the axis against every wave.
    #[arg(long, value_name = "MM_PER_MIN", allow_negative_numbers = true)]
    speed_mm_per_min: Option<f64>,
    /// Period whose harmonics are looked for, at most two; default: the lead of the machine file.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    period_mm: Vec<f64>,
    /// Number of harmonics of each period, 1 to 12.
    #[arg(long, default_value_t = 8)]
    harmonics: usize,
    /// Passes back and forth, 4 to 30: every second one is not used by the fit and judges it.
    #[arg(long, default_value_t = 4)]
    passes: usize,
    /// Machine file with the settings that the board has; default: that of the emulated board.
    #[arg(long)]
    machine: Option<PathBuf>,
    /// Compensation file that the board has: its other compensations remain in the new one.
    #[arg(long)]
    compensation: Option<PathBuf>,
    /// Compensation file to write (TOML). Without cogging none is written.
    #[arg(long)]
    out: PathBuf,
    /// Write what was learned as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Do not ask before the drives are switched on and the axis moves.
    #[arg(long)]
    yes: bool,
}

/// Runs the command.
///
/// # Errors
/// Invalid arguments, no consent, a board that cannot be reached or refuses the motion, drives that go off, an axis that did not move evenly,
/// output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let axis = usize::from(arguments.axis.number()?);
    check(arguments)?;
    let inputs: Vec<&Path> =
        [&arguments.machine, &arguments.compensation].into_iter().flatten().map(PathBuf::as_path).collect();
    let outputs =
        [Output::File("--out", Some(&arguments.out)), Output::File("--json", arguments.json.as_ref())];
    check_outputs(&inputs, &outputs)?;
    let known = Known::read(arguments)?;
    let mut client = arguments.axis.connect()?;
    let tick_hz = client.welcome().rates.velocity_loop_hz;
    record::check_ticks(&known.machine, &known.source, tick_hz)?;
    let decimation = record::decimation(&known.machine, &known.source, tick_hz)?;
    let at_mm = 1e3 * client.status()?.axes[axis].command.to_m();
    let sample_s = f64::from(decimation) / tick_hz;
    let wanted = known.wanted(arguments, at_mm, sample_s)?;
    let plan = Plan::new(&wanted, &known.declared).map_err(|error| of_option(&error))?;
    let passes_s = passes_s(arguments, &plan);
    let expected = format!("a measurement of at most {LONGEST_S} s (a shorter travel, fewer --passes)");
    check_value("--speed-mm-per-min", &expected, passes_s <= LONGEST_S, passes_s)?;
    consent::ask(&consequence(arguments, &plan), arguments.yes)?;
    let samples = measure(&mut client, arguments, (axis, &plan), decimation)?;
    let pairs = passes::pairs(&samples, &plan, arguments.passes, (sample_s, known.declared.force_limit_n))?;
    let steps = &client.welcome().steps;
    let force_step_n = 1.0 / f64::from(1u32 << steps.force_bits.min(14));
    let learned = Learned::of(&pairs, &plan, &known.declared, force_step_n);
    let board = client.welcome().board.to_string();
    let file = AnticoggingFile::new(&board, &arguments.axis.axis, &plan, &learned);
    let written = write(arguments, known, (&plan, &learned), &board)?;
    write_json(arguments.json.as_ref(), &file)?;
    print(&format!("{}\n\n{written}", text::of(&file)))
}

/// Checks the numbers that do not depend on the machine.
fn check(arguments: &Arguments) -> Result<(), InputError> {
    for (option, value) in [("--from-mm", arguments.from_mm), ("--to-mm", arguments.to_mm)] {
        let value = value.unwrap_or(0.0);
        let expected = format!("a position from -{FARTHEST_MM} to {FARTHEST_MM} mm");
        check_value(option, &expected, value.abs() <= FARTHEST_MM, value)?;
    }
    let passes = arguments.passes;
    if !PASSES.contains(&passes) {
        let expected = format!("a number from {} to {}", PASSES.start(), PASSES.end());
        return Err(InputError::expected("--passes", expected, passes));
    }
    Ok(())
}

/// What the files say.
struct Known {
    machine: Machine,
    source: String,
    settings: Settings,
    declared: Declared,
    compensation: CompensationFile,
}

impl Known {
    fn read(arguments: &Arguments) -> Result<Self> {
        let (machine, source) = record::machine_of(arguments.machine.as_deref())?;
        let compensation = match &arguments.compensation {
            Some(path) => CompensationFile::read(path, &machine)?,
            None => CompensationFile::none(&machine),
        };
        let name = &arguments.axis.axis;
        let machine = compensation.applied_to(&machine);
        upload::settings(&machine, &source)?;
        let lacks = || upload::of_other_axes(&source);
        let settings = machine.axis.get(name).ok_or_else(lacks)?.settings.clone();
        let declared = Declared::of(&settings).map_err(|key| {
            let expected = "this key, without which the speed of the velocity loop is not known";
            InputError::expected(&source, expected, "none").at_key(&format!("axis.{name}.{key}"))
        })?;
        Ok(Self { machine, source, settings, declared, compensation })
    }

    fn wanted(&self, arguments: &Arguments, at_mm: f64, sample_s: f64) -> Result<Wanted, InputError> {
        let mut periods_mm = arguments.period_mm.clone();
        if periods_mm.is_empty() {
            let problem = format!("expected a period: {} declares no lead_mm for this axis", self.source);
            periods_mm.push(self.declared.lead_mm.ok_or_else(|| InputError::new("--period-mm", problem))?);
        }
        Ok(Wanted {
            periods_mm,
            harmonics: arguments.harmonics,
            from_mm: arguments.from_mm,
            to_mm: arguments.to_mm,
            speed_mm_per_s: arguments.speed_mm_per_min.map(|mm_per_min| mm_per_min / 60.0),
            at_mm,
            sample_s,
        })
    }
}

/// What cannot be planned is an error of an option.
fn of_option(error: &PlanError) -> InputError {
    let option = match error {
        PlanError::Period | PlanError::Alike { .. } => "--period-mm",
        PlanError::Harmonics => "--harmonics",
        PlanError::Speed { .. } => "--speed-mm-per-min",
        PlanError::Travel { .. } | PlanError::Beyond { .. } | PlanError::Points { .. } => {
            "--from-mm, --to-mm"
        }
    };
    InputError::new(option, error.to_string())
}

/// Duration of the passes, s.
fn passes_s(arguments: &Arguments, plan: &Plan) -> f64 {
    let [from_mm, to_mm] = plan.travel_mm;
    2.0 * arguments.passes as f64 * (to_mm - from_mm) / plan.speed_mm_per_s
}

/// What is going to move, for the question.
fn consequence(arguments: &Arguments, plan: &Plan) -> String {
    let [from_mm, to_mm] = plan.travel_mm;
    let passes_s = passes_s(arguments, plan);
    format!(
        "anticogging switches the drives on if they are off, moves {} to {from_mm:.3} mm, and then {} times to {to_mm:.3} mm and back at \
         {:.1} mm/min, for {passes_s:.0} s",
        arguments.axis.axis,
        arguments.passes,
        60.0 * plan.speed_mm_per_s
    )
}

/// Moves the axis, and collects its samples. The board checks the whole motion before anything moves.
fn measure(
    client: &mut Client,
    arguments: &Arguments,
    (axis, plan): (usize, &Plan),
    decimation: u32,
) -> Result<Vec<Sample>> {
    stop::write_partial_result();
    client.enable()?;
    stop::check_before_motion()?;
    let at_m: PerAxis<f64> = client.status()?.axes.iter().map(|axis| axis.command.to_m()).collect();
    let line = |to_mm: f64, m_per_s: f64| {
        let mut to_m = at_m.clone();
        to_m[axis] = 1e-3 * to_mm;
        BlockOf::line_to(to_m, m_per_s, ACCELERATION_M_PER_S2)
    };
    let [from_mm, to_mm] = plan.travel_mm;
    let m_per_s = 1e-3 * plan.speed_mm_per_s;
    let mut blocks = Vec::new();
    if (at_m[axis] - 1e-3 * from_mm).abs() > record::AT_START_M {
        blocks.push(line(from_mm, APPROACH_M_PER_S));
    }
    blocks.push(BlockOf::dwell(DWELL_S));
    for _ in 0..arguments.passes {
        blocks.extend([line(to_mm, m_per_s), line(from_mm, m_per_s)]);
    }
    client.send_motion(&blocks).map_err(refused)?;
    let progress = Progress::start();
    let samples = record::run_and_stream(client, blocks.len(), decimation, &progress)?;
    let of_axis = |sample: &PerAxis<::board::samples::AxisSample>| Sample {
        command_m: sample[axis].command_m,
        motor_m: sample[axis].motor_m,
        force_n: sample[axis].force_n,
    };
    Ok(samples.iter().map(of_axis).collect())
}

/// A motion that the board refuses is an error of the travel or the speed, unless the axis has to be homed first.
fn refused(error: BoardError) -> anyhow::Error {
    match &error {
        BoardError::Refused(Refusal::Path { error: PathError::NotHomed { .. }, .. }) => error.into(),
        BoardError::Refused(Refusal::Path { .. } | Refusal::TooFast { .. }) => {
            InputError::new("--from-mm, --to-mm", error.to_string()).into()
        }
        _ => error.into(),
    }
}

/// Writes the compensation, if cogging was found. Returns what to do with it.
fn write(
    arguments: &Arguments,
    known: Known,
    (plan, learned): (&Plan, &Learned),
    board: &str,
) -> Result<String> {
    let out = arguments.out.display();
    let tables = table::tables(learned, &plan.periods_mm);
    if tables.is_empty() {
        return Ok(format!("{out} is not written: there is nothing to compensate."));
    }
    let Known { machine, source, settings, compensation: mut file, .. } = known;
    table::set(&mut file, (&arguments.axis.axis, &settings), tables, (board, TorqueRipple::NAME));
    if let Some(refused) = file.refused(&machine) {
        anyhow::bail!("{out} is not written: the controller does not take it: {refused}");
    }
    let toml = file.to_toml()?;
    write_whole(&arguments.out, |out| out.write_all(toml.as_bytes()))?;
    let port = arguments.axis.port.name();
    let source = if arguments.machine.is_some() { source } else { format!("host-sim/{source}") };
    Ok(format!(
        "The force ripple is in {out}. With the drives off, the board takes it, and keeps it with --save:\n  \
         lost-motion board disable --port {port}\n  \
         lost-motion board upload --port {port} --machine {source} --compensation {out}"
    ))
}
