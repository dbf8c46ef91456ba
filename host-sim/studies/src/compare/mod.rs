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
pub mod page;
pub mod pipeline;
pub mod single;

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::Serialize;
use shared::interpolate::PathError;
use shared::machine::MachineError;
use shared::safety::Fault;

use cost::Cost;
use errors::Spread;
use exact::{apart_nm, length};
use files::error::InputError;
use link::controller::{ControllerError, Format};
use long_run::Travelled;
use model::machine::Machine;
use motion::Motion;
use pipeline::{Pipeline, Tick};
use plant::simulate::SimulationError;

/// Axes of all motions.
pub const AXES: usize = 2;

/// The machine that runs them.
pub const MACHINE: &str = include_str!("machine.toml");

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
    let machine = Machine::parse(MACHINE, "compare/machine.toml")?;
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
            numerics::max_abs(apart)
        };
        let pieces = run.chunks(piece).zip(double.chunks(piece)).map(most);
        pieces.enumerate().map(|(i, nm)| ((i * piece) as f64 / self.rate_hz, nm)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 36 s of circles in place of a day.
    fn short() -> Comparison {
        run(&Options { hours: 0.01, emulator: None }, &|_| ()).unwrap()
    }

    fn row<'a>(comparison: &'a Comparison, motion: &str, scalar: &str) -> &'a Row {
        comparison.rows.iter().find(|row| row.motion == motion && row.scalar == scalar).unwrap()
    }

    /// Both axes slide, creep and stick: without that the aim would mean nothing.
    #[test]
    fn the_machine_has_friction() {
        let machine = Machine::parse(MACHINE, "machine.toml").unwrap();
        assert_eq!(machine.axis.len(), AXES);
        for axis in machine.axis.values() {
            assert!(axis.coulomb_n > Some(100.0) && axis.presliding_stiffness_n_per_um > Some(10.0));
            assert!(axis.effect.iter().any(|effect| effect.name() == "stribeck"));
        }
    }

    #[test]
    fn the_aims_are_met_and_what_f32_positions_lose_is_seen() {
        let comparison = short();
        assert_eq!(comparison.rows.len(), 20);
        for motion in Motion::ALL.map(Motion::name) {
            let [fixed, f32, f64, single] =
                Pipeline::ALL.map(|pipeline| row(&comparison, motion, pipeline.name()));
            // The aim, and not nothing: fixed point rounds.
            assert!(fixed.position_error_nm.max < 5.0 && fixed.position_error_nm.rms < 1.0, "{fixed:?}");
            assert!(fixed.position_error_nm.max > 1e-4 && f32.position_error_nm.max > 1e-4);
            assert!(f64.position_error_nm.max == 0.0);
            // One integer path for all three, within 0.5 nm of the exact one.
            assert!(
                fixed.command_error_nm == f64.command_error_nm
                    && f32.command_error_nm == f64.command_error_nm
            );
            assert!(f64.command_error_nm.max < 0.5);
            // An encoder that resolves 4 to 119 nm moves the table by more than anything that laws round.
            assert!(single.position_error_nm.rms > 20.0 * fixed.position_error_nm.rms, "{single:?}");
            for row in [fixed, f32, f64, single] {
                assert_eq!(row.drift_nm.is_some(), motion == "long_run");
                assert_eq!(row.instructions_per_tick, None);
            }
        }
        // Rounding moves the mean of 50,000 ticks far less than a tick: no drift.
        for scalar in ["fixed", "f32", "f64"] {
            assert!(row(&comparison, "long_run", scalar).drift_nm.unwrap() < 0.01);
        }
        assert!(comparison.travelled.end_nm == 0.0);
    }

    /// Above 1 m an f32 has neighbours 2⁻²³ m = 119.2 nm apart. A command that goes evenly through them is
    /// off by up to half of that, 119.2/√12 = 34.4 nm rms; the sum with a start that was rounded too is off by
    /// up to twice as much.
    #[test]
    fn f32_positions_lose_at_1_m_what_their_spacing_says() {
        let comparison = short();
        let spacing = 1e9 * f64::from(f32::EPSILON);
        for motion in ["steps", "creep"] {
            let Spread { max, rms } = row(&comparison, motion, "f32_position").command_error_nm;
            assert!((0.45 * spacing..1.01 * spacing).contains(&max), "{motion}: {max}");
            let even = spacing / 12f64.sqrt();
            assert!((0.8 * even..1.45 * even).contains(&rms), "{motion}: {rms}");
        }
    }
}
