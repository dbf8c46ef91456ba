//! What a tick costs on the chip: instructions, counted by the emulated core.

use std::path::Path;

use super::CompareError;
use super::motion::Motion;
use super::pipeline::run;
use link::controller::{ControllerError, Format};
use link::emulator::{DEFAULT_TIMEOUT, Emulator};
use link::remote::Remote;
use model::machine::Machine;
use model::servo;
use plant::simulate;

/// How much of a motion runs on the core, s of machine time: out of the first dwell and well into the
/// first block.
const MEASURED_S: f64 = 0.4;

/// Instructions of the ticks in which path and position loops run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Median.
    pub median: u32,
    /// Greatest.
    pub most: u32,
}

/// The cost of a motion in a number format.
///
/// # Errors
/// When the emulator does not start, the link breaks, or the loop does not hold.
pub fn measure(
    program: &Path,
    machine: &Machine,
    motion: Motion,
    turns: u32,
    format: Format,
) -> Result<Option<Cost>, CompareError> {
    let (settings, start) = simulate::set_up(machine, &motion.start_m())?;
    let rates = servo::rates(machine);
    let link = Emulator::start(program, DEFAULT_TIMEOUT).map_err(ControllerError::Link)?;
    let mut board = Remote::set_up(link, format, rates, &settings, &start)?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "thousands of ticks")]
    let most_ticks = (MEASURED_S * rates.velocity_loop_hz) as usize;
    let ticks = run(&mut board, machine, motion, turns, most_ticks)?;
    let mut costs: Vec<u32> = ticks.iter().filter_map(|tick| tick.cost).collect();
    costs.sort_unstable();
    let (median, most) = (costs.get(costs.len() / 2), costs.last());
    Ok(median.zip(most).map(|(&median, &most)| Cost { median, most }))
}
