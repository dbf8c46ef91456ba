//! The closed loop: a controller, the machine on the desk, and the log of what happened.

use shared::axis::Reading;
use shared::interpolate::PathError;
use shared::machine::MachineError;
use shared::safety::{Fault, Hazard, Power};
use shared::units::Position;

use crate::controller::{AxisOutput, Controller, ControllerError, Format, PathBlock, Status};
use crate::log::{AxisLog, Log, Unit};
use crate::machine::Machine;
use crate::plant::desk::{Desk, Instruments, Row};
use crate::plant::parameters::AxisParameters;
use crate::servo;

/// The longest run, s of machine time: a path that never ends is stopped there.
pub const LONGEST_S: f64 = 3600.0;

/// Most plant steps a tick: a stiffer machine is refused.
const MOST_SUBSTEPS: f64 = 500.0;

/// Why a simulation stopped.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// The controller refused the machine or the motion, or the link broke.
    #[error(transparent)]
    Controller(#[from] ControllerError),
    /// A block of the path was refused.
    #[error("block {index}: {error}")]
    Block {
        /// Counted from 0.
        index: usize,
        /// What is wrong with it.
        error: PathError,
    },
    /// The machine file lacks what a simulation needs.
    #[error("axis.{axis}: a simulation needs the key {key}")]
    Lacks {
        /// Axis.
        axis: String,
        /// Key.
        key: &'static str,
    },
    /// The controller switched the drives off.
    #[error("{what} after {time_s:.4} s: is the loop unstable, or the motion too fast for it?")]
    Fault {
        /// Fault and axis.
        what: String,
        /// When.
        time_s: f64,
    },
    /// The path did not end.
    #[error("the motion did not end within {LONGEST_S} s of machine time")]
    Endless,
}

/// The in-process controller of a machine file that stands at `start_m`.
///
/// # Errors
/// When the file lacks a key or a setting is refused.
pub fn controller(
    machine: &Machine,
    format: Format,
    start_m: &[f64],
) -> Result<Box<dyn Controller>, SimulationError> {
    let (settings, start) = set_up(machine, start_m)?;
    Ok(crate::controller::in_process(format, servo::rates(machine), &settings, &start)?)
}

/// What a controller, here or on a board, is set up with.
///
/// # Errors
/// The key that the machine file lacks.
pub fn set_up(
    machine: &Machine,
    start_m: &[f64],
) -> Result<(Vec<shared::config::AxisSettings>, Vec<Position>), SimulationError> {
    let mut settings = Vec::new();
    for (name, axis) in &machine.axis {
        let lacks = |key| SimulationError::Lacks { axis: name.clone(), key };
        if !axis.has_mass() && machine.structure.is_none() {
            return Err(lacks("table_mass_kg"));
        }
        let parameters = AxisParameters::of(axis);
        let follows = parameters.step_s() * machine.velocity_rate_hz() * MOST_SUBSTEPS >= 1.0;
        if !follows && machine.structure.is_none() {
            return Err(lacks(
                "stiffness_n_per_um (or masses) that a step of a millionth of a second can follow",
            ));
        }
        settings.push(servo::settings(axis, &parameters.servo).map_err(lacks)?);
    }
    let start = start_m.iter().map(|&m| Position::from_m(m).unwrap_or_default()).collect();
    Ok((settings, start))
}

/// A run: what moves, how it is read, and when the session's clock stood where.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The machine with its effects.
    pub machine: &'a Machine,
    /// Sensors.
    pub instruments: Instruments,
    /// Where the axes stand, m.
    pub start_m: &'a [f64],
    /// The path.
    pub blocks: &'a [PathBlock],
    /// The log's first time, s.
    pub start_s: f64,
}

