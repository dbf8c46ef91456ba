//! `lost-motion record`: a motion with the controller on the emulated core.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::Result;

use super::board;
use super::compensation::Compensated;
use super::input_error::Inputs;
use super::logged_run;
use super::outputs::{Output, check_outputs, print};
use files::error::InputError;
use lockstep::emulator::{DEFAULT_TIMEOUT, Emulator};
use lockstep::remote::Remote;
use model::machine::Machine;
use motion::Motion;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::simulate::{self, Run, SimulationError};
use shared::scalar::Format;

/// Name of the demo machine in messages.
const DEMO_MACHINE: &str = "machines/demo.toml";

/// Maximum of `--timeout-s`.
const MAX_TIMEOUT_S: f64 = 3600.0;

/// Arguments of `record`.
#[derive(clap::Args)]
pub struct Arguments {
    /// `emulated`, or `emulated:PATH` of its program: the controller on an emulated core, with the machine simulated here.
    /// `bench`, a serial port or a socket: a servo board with its own machine.
    #[arg(long)]
    port: String,
    /// Machine file; default: the demo machine.
    #[arg(long)]
    machine: Option<PathBuf>,
    /// Motion file.
    #[arg(long)]
    motion: PathBuf,
    /// Log to write (CSV, or .csv.gz).
    #[arg(long)]
    out: PathBuf,
    /// Compensation file, as `compensate` writes it.
    #[arg(long)]
    compensation: Option<PathBuf>,
    /// Timeout for an answer of the emulated core, s.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = DEFAULT_TIMEOUT.as_secs_f64())]
    timeout_s: f64,
    /// On a servo board: do not ask before the drives are switched on and the axes move to the start of the motion.
    #[arg(long)]
    yes: bool,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs the command.
///
/// # Errors
/// Invalid input, a failed connection, a fault of the loop, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let timeout = timeout(arguments.timeout_s)?;
    if !is_core(&arguments.port) {
        return on_board(arguments);
    }
    let machine_path = arguments.machine.as_deref().unwrap_or(&arguments.motion);
    let files = [machine_path, &arguments.motion].into_iter().chain(arguments.compensation.as_deref());
    check_outputs(&files.collect::<Vec<_>>(), &[Output::File("--out", Some(&arguments.out))])?;
    let machine = match &arguments.machine {
        Some(path) => Machine::read(path)?,
        None => Machine::parse(demo::MACHINE, DEMO_MACHINE)?,
    };
    let compensated = Compensated::read(arguments.compensation.as_deref(), machine)?;
    let machine = &compensated.machine;
    let motion = Motion::read(&arguments.motion)?;
    let machine_file =
        arguments.machine.as_ref().map_or_else(|| DEMO_MACHINE.to_owned(), |path| path.display().to_string());
    let motion_file = &arguments.motion.display().to_string();
    let inputs = Inputs { machine, machine_file: &machine_file, motion_file };
    let path = MachinePath::new(&motion, machine, motion_file)?;
    let mut controller =
        set_up(&arguments.port, timeout, machine, &path.start_m).map_err(|error| inputs.error(error))?;
    compensated.set(&mut controller)?;
    let run = Run {
        machine,
        instruments: Instruments::of(machine, arguments.seed),
        start_m: &path.start_m,
        blocks: &path.blocks,
        start_s: 0.0,
    };
    let mut costs = Costs::default();
    let statistics =
        logged_run::run(&run, &mut controller, &arguments.out, &inputs, |status| costs.add(status.cost))?;
    print(&format!(
        "{} ran {} on {}: {} samples in {}.\n\n{}{}{}",
        machine.name,
        motion.name,
        arguments.port,
        statistics.samples,
        arguments.out.display(),
        statistics.summary(),
        costs.summary(),
        compensated.remarks(&path)
    ))
}

/// Whether a port is the emulated core, whose machine is simulated here.
fn is_core(port: &str) -> bool {
    port == "emulated" || port.starts_with("emulated:")
}

/// Runs the motion on a servo board.
fn on_board(arguments: &Arguments) -> Result<()> {
    if arguments.compensation.is_some() {
        let problem = "a board keeps its compensation: send it with `board upload` before";
        return Err(InputError::new("--compensation", problem).into());
    }
    let machine_path = arguments.machine.as_deref().unwrap_or(&arguments.motion);
    check_outputs(&[machine_path, &arguments.motion], &[Output::File("--out", Some(&arguments.out))])?;
    let (machine, machine_file) = board::record::machine_of(arguments.machine.as_deref())?;
    board::record::run(&board::record::Recording {
        port: &arguments.port,
        timeout_s: arguments.timeout_s,
        machine: &machine,
        machine_file: &machine_file,
        motion: &Motion::read(&arguments.motion)?,
        motion_file: &arguments.motion.display().to_string(),
        out: &arguments.out,
        yes: arguments.yes,
    })
}

/// Connects to the controller at a port and sets it up for a machine.
fn set_up(
    port: &str,
    timeout: Duration,
    machine: &Machine,
    start_m: &[f64],
) -> Result<Remote<Emulator>, SimulationError> {
    let (settings, start) = simulate::controller_setup(machine, start_m)?;
    let connection = lockstep::open(port, timeout)?;
    Ok(Remote::set_up(connection, Format::Fixed, machine.rates(), &settings, &start)?)
}

/// The timeout for an answer.
fn timeout(seconds: f64) -> Result<Duration, InputError> {
    if seconds > 0.0 && seconds <= MAX_TIMEOUT_S {
        return Ok(Duration::from_secs_f64(seconds));
    }
    let expected = format!("seconds above 0 and up to {MAX_TIMEOUT_S}");
    Err(InputError::expected("--timeout-s", expected, seconds))
}

/// Number of ticks by their cost in instructions.
#[derive(Default)]
struct Costs(BTreeMap<u32, u64>);

impl Costs {
    fn add(&mut self, cost: Option<u32>) {
        if let Some(cost) = cost {
            *self.0.entry(cost).or_default() += 1;
        }
    }

    /// The smallest cost that more than half of the ticks do not exceed.
    fn median(&self) -> Option<u32> {
        let ticks: u64 = self.0.values().sum();
        let mut ticks_so_far = 0;
        let reaches_half = |(cost, count): (&u32, &u64)| {
            ticks_so_far += count;
            (2 * ticks_so_far > ticks).then_some(*cost)
        };
        self.0.iter().find_map(reaches_half)
    }

    /// A paragraph; empty if no cost was counted.
    fn summary(&self) -> String {
        let (Some(median), Some((max, _))) = (self.median(), self.0.last_key_value()) else {
            return String::new();
        };
        let ticks: u64 = self.0.values().sum();
        format!("\n\n{ticks} ticks: {median} instructions in the median, {max} at most.")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_reached_by_more_than_half_of_the_ticks() {
        let mut costs = Costs::default();
        assert_eq!(costs.summary(), "");
        for cost in [300, 100, 200, 200] {
            costs.add(Some(cost));
        }
        assert_eq!(costs.summary(), "\n\n4 ticks: 200 instructions in the median, 300 at most.");
    }
}
