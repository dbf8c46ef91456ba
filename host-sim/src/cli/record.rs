//! `lost-motion record`: the same motion with the controller on the emulated core.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use super::refusal::Given;
use super::{check_outputs, logged, print};
use anyhow::Result;
use files::error::InputError;
use link::controller::Format;
use link::emulator::PATIENCE;
use model::machine::Machine;
use model::motion::Motion;
use model::servo;
use plant::instruments::Instruments;
use plant::path;
use plant::simulate::{self, Run};
use studies::demo;

/// What messages call the machine of the demo.
const DEMO_MACHINE: &str = "machines/demo.toml";

/// A board that has not answered by then never will, s.
const LONGEST_PATIENCE_S: f64 = 3600.0;

/// Arguments of `record`.
#[derive(clap::Args)]
pub struct Arguments {
    /// `emulated`, or `emulated:PATH` of its program.
    #[arg(long)]
    port: String,
    /// Machine file; without one the machine of the demo.
    #[arg(long)]
    machine: Option<PathBuf>,
    /// Motion file.
    #[arg(long)]
    motion: PathBuf,
    /// Log to write (CSV, or .csv.gz).
    #[arg(long)]
    out: PathBuf,
    /// How long an answer of the emulated core may take before it is given up, s.
    #[arg(long, value_name = "SECONDS", default_value_t = PATIENCE.as_secs_f64())]
    timeout_s: f64,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, a link that fails, a loop that does not hold, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let patience = patience(arguments.timeout_s)?;
    let machine_path = arguments.machine.as_deref().unwrap_or(&arguments.motion);
    check_outputs(&[machine_path, &arguments.motion], &[("--out", Some(&arguments.out))])?;
    let machine = match &arguments.machine {
        Some(path) => Machine::read(path)?,
        None => Machine::parse(demo::MACHINE, DEMO_MACHINE)?,
    };
    let motion = Motion::read(&arguments.motion)?;
    let machine_file =
        arguments.machine.as_ref().map_or_else(|| DEMO_MACHINE.to_owned(), |path| path.display().to_string());
    let motion_file = &arguments.motion.display().to_string();
    let given = Given { machine: &machine, machine_file: &machine_file, motion_file };
    let path = path::of(&motion, &machine, motion_file)?;
    let set_up = simulate::set_up(&machine, &path.start_m);
    let (settings, start) = set_up.map_err(|error| given.blamed(error))?;
    let board =
        link::open(&arguments.port, patience, Format::Fixed, servo::rates(&machine), &settings, &start);
    let mut board = board.map_err(|error| given.blamed(error))?;
    let run = Run {
        machine: &machine,
        instruments: Instruments::of(&machine, arguments.seed),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s: 0.0,
    };
    // How many ticks cost so many instructions.
    let mut costs: BTreeMap<u32, u64> = BTreeMap::new();
    let logged = logged::run(&run, board.as_mut(), &arguments.out, &given, |status| {
        if let Some(cost) = status.cost {
            *costs.entry(cost).or_default() += 1;
        }
    })?;
    let mut said = format!(
        "{} ran {} on {}: {} samples in {}.\n\n{}",
        machine.name,
        motion.name,
        arguments.port,
        logged.samples,
        arguments.out.display(),
        logged.summary()
    );
    let ticks: u64 = costs.values().sum();
    if let (Some(median), Some((worst, _))) = (median(&costs, ticks), costs.last_key_value()) {
        said += &format!("\n\n{ticks} ticks: {median} instructions in the median, {worst} at the worst.");
    }
    print(&said)
}

/// How long to wait for an answer.
fn patience(seconds: f64) -> Result<Duration, InputError> {
    let is_possible = seconds > 0.0 && seconds <= LONGEST_PATIENCE_S;
    let wanted = || format!("seconds above 0 and up to {LONGEST_PATIENCE_S}");
    if is_possible {
        return Ok(Duration::from_secs_f64(seconds));
    }
    Err(InputError::expected("--timeout-s", wanted(), seconds))
}

/// The cost that half of the ticks do not exceed.
fn median(costs: &BTreeMap<u32, u64>, ticks: u64) -> Option<u32> {
    let mut seen = 0;
    let reaches_half = |(cost, count): (&u32, &u64)| {
        seen += count;
        (2 * seen > ticks).then_some(*cost)
    };
    costs.iter().find_map(reaches_half)
}