impl Run<'_> {
    /// Closes the loop with a controller until the path has been travelled; logs every channel at
    /// the sample rate.
    ///
    /// `watch` is called with the time (s) and the controller's outputs after every tick.
    ///
    /// # Errors
    /// When the controller refuses, the link breaks, the drives go off, or the path does not end.
    pub fn log(
        &self,
        controller: &mut dyn Controller,
        mut watch: impl FnMut(f64, &Status, &[AxisOutput]),
    ) -> Result<Log, SimulationError> {
        let rates = servo::rates(self.machine);
        let (tick_s, divider) = (1.0 / rates.velocity_loop_hz, u64::from(rates.position_loop_divider));
        let mut desk = Desk::new(self.machine, self.instruments, self.start_m);
        let mut log = self.empty_log();
        let mut waiting = self.blocks.iter().enumerate().peekable();
        let mut readings = vec![Reading { motor: Position(0), table: None }; self.start_m.len()];
        let mut outputs = vec![AxisOutput::default(); self.start_m.len()];
        controller.enable()?;
        for tick in 0u64.. {
            let time_s = tick as f64 * tick_s;
            feed(controller, &mut waiting)?;
            desk.read(&mut readings);
            let status = controller.tick(&readings, &mut outputs)?;
            watch(time_s, &status, &outputs);
            if let Power::Faulted(fault) = status.power {
                return Err(self.fault(fault, time_s));
            }
            if tick.is_multiple_of(divider) {
                let rows = desk.row(&readings, self.start_s + time_s);
                if rows.iter().any(|row| !(row.tool_m + row.table_m).is_finite()) {
                    return Err(SimulationError::Fault {
                        what: "a position is no finite number".to_owned(),
                        time_s,
                    });
                }
                append(&mut log, &readings, &outputs, &rows);
                if status.done && waiting.peek().is_none() {
                    break;
                }
            }
            if time_s > LONGEST_S {
                return Err(SimulationError::Endless);
            }
            desk.step(outputs.iter().map(|output| output.force_n));
        }
        Ok(log)
    }

    fn empty_log(&self) -> Log {
        let axis = |name: &String| AxisLog {
            name: name.clone(),
            unit: Unit::Millimetre,
            command: Some(Vec::new()),
            motor: Some(Vec::new()),
            table: Some(Vec::new()),
            tool: Some(Vec::new()),
            force: Some(Vec::new()),
            added_force: None,
        };
        Log {
            source: "simulation".to_owned(),
            start_s: self.start_s,
            sample_time_s: 1.0 / self.machine.sample_rate_hz,
            axes: self.machine.axis.keys().map(axis).collect(),
        }
    }

    fn fault(&self, fault: Fault, time_s: f64) -> SimulationError {
        let name = |axis: u8| self.machine.axis.get_index(usize::from(axis)).map_or("?", |(name, _)| name);
        let what = match fault {
            Fault::Axis { axis, hazard } => format!("axis.{}: {}", name(axis), said(hazard)),
            Fault::Overrun => "a tick took longer than its period".to_owned(),
        };
        SimulationError::Fault { what, time_s }
    }
}

fn said(hazard: Hazard) -> &'static str {
    match hazard {
        Hazard::FollowingError => "following error beyond its limit",
        Hazard::Disagreement => "motor and linear scale further apart than their limit",
        Hazard::EncoderStep => "the motor reading jumps further than the motor can",
        Hazard::ForceSaturated => {
            "the force stands at its limit: the motion asks for more than the drive can give"
        }
        Hazard::SoftLimit => "the command leaves the travel",
        Hazard::ScaleLost => "no reading of the linear scale",
    }
}

/// Hands over blocks while the controller has room for them.
fn feed<'a>(
    controller: &mut dyn Controller,
    waiting: &mut std::iter::Peekable<impl Iterator<Item = (usize, &'a PathBlock)>>,
) -> Result<(), SimulationError> {
    while let Some(&(index, block)) = waiting.peek() {
        match controller.push(block) {
            Ok(()) => drop(waiting.next()),
            Err(ControllerError::Refused(MachineError::Path(PathError::QueueFull))) => break,
            Err(ControllerError::Refused(MachineError::Path(error))) => {
                return Err(SimulationError::Block { index, error });
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}

/// One row of the log, in its units.
fn append(log: &mut Log, readings: &[Reading], outputs: &[AxisOutput], rows: &[Row]) {
    for (((axis, reading), output), row) in log.axes.iter_mut().zip(readings).zip(outputs).zip(rows) {
        let values = [
            (&mut axis.command, 1e3 * output.command.to_m()),
            (&mut axis.motor, 1e3 * reading.motor.to_m()),
            (&mut axis.table, 1e3 * row.table_m),
            (&mut axis.tool, 1e3 * row.tool_m),
            (&mut axis.force, row.force_n),
        ];
        for (channel, value) in values {
            channel.get_or_insert_default().push(value);
        }
    }
}
