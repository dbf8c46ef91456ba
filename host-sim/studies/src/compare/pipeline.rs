//! The pipelines that are compared, and the closed loop of each.

use shared::axis::Reading;
use shared::safety::Power;
use shared::units::Position;

use super::error::CompareError;
use super::motion::Motion;
use super::point::{AXES, Point};
use super::single_precision::SinglePrecision;
use model::machine::Machine;
use plant::controller::{AxisOutput, Controller, Status, in_process};
use plant::instruments::Instruments;
use plant::machine_sim::MachineSim;
use plant::simulate::{self, SimulationError};
use shared::scalar::Format;

/// Time constant of the drives' current loops, s. The sensors are exact to the unit of a position, so that two runs
/// differ only by the arithmetic of the controller.
const DRIVE_TIME_CONSTANT_S: f64 = 1e-4;

/// The arithmetic of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pipeline {
    /// `shared` in a number format.
    Of(Format),
    /// Control laws in f32 and positions in f32 metres, see [`SinglePrecision`].
    F32Position,
}

impl Pipeline {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::Of(Format::Fixed), Self::Of(Format::F32), Self::Of(Format::F64), Self::F32Position];

    /// Name in the results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Of(Format::Fixed) => "fixed",
            Self::Of(Format::F32) => "f32",
            Self::Of(Format::F64) => "f64",
            Self::F32Position => "f32_position",
        }
    }

    /// The controller of a machine at rest at the start of a motion.
    ///
    /// # Errors
    /// When the machine's settings are refused.
    pub fn controller(self, machine: &Machine, motion: Motion) -> Result<Box<dyn Controller>, CompareError> {
        let (settings, start) = simulate::controller_setup(machine, &motion.start_m())?;
        let rates = machine.rates();
        Ok(match self {
            Self::Of(format) => in_process(format, rates, &settings, &start)?,
            Self::F32Position => Box::new(SinglePrecision::new(rates, &settings, motion.start())?),
        })
    }
}

/// State of a run at one tick of the path and position loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Number of the block that the command belongs to.
    pub block: usize,
    /// Position commands.
    pub command: Point,
    /// True positions of the tables: readings of the linear scales without error.
    pub table: Point,
    /// Instructions of the tick, where they are counted.
    pub cost: Option<u32>,
}

/// Closes the loop of a controller over a motion and gives every tick of the path and position loops, of the first
/// `max_ticks` velocity ticks.
///
/// A block is passed on when the previous one has ended, so that every controller receives it at the same tick.
///
/// # Errors
/// When a block is refused, the link breaks or the drives are switched off.
pub fn run(
    controller: &mut dyn Controller,
    machine: &Machine,
    motion: Motion,
    turns: u32,
    max_ticks: usize,
) -> Result<Vec<Tick>, CompareError> {
    let divider = machine.rates().position_loop_divider as usize;
    let instruments = Instruments { drive_time_constant_s: DRIVE_TIME_CONSTANT_S, ..Instruments::default() };
    let mut machine_sim =
        MachineSim::new(machine, instruments, &motion.start_m()).map_err(SimulationError::from)?;
    let blocks = motion.blocks(turns);
    let mut ticks = Vec::new();
    let mut readings = [Reading { motor: Position(0), table: None }; AXES];
    let mut outputs = [AxisOutput::default(); AXES];
    let (mut pushed, mut done) = (0, true);
    controller.enable()?;
    for tick in 0..max_ticks {
        if done {
            let Some(block) = blocks.get(pushed) else { break };
            controller.push(block)?;
            pushed += 1;
        }
        machine_sim.read(&mut readings);
        let status: Status = controller.tick(&readings, &mut outputs)?;
        done = status.done;
        if let Power::Faulted(fault) = status.power {
            return Err(CompareError::Fault { motion: motion.name(), fault });
        }
        if tick.is_multiple_of(divider) {
            ticks.push(Tick {
                block: pushed - 1,
                command: outputs.map(|output| output.command),
                table: readings.map(|reading| reading.table.unwrap_or(reading.motor)),
                cost: status.cost,
            });
        }
        machine_sim.step(outputs.iter().map(|output| output.force_n));
    }
    Ok(ticks)
}
