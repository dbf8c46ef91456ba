//! `lost-motion record`: the same motion with the controller on a board, or on the emulated one.

use std::path::PathBuf;

use super::progress::Progress;
use super::refusal::Given;
use super::{say, summary};
use crate::controller::Format;
use crate::demo;
use crate::link;
use crate::machine::Machine;
use crate::motion::Motion;
use crate::path;
use crate::plant::desk::Instruments;
use crate::servo;
use crate::simulate::{self, Run};
use anyhow::Result;

/// What messages call the machine of the demo.
const DEMO_MACHINE: &str = "machines/demo.toml";

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
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, a link that fails, a loop that does not hold, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
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
    let board = link::open(&arguments.port, Format::Fixed, servo::rates(&machine), &settings, &start);
    let mut board = board.map_err(|error| given.blamed(error))?;
    let run = Run {
        machine: &machine,
        instruments: Instruments::of(&machine, arguments.seed),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s: 0.0,
    };
    let progress = Progress::start();
    let mut costs = Vec::new();
    let log = run.log(board.as_mut(), |time_s, status, _| {
        progress.machine_time(time_s);
        costs.extend(status.cost);
    });
    drop(progress);
    let log = log.map_err(|error| given.blamed(error))?;
    log.write(&arguments.out)?;
    let mut said = format!(
        "{} ran {} on {}: {} samples in {}.\n\n{}",
        machine.name,
        motion.name,
        arguments.port,
        log.len(),
        arguments.out.display(),
        summary::of_log(&log)
    );
    costs.sort_unstable();
    if let (Some(median), Some(worst)) = (costs.get(costs.len() / 2), costs.last()) {
        said +=
            &format!("\n\n{} ticks: {median} instructions in the median, {worst} at the worst.", costs.len());
    }
    say(&said)
}
