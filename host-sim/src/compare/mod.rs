//! Fixed point against floating point: the same motions through four pipelines, and what each loses.
//!
//! [`motion`] says what is run, [`pipeline`] closes the loop, [`single`] is the pipeline with f32 positions,
//! [`exact`] knows where commands should be, [`errors`] measures, [`long_run`] travels a day of path, [`cost`]
//! counts instructions on the emulated core.

pub mod cost;
pub mod errors;
pub mod exact;
pub mod long_run;
pub mod motion;
pub mod pipeline;
pub mod single;

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::Serialize;
use shared::interpolate::PathError;
use shared::machine::MachineError;
use shared::safety::Fault;

use crate::controller::{ControllerError, Format};
use crate::error::InputError;
use crate::machine::Machine;
use crate::simulate::SimulationError;
use cost::Cost;
use errors::Spread;
use exact::{apart_nm, length};
use long_run::Travelled;
use motion::Motion;
use pipeline::{Pipeline, Tick};

/// Axes of all motions.
pub const AXES: usize = 2;

/// The machine that runs them.
pub const MACHINE: &str = include_str!("../../machines/compare.toml");

/// Turns at either end of the long run that the loop is closed on: two minutes.
const CLOSED_TURNS: u32 = 32;

/// Points of a curve of errors.
const CURVE: usize = 400;

/// What to compare.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Length of the long run, h.
    pub hours: f64,
    /// Program of the emulated core; without one no instructions are counted.
    pub emulator: Option<PathBuf>,
}

/// Why a comparison could not be made.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// The built-in machine file is refused.
    #[error(transparent)]
    Machine(#[from] InputError),
    /// The machine lacks what a simulation needs.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A controller refused the motion, or the link broke.
    #[error(transparent)]
    Controller(#[from] ControllerError),
    /// The drives went off.
    #[error("{motion}: the drives went off: {fault:?}")]
    Fault {
        /// Motion.
        motion: &'static str,
        /// What the controller saw.
        fault: Fault,
    },
}

impl From<PathError> for CompareError {
    fn from(error: PathError) -> Self {
        Self::Controller(MachineError::Path(error).into())
    }
}

/// One motion in one arithmetic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the motion.
    pub motion: &'static str,
    /// Name of the pipeline.
    pub scalar: &'static str,
    /// Command against where the exact path should be at that tick.
    pub command_error_nm: Spread,
    /// Table against the table of the run in double precision.
    pub position_error_nm: Spread,
    /// Of the long run: distance along the path of the last command from the programmed end, or of the mean
    /// table position at the end from that at the beginning, whichever is more.
    pub drift_nm: Option<f64>,
    /// Median of the ticks with path and position loops, on the emulated core.
    pub instructions_per_tick: Option<u32>,
    /// Greatest table error of each piece of the motion, time in s and nm.
    #[serde(skip)]
    pub curve: Vec<(f64, f64)>,
    /// Most instructions of a tick.
    #[serde(skip)]
    pub most_instructions: Option<u32>,
}

/// All of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// By motion, then by pipeline.
    pub rows: Vec<Row>,
    /// Turns of the long run.
    #[serde(skip)]
    pub turns: u32,
    /// Hours of it.
    #[serde(skip)]
    pub hours: f64,
    /// The long run's path.
    #[serde(skip)]
    pub travelled: Travelled,
    /// Why no instructions were counted.
    #[serde(skip)]
    pub not_counted: Option<String>,
}

impl Comparison {
    /// The rows of a pipeline.
    pub fn of(&self, pipeline: Pipeline) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.scalar == pipeline.name())
    }
}

