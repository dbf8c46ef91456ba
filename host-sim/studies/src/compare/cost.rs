//! Instructions of a tick on the chip, counted by the emulated core.

use std::path::Path;

use super::error::CompareError;
use super::motion::Motion;
use super::pipeline::run;
use lockstep::emulator::{DEFAULT_TIMEOUT, Emulator};
use lockstep::remote::Remote;
use model::machine::Machine;
use plant::controller::ControllerError;
use plant::simulate;
use shared::scalar::Format;

/// The part of a motion that runs on the core, s of machine time: the first dwell and the beginning of the first
/// block.
const MEASURED_S: f64 = 0.4;

/// Instructions of a tick with position loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Median of the ticks.
    pub median: u32,
    /// Maximum of the ticks.
    pub max: u32,
}

/// The cost of a motion in a number format; `None` if the core does not count instructions.
///
/// # Errors
/// When the emulator does not start, the link breaks, or the drives are switched off.
pub fn measure(
    program: &Path,
    machine: &Machine,
    motion: Motion,
    turns: u32,
    format: Format,
) -> Result<Option<Cost>, CompareError> {
    let (settings, start) = simulate::controller_setup(machine, &motion.start_m())?;
    let rates = machine.rates();
    let link = Emulator::start(program, DEFAULT_TIMEOUT).map_err(ControllerError::Link)?;
    let mut board = Remote::set_up(link, format, rates, &settings, &start)?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "thousands of ticks")]
    let max_ticks = (MEASURED_S * rates.velocity_loop_hz) as usize;
    let ticks = run(&mut board, machine, motion, turns, max_ticks)?;
    let mut costs: Vec<u32> = ticks.iter().filter_map(|tick| tick.cost).collect();
    costs.sort_unstable();
    let (median, max) = (costs.get(costs.len() / 2), costs.last());
    Ok(median.zip(max).map(|(&median, &max)| Cost { median, max }))
}
