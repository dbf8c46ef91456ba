//! The closed loop: a controller, the simulated machine, and the log of a run.
//!
//! [`controller_setup`] makes the settings of a controller from a machine file, [`controller`] a controller in this
//! process; a [`Run`] closes the loop of any [`Controller`] with a [`MachineSim`] over a path, [`ClosedLoop`] with any machine.

mod closed_loop;
mod error;
mod sample;
mod setup;

use std::io;

pub use closed_loop::{ClosedLoop, Plant};
pub use error::{MAX_RUN_S, SimulationError};
pub use sample::Sample;
pub use setup::{controller, controller_setup};

use crate::controller::{AxisOutput, Controller, Status};
use crate::instruments::Instruments;
use crate::machine_sim::MachineSim;
use files::log::Log;
use model::machine::Machine;
use motion::PathBlock;

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
        on_tick: impl FnMut(f64, &Status, &[AxisOutput]),
        on_sample: impl FnMut(&[Sample]) -> io::Result<()>,
    ) -> Result<(), SimulationError> {
        let mut plant = self.plant()?;
        self.closed_loop().rows(&mut plant, controller, on_tick, on_sample)
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
        let mut plant = self.plant()?;
        self.closed_loop().log(&mut plant, controller, on_tick)
    }

    /// A log without rows: its names, sample time and channels.
    #[must_use]
    pub fn empty_log(&self) -> Log {
        self.closed_loop().empty_log()
    }

    /// The machine at rest at the start.
    fn plant(&self) -> Result<MachineSim, SimulationError> {
        Ok(MachineSim::new(self.machine, self.instruments, self.start_m)?.starting_at(self.start_s))
    }

    const fn closed_loop(&self) -> ClosedLoop<'_> {
        ClosedLoop { machine: self.machine, blocks: self.blocks, start_s: self.start_s }
    }
}
