//! A controller and a machine, tick by tick.

use std::io;

use shared::axis::Reading;
use shared::interpolate::PathError;
use shared::machine::MachineError;
use shared::safety::{Fault, FaultKind, Power};
use shared::units::Position;

use super::error::{self, MAX_RUN_S, SimulationError};
use super::sample::Sample;
use crate::controller::{AxisOutput, Controller, ControllerError, Status};
use crate::delay::CommandDelay;
use crate::machine_sim::{MachineSim, Measurement};
use crate::parameters::AxisParameters;
use files::log::{AxisLog, Log};
use model::effects::Channel;
use model::machine::{Axis, Machine};
use motion::PathBlock;

/// A machine that a controller can move.
pub trait Plant {
    /// Reads motor encoder and linear scale of each axis. It is called once a tick.
    fn read(&mut self, readings: &mut [Reading]);

    /// The logged channels that the controller does not know, one value per axis: from its readings of this tick, the forces
    /// of the next tick (N) and the time of the session (s). It is called once per sample.
    fn measure(
        &mut self,
        readings: &[Reading],
        next_n: impl Iterator<Item = f64>,
        time_s: f64,
    ) -> Vec<Measurement>;

    /// Moves the machine over one tick under the commanded forces, N.
    fn step(&mut self, forces_n: impl Iterator<Item = f64>);
}

impl Plant for MachineSim {
    fn read(&mut self, readings: &mut [Reading]) {
        MachineSim::read(self, readings);
    }

    fn measure(
        &mut self,
        readings: &[Reading],
        next_n: impl Iterator<Item = f64>,
        time_s: f64,
    ) -> Vec<Measurement> {
        MachineSim::measure(self, readings, next_n, time_s)
    }

    fn step(&mut self, forces_n: impl Iterator<Item = f64>) {
        MachineSim::step(self, forces_n);
    }
}

/// A path that a controller executes.
#[derive(Clone, Copy, Debug)]
pub struct ClosedLoop<'a> {
    /// The machine: its rates, and the names of its axes.
    pub machine: &'a Machine,
    /// The path.
    pub blocks: &'a [PathBlock],
    /// Time of the session at the start, s: the first time of the log.
    pub start_s: f64,
}

impl ClosedLoop<'_> {
    /// Moves a plant with a controller until the path is done, without keeping anything in memory.
    ///
    /// `on_tick` is called after every tick with the time since the start (s) and the controller's outputs, `on_sample`
    /// with each row of the log, at the sample rate: one [`Sample`] per axis.
    ///
    /// # Errors
    /// When the controller refuses a block, the link breaks, the drives are switched off, `on_sample` fails,
    /// or the path does not end within [`MAX_RUN_S`].
    pub fn rows(
        &self,
        plant: &mut impl Plant,
        controller: &mut dyn Controller,
        mut on_tick: impl FnMut(f64, &Status, &[AxisOutput]),
        mut on_sample: impl FnMut(&[Sample]) -> io::Result<()>,
    ) -> Result<(), SimulationError> {
        let rates = self.machine.rates();
        let (tick_s, divider) = (1.0 / rates.velocity_loop_hz, u64::from(rates.position_loop_divider));
        let axes = self.machine.axis.len();
        let mut waiting = self.blocks.iter().enumerate().peekable();
        let mut readings = vec![Reading { motor: Position(0), table: None }; axes];
        let mut outputs = vec![AxisOutput::default(); axes];
        let mut samples = Vec::with_capacity(axes);
        let mut commands = self.command_delays();
        controller.enable()?;
        for tick in 0u64.. {
            let time_s = tick as f64 * tick_s;
            push_blocks(controller, &mut waiting)?;
            plant.read(&mut readings);
            let status = controller.tick(&readings, &mut outputs)?;
            on_tick(time_s, &status, &outputs);
            self.check(&status, time_s)?;
            if tick.is_multiple_of(divider) {
                let forces_n = outputs.iter().map(|output| output.force_n);
                let measured = plant.measure(&readings, forces_n, self.start_s + time_s);
                let logged_m = commands
                    .iter_mut()
                    .zip(&outputs)
                    .map(|(log, output)| log.logged_m(output.command.to_m()));
                let rows = readings.iter().zip(logged_m).zip(&measured);
                samples.clear();
                samples.extend(
                    rows.map(|((reading, command_m), measured)| Sample::new(reading, command_m, measured)),
                );
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
            plant.step(outputs.iter().map(|output| output.force_n));
        }
        Ok(())
    }

    /// The latencies of the logged commands.
    fn command_delays(&self) -> Vec<CommandDelay> {
        let latency_s = |axis: &Axis| AxisParameters::of(axis).latency_s(Channel::Command);
        let sample_s = 1.0 / self.machine.sample_rate_hz;
        self.machine.axis.values().map(|axis| CommandDelay::new(latency_s(axis), sample_s)).collect()
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

    /// [`Self::rows`] into a log in memory.
    ///
    /// # Errors
    /// As [`Self::rows`].
    pub fn log(
        &self,
        plant: &mut impl Plant,
        controller: &mut dyn Controller,
        on_tick: impl FnMut(f64, &Status, &[AxisOutput]),
    ) -> Result<Log, SimulationError> {
        let mut log = self.empty_log();
        self.rows(plant, controller, on_tick, |samples| {
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
        let axis = |(name, axis): (&String, &Axis)| {
            let mut axis = AxisLog::new(name, axis.settings.names.log_unit());
            for channel in Sample::CHANNELS {
                *axis.channel_mut(channel) = Some(Vec::new());
            }
            axis
        };
        Log::new(
            "simulation",
            self.start_s,
            1.0 / self.machine.sample_rate_hz,
            self.machine.axis.iter().map(axis),
        )
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
