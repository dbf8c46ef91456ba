//! The closed loop: a controller, the simulated machine, and the log of a run.
//!
//! [`controller_setup`] makes the settings of a controller from a machine file, [`controller`] a controller in this
//! process; a [`Run`] closes the loop of any [`Controller`] with a [`MachineSim`] over a path.

mod error;
mod sample;
mod setup;

use std::io;

use shared::axis::Reading;
use shared::interpolate::PathError;
use shared::machine::MachineError;
use shared::safety::{Fault, FaultKind, Power};
use shared::units::Position;

pub use error::{MAX_RUN_S, SimulationError};
pub use sample::Sample;
pub use setup::{controller, controller_setup};

use crate::instruments::Instruments;
use crate::machine_sim::MachineSim;
use files::log::{AxisLog, Log, Unit};
use link::controller::{AxisOutput, Controller, ControllerError, PathBlock, Status};
use model::machine::Machine;

/// A run of a machine along a path.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The machine with its effects.
    pub machine: &'a Machine,
    /// Sensors and drives.
    pub instruments: Instruments,
    /// Start of the axes, m.
    pub start_m: &'a [f64],
    /// The path.
    pub blocks: &'a [PathBlock],
    /// Time of the session at the start, s: the first time of the log.
    pub start_s: f64,
}

impl Run<'_> {
    /// Closes the loop with a controller until the path is done, without keeping anything in memory.
    ///
    /// `on_tick` is called after every tick with the time since the start (s) and the controller's outputs, `on_sample`
    /// with each row of the log, at the sample rate: one [`Sample`] per axis.
    ///
    /// # Errors
    /// When the controller refuses a block, the link breaks, the drives are switched off, `on_sample` fails,
    /// or the path does not end within [`MAX_RUN_S`].
    pub fn rows(
        &self,
        controller: &mut dyn Controller,
        mut on_tick: impl FnMut(f64, &Status, &[AxisOutput]),
        mut on_sample: impl FnMut(&[Sample]) -> io::Result<()>,
    ) -> Result<(), SimulationError> {
        let rates = self.machine.rates();
        let (tick_s, divider) = (1.0 / rates.velocity_loop_hz, u64::from(rates.position_loop_divider));
        let machine_sim = MachineSim::new(self.machine, self.instruments, self.start_m)?;
        let mut machine_sim = machine_sim.starting_at(self.start_s);
        let mut waiting = self.blocks.iter().enumerate().peekable();
        let mut readings = vec![Reading { motor: Position(0), table: None }; self.start_m.len()];
        let mut outputs = vec![AxisOutput::default(); self.start_m.len()];
        let mut samples = Vec::with_capacity(self.start_m.len());
        controller.enable()?;
        for tick in 0u64.. {
            let time_s = tick as f64 * tick_s;
            push_blocks(controller, &mut waiting)?;
            machine_sim.read(&mut readings);
            let status = controller.tick(&readings, &mut outputs)?;
            on_tick(time_s, &status, &outputs);
            self.check(&status, time_s)?;
            if tick.is_multiple_of(divider) {
                let forces_n = outputs.iter().map(|output| output.force_n);
                let measured = machine_sim.measure(&readings, forces_n, self.start_s + time_s);
                let axes = readings.iter().zip(&outputs).zip(&measured);
                samples.clear();
                samples
                    .extend(axes.map(|((reading, output), measured)| Sample::new(reading, output, measured)));
                if !samples.iter().flat_map(Sample::values).all(f64::is_finite) {
                    return Err(error::not_finite(time_s));
                }
                on_sample(&samples)?;
                if status.done && waiting.peek().is_none() {
                    break;
                }
            }
            if time_s > MAX_RUN_S {
                return Err(SimulationError::Endless { limit_s: MAX_RUN_S });
            }
            machine_sim.step(outputs.iter().map(|output| output.force_n));
        }
        Ok(())
    }

    /// Whether the run may continue.
    fn check(&self, status: &Status, time_s: f64) -> Result<(), SimulationError> {
        if let Power::Faulted(fault) = status.power {
            return Err(error::fault(self.machine, fault, time_s));
        }
        // The controller holds the axis where it is and does not start the motion.
        if let Some(fault @ Fault::Axis { kind: FaultKind::Displaced, .. }) = status.warning {
            return Err(error::fault(self.machine, fault, time_s));
        }
        Ok(())
    }

    /// [`Run::rows`] into a log in memory.
    ///
    /// # Errors
    /// As [`Run::rows`].
    pub fn log(
        &self,
        controller: &mut dyn Controller,
        on_tick: impl FnMut(f64, &Status, &[AxisOutput]),
    ) -> Result<Log, SimulationError> {
        let mut log = self.empty_log();
        self.rows(controller, on_tick, |samples| {
            for (axis, sample) in log.axes.iter_mut().zip(samples) {
                for (channel, value) in Sample::CHANNELS.into_iter().zip(sample.values()) {
                    axis.channel_mut(channel).get_or_insert_default().push(value);
                }
            }
            Ok(())
        })?;
        Ok(log)
    }

    /// A log without rows: its names, sample time and channels.
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

/// Passes blocks to the controller until its queue is full.
fn push_blocks<'a>(
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