/// Runs everything, on all cores; `say` is told how far it has come.
///
/// # Errors
/// The [`CompareError`] of the first part that fails.
pub fn run(options: &Options, say: &(dyn Fn(&str) + Sync)) -> Result<Comparison, CompareError> {
    let machine = Machine::parse(MACHINE, "machines/compare.toml")?;
    let turns = motion::turns_in(options.hours);
    let closed = CLOSED_TURNS.min(turns / 2);
    let formats: &[Format] =
        if options.emulator.is_some() { &[Format::Fixed, Format::F32, Format::F64] } else { &[] };
    let (left, all) = (AtomicUsize::new(0), Motion::ALL.len() * (Pipeline::ALL.len() + formats.len()) + 1);
    let done = |what: &str| {
        let count = left.fetch_add(1, Ordering::Relaxed) + 1;
        say(&format!("{count} of {all} runs done, the last: {what}"));
    };

    let loops = || {
        every(&Pipeline::ALL)
            .map(|(motion, pipeline)| {
                let mut controller = pipeline.controller(&machine, motion)?;
                let ticks = pipeline::run(controller.as_mut(), &machine, motion, closed, usize::MAX)?;
                done(&format!("{} in {}", motion.name(), pipeline.name()));
                Ok(ticks)
            })
            .collect::<Result<Vec<_>, CompareError>>()
    };
    let costs = || {
        every(formats)
            .map(|(motion, format)| {
                let program = options.emulator.as_deref().unwrap_or_else(|| "".as_ref());
                let cost = cost::measure(program, &machine, motion, closed, format)?;
                done(&format!("{} on the emulated core", motion.name()));
                Ok(cost)
            })
            .collect::<Result<Vec<_>, CompareError>>()
    };
    let rate_hz = machine.sample_rate_hz;
    let way = || long_run::travel(turns, rate_hz).inspect(|_| done("the path of the long run"));
    let (travelled, (loops, costs)) = rayon::join(way, || rayon::join(loops, costs));
    let (travelled, loops, costs) = (travelled?, loops?, costs?);

    let mut rows = Vec::new();
    for (index, motion) in Motion::ALL.into_iter().enumerate() {
        let runs = &loops[index * Pipeline::ALL.len()..][..Pipeline::ALL.len()];
        let cost = |format: usize| costs.get(index * formats.len() + format).copied().flatten();
        let of_motion = Measured { motion, closed, rate_hz, runs };
        rows.extend(of_motion.rows(cost, &travelled));
    }
    Ok(Comparison { rows, turns, hours: options.hours, travelled, not_counted: None })
}

/// Every motion with every one of something, in parallel and in this order.
fn every<T: Copy + Sync + Send>(others: &[T]) -> impl ParallelIterator<Item = (Motion, T)> {
    let pairs: Vec<_> =
        Motion::ALL.into_iter().flat_map(|motion| others.iter().map(move |&other| (motion, other))).collect();
    pairs.into_par_iter()
}

/// The runs of one motion, in the order of [`Pipeline::ALL`].
struct Measured<'a> {
    motion: Motion,
    closed: u32,
    rate_hz: f64,
    runs: &'a [Vec<Tick>],
}

impl Measured<'_> {
    fn rows(&self, cost: impl Fn(usize) -> Option<Cost>, travelled: &Travelled) -> Vec<Row> {
        let in_double = Pipeline::ALL.iter().position(|&p| p == Pipeline::Of(Format::F64));
        let double = in_double.map_or(&[][..], |index| &self.runs[index]);
        let off = errors::off_exact(self.motion, self.closed, double);
        let row = |(index, (pipeline, run)): (usize, (Pipeline, &Vec<Tick>))| {
            let is_single = pipeline == Pipeline::F32Position;
            let mut command = errors::command(run, double, &off);
            let mut drift_nm = None;
            if self.motion == Motion::LongRun {
                let (way, end_nm) = if is_single {
                    (travelled.singles, travelled.singles_end_nm)
                } else {
                    (travelled.integers, travelled.end_nm)
                };
                command = way;
                // The circles are the second and the fourth block.
                drift_nm = Some(end_nm.max(errors::mean_moved_nm(run, 1, 3)));
            }
            let cost = if is_single { None } else { cost(index) };
            Row {
                motion: self.motion.name(),
                scalar: pipeline.name(),
                command_error_nm: command,
                position_error_nm: errors::position(run, double),
                drift_nm,
                instructions_per_tick: cost.map(|cost| cost.median),
                curve: self.curve(run, double),
                most_instructions: cost.map(|cost| cost.most),
            }
        };
        Pipeline::ALL.into_iter().zip(self.runs).enumerate().map(row).collect()
    }

    /// Greatest table error of each of [`CURVE`] pieces.
    fn curve(&self, run: &[Tick], double: &[Tick]) -> Vec<(f64, f64)> {
        let piece = run.len().div_ceil(CURVE).max(1);
        let most = |(run, double): (&[Tick], &[Tick])| {
            let apart = run.iter().zip(double).map(|(r, d)| length(apart_nm(r.table, d.table)));
            apart.fold(0.0, f64::max)
        };
        let pieces = run.chunks(piece).zip(double.chunks(piece)).map(most);
        pieces.enumerate().map(|(i, nm)| ((i * piece) as f64 / self.rate_hz, nm)).collect()
    }
}
