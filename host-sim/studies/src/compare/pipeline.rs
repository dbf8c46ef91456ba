//! The four pipelines, and the loop that is closed with each of them.

use shared::axis::Reading;
use shared::safety::Power;
use shared::units::Position;

use super::exact::Point;
use super::motion::Motion;
use super::single::Single;
use super::{AXES, CompareError};
use link::controller::{AxisOutput, Controller, Format, Status, in_process};
use model::machine::Machine;
use model::servo;
use plant::instruments::Instruments;
use plant::machine_sim::MachineSim;
use plant::simulate;
use plant::simulate::SimulationError;

/// Current loop of the drives, s. Sensors are exact to the unit of a position, so that what differs
/// between two runs is the arithmetic of the controller and nothing else.
const INSTRUMENTS_DRIVE_S: f64 = 1e-4;

/// A controller in some arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pipeline {
    /// `shared` in a number format.
    Of(Format),
    /// Laws in f32, and positions in f32 metres.
    F32Position,
}

impl Pipeline {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::Of(Format::Fixed), Self::Of(Format::F32), Self::Of(Format::F64), Self::F32Position];

    /// Name in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Of(Format::Fixed) => "fixed",
            Self::Of(Format::F32) => "f32",
            Self::Of(Format::F64) => "f64",
            Self::F32Position => "f32_position",
        }
    }

    /// The controller, standing at the start of a motion.
    ///
    /// # Errors
    /// When the machine's settings are refused.
    pub fn controller(self, machine: &Machine, motion: Motion) -> Result<Box<dyn Controller>, CompareError> {
        let (settings, start) = simulate::controller_setup(machine, &motion.start_m())?;
        let rates = servo::rates(machine);
        Ok(match self {
            Self::Of(format) => in_process(format, rates, &settings, &start)?,
            Self::F32Position => Box::new(Single::new(rates, &settings, start_of(motion))?),
        })
    }
}

/// Where a motion starts.
#[must_use]
pub fn start_of(motion: Motion) -> Point {
    motion.start_m().map(|m| Position::from_m(m).unwrap_or_default())
}

/// What stood at one tick of the path and position loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Number of the block that the command belongs to.
    pub block: usize,
    /// Command.
    pub command: Point,
    /// Linear scales: the tables as they are.
    pub table: Point,
    /// Cost of the tick, where it is counted.
    pub cost: Option<u32>,
}

/// Closes the loop of a controller over a motion, and gives every tick of path and position loops.
///
/// A block is handed over when the one before has ended, to every controller at the same tick. A run may be cut
/// short after a number of velocity ticks.
///
/// # Errors
/// When a block is refused, the link breaks or the drives go off.
pub fn run(
    controller: &mut dyn Controller,
    machine: &Machine,
    motion: Motion,
    turns: u32,
    most_ticks: usize,
) -> Result<Vec<Tick>, CompareError> {
    let divider = servo::rates(machine).position_loop_divider as usize;
    let instruments = Instruments { drive_time_constant_s: INSTRUMENTS_DRIVE_S, ..Instruments::default() };
    let mut machine_sim =
        MachineSim::new(machine, instruments, &motion.start_m()).map_err(SimulationError::from)?;
    let blocks = motion.blocks(turns);
    let mut ticks = Vec::new();
    let mut readings = [Reading { motor: Position(0), table: None }; AXES];
    let mut outputs = [AxisOutput::default(); AXES];
    let (mut handed, mut done) = (0, true);
    controller.enable()?;
    for tick in 0..most_ticks {
        if done {
            let Some(block) = blocks.get(handed) else { break };
            controller.push(block)?;
            handed += 1;
        }
        machine_sim.read(&mut readings);
        let status: Status = controller.tick(&readings, &mut outputs)?;
        done = status.done;
        if let Power::Faulted(fault) = status.power {
            return Err(CompareError::Fault { motion: motion.name(), fault });
        }
        if tick.is_multiple_of(divider) {
            ticks.push(Tick {
                block: handed - 1,
                command: outputs.map(|output| output.command),
                table: readings.map(|reading| reading.table.unwrap_or(reading.motor)),
                cost: status.cost,
            });
        }
        machine_sim.step(outputs.iter().map(|output| output.force_n));
    }
    Ok(ticks)
}
