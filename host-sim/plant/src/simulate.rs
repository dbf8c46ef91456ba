//! The closed loop: a controller, the machine on the desk, and the log of what happened.

mod stopped;

use std::io;

use shared::axis::Reading;
use shared::interpolate::PathError;
use shared::machine::MachineError;
use shared::safety::{Fault, FaultKind, Power};
use shared::units::Position;

pub use stopped::SimulationError;

use crate::desk::{Desk, Row};
use crate::instruments::Instruments;
use crate::parameters::AxisParameters;
use files::log::{AxisLog, Channel, Log, Unit};
use link::controller::{AxisOutput, Controller, ControllerError, Format, PathBlock, Status};
use model::machine::Machine;
use model::servo;

/// The longest run, s of machine time: a path that never ends is stopped there.
pub const LONGEST_S: f64 = 3600.0;

/// Most plant steps a tick: a stiffer machine is refused.
const MOST_SUBSTEPS: f64 = 500.0;

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
    Ok(link::controller::in_process(format, machine.rates(), &settings, &start)?)
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
    for ((name, axis), parameters) in machine.axis.iter().zip(AxisParameters::of_all(machine)) {
        let lacks = |key| SimulationError::Lacks { axis: name.clone(), key };
        if parameters.motor_mass_kg + parameters.table_mass_kg <= 0.0 {
            return Err(lacks("table_mass_kg"));
        }
        let (key, step_s) = parameters.fastest();
        if step_s * machine.velocity_rate_hz() * MOST_SUBSTEPS < 1.0 {
            return Err(SimulationError::TooFast { axis: name.clone(), key, step_s });
        }
        settings.push(servo::settings(&axis.settings, &parameters.servo).map_err(lacks)?);
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

/// What a row of the log holds of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// What was asked for.
    pub command_mm: f64,
    /// Reading of the motor.
    pub motor_mm: f64,
    /// Reading of the linear scale.
    pub table_mm: f64,
    /// Reading at the tool.
    pub tool_mm: f64,
    /// Force that was asked for over the last tick.
    pub force_n: f64,
}

impl Sample {
    /// What it holds, in the order of a log's columns.
    pub const CHANNELS: [Channel; 5] =
        [Channel::Command, Channel::Motor, Channel::Table, Channel::Tool, Channel::Force];

    /// The values of [`Sample::CHANNELS`].
    #[must_use]
    pub const fn values(&self) -> [f64; 5] {
        [self.command_mm, self.motor_mm, self.table_mm, self.tool_mm, self.force_n]
    }

    fn of(reading: &Reading, output: &AxisOutput, row: &Row) -> Self {
        Self {
            command_mm: 1e3 * output.command.to_m(),
            motor_mm: 1e3 * reading.motor.to_m(),
            table_mm: 1e3 * row.table_m,
            tool_mm: 1e3 * row.tool_m,
            force_n: row.force_n,
        }
    }
}

impl Run<'_> {
    /// Closes the loop with a controller until the path has been travelled; gives every row, at the sample rate, to
    /// `keep` and keeps none.
    ///
    /// `watch` is called with the time (s) and the controller's outputs after every tick.
    ///
    /// # Errors
    /// When the controller refuses, the link breaks, the drives go off, a row cannot be kept, or the path does not end.
    pub fn rows(
        &self,
        controller: &mut dyn Controller,
        mut watch: impl FnMut(f64, &Status, &[AxisOutput]),
        mut keep: impl FnMut(&[Sample]) -> io::Result<()>,
    ) -> Result<(), SimulationError> {
        let rates = self.machine.rates();
        let (tick_s, divider) = (1.0 / rates.velocity_loop_hz, u64::from(rates.position_loop_divider));
        let mut desk = Desk::new(self.machine, self.instruments, self.start_m)?;
        let mut waiting = self.blocks.iter().enumerate().peekable();
        let mut readings = vec![Reading { motor: Position(0), table: None }; self.start_m.len()];
        let mut outputs = vec![AxisOutput::default(); self.start_m.len()];
        let mut samples = Vec::with_capacity(self.start_m.len());
        controller.enable()?;
        for tick in 0u64.. {
            let time_s = tick as f64 * tick_s;
            feed(controller, &mut waiting)?;
            desk.read(&mut readings);
            let status = controller.tick(&readings, &mut outputs)?;
            watch(time_s, &status, &outputs);
            if let Power::Faulted(fault) = status.power {
                return Err(stopped::fault(self.machine, fault, time_s));
            }
            // The controller holds where it is: nothing of the motion would be travelled.
            if let Some(fault @ Fault::Axis { kind: FaultKind::Displaced, .. }) = status.warning {
                return Err(stopped::fault(self.machine, fault, time_s));
            }
            if tick.is_multiple_of(divider) {
                let rows =
                    desk.row(&readings, outputs.iter().map(|output| output.force_n), self.start_s + time_s);
                let axes = readings.iter().zip(&outputs).zip(&rows);
                samples.clear();
                samples.extend(axes.map(|((reading, output), row)| Sample::of(reading, output, row)));
                if !samples.iter().flat_map(Sample::values).all(f64::is_finite) {
                    return Err(stopped::not_finite(time_s));
                }
                keep(&samples)?;
                if status.done && waiting.peek().is_none() {
                    break;
                }
            }
            if time_s > LONGEST_S {
                return Err(SimulationError::Endless);
            }
            desk.step(outputs.iter().map(|output| output.force_n));
        }
        Ok(())
    }

    /// The same, into a log in memory.
    ///
    /// # Errors
    /// As [`Run::rows`].
    pub fn log(
        &self,
        controller: &mut dyn Controller,
        watch: impl FnMut(f64, &Status, &[AxisOutput]),
    ) -> Result<Log, SimulationError> {
        let mut log = self.empty_log();
        self.rows(controller, watch, |samples| {
            for (axis, sample) in log.axes.iter_mut().zip(samples) {
                for (channel, value) in Sample::CHANNELS.into_iter().zip(sample.values()) {
                    axis.channel_mut(channel).get_or_insert_default().push(value);
                }
            }
            Ok(())
        })?;
        Ok(log)
    }

    /// The log before its first row: names, clock and channels.
    #[must_use]
    pub fn empty_log(&self) -> Log {
        let axis = |name: &String| {
            let mut axis = AxisLog::new(name, Unit::Millimetre);
            for channel in Sample::CHANNELS {
                *axis.channel_mut(channel) = Some(Vec::new());
            }
            axis
        };
        Log {
            source: "simulation".to_owned(),
            start_s: self.start_s,
            sample_time_s: 1.0 / self.machine.sample_rate_hz,
            axes: self.machine.axis.keys().map(axis).collect(),
        }
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
