//! Fixed point against floating point: the same motions through four pipelines, and the errors of each.
//!
//! [`motion`] defines the motions; [`pipeline`] closes the loop; [`single_precision`] is the pipeline with f32
//! positions and [`single_path`] its path; [`exact_path`] is the reference of the commands; [`errors`] computes the
//! errors; [`long_run`] runs the path for a day; [`cost`] counts instructions on the emulated core.

mod comparison;
pub mod cost;
mod error;
pub mod errors;
pub mod exact_path;
pub mod long_run;
pub mod motion;
pub mod page;
pub mod pipeline;
pub mod point;
pub mod single_path;
pub mod single_precision;

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

pub use comparison::{Comparison, Row};
pub use error::CompareError;

use cost::Cost;
use long_run::LongRunPath;
use model::machine::Machine;
use motion::Motion;
use pipeline::{Pipeline, Tick};
use point::{difference_nm, length};
use shared::scalar::Format;

/// The machine that runs the motions.
pub const MACHINE: &str = include_str!("machine.toml");

/// Turns at each end of the long run on which the loop is closed: two minutes.
const CLOSED_TURNS: u32 = 32;

/// Points of a curve of errors over time.
const CURVE_POINTS: usize = 400;

/// Options of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Length of the long run, h.
    pub hours: f64,
    /// Program of the emulated core; `None`: no instructions are counted.
    pub emulator: Option<PathBuf>,
}

/// Runs everything, on all cores; `progress` is called with a line of text after each run.
///
/// # Errors
/// The [`CompareError`] of the first part that fails.
pub fn run(options: &Options, progress: &(dyn Fn(&str) + Sync)) -> Result<Comparison, CompareError> {
    let machine = Machine::parse(MACHINE, "compare/machine.toml")?;
    let turns = motion::turns_in(options.hours);
    let closed = CLOSED_TURNS.min(turns / 2);
    let formats: &[Format] =
        if options.emulator.is_some() { &[Format::Fixed, Format::F32, Format::F64] } else { &[] };
    let (finished, all) =
        (AtomicUsize::new(0), Motion::ALL.len() * (Pipeline::ALL.len() + formats.len()) + 1);
    let done = |what: &str| {
        let count = finished.fetch_add(1, Ordering::Relaxed) + 1;
        progress(&format!("{count} of {all} runs done, last: {what}"));
    };

    let loops = || {
        each_motion(&Pipeline::ALL)
            .map(|(motion, pipeline)| {
                let mut controller = pipeline.controller(&machine, motion)?;
                let ticks = pipeline::run(controller.as_mut(), &machine, motion, closed, usize::MAX)?;
                done(&format!("{} in {}", motion.name(), pipeline.name()));
                Ok(ticks)
            })
            .collect::<Result<Vec<_>, CompareError>>()
    };
    let costs = || {
        each_motion(formats)
            .map(|(motion, format)| {
                let program = options.emulator.as_deref().unwrap_or_else(|| "".as_ref());
                let cost = cost::measure(program, &machine, motion, closed, format)?;
                done(&format!("{} on the emulated core", motion.name()));
                Ok(cost)
            })
            .collect::<Result<Vec<_>, CompareError>>()
    };
    let rate_hz = machine.sample_rate_hz;
    let path = || long_run::run(turns, rate_hz).inspect(|_| done("the path of the long run"));
    let (long_run, (loops, costs)) = rayon::join(path, || rayon::join(loops, costs));
    let (long_run, loops, costs) = (long_run?, loops?, costs?);

    let mut rows = Vec::new();
    for (index, motion) in Motion::ALL.into_iter().enumerate() {
        let runs = &loops[index * Pipeline::ALL.len()..][..Pipeline::ALL.len()];
        let cost = |format: usize| costs.get(index * formats.len() + format).copied().flatten();
        let runs = MotionRuns { motion, closed, rate_hz, runs };
        rows.extend(runs.rows(cost, &long_run));
    }
    Ok(Comparison { rows, turns, hours: options.hours, long_run, not_counted: None })
}

/// Every combination of a motion and another value, in parallel; results are in this order.
fn each_motion<T: Copy + Sync + Send>(others: &[T]) -> impl ParallelIterator<Item = (Motion, T)> {
    let pairs: Vec<_> =
        Motion::ALL.into_iter().flat_map(|motion| others.iter().map(move |&other| (motion, other))).collect();
    pairs.into_par_iter()
}

/// The runs of one motion, in the order of [`Pipeline::ALL`].
struct MotionRuns<'a> {
    motion: Motion,
    closed: u32,
    rate_hz: f64,
    runs: &'a [Vec<Tick>],
}

impl MotionRuns<'_> {
    fn rows(&self, cost: impl Fn(usize) -> Option<Cost>, long_run: &LongRunPath) -> Vec<Row> {
        let in_double = Pipeline::ALL.iter().position(|&p| p == Pipeline::Of(Format::F64));
        let double = in_double.map_or(&[][..], |index| &self.runs[index]);
        let of_double_nm = errors::of_double_nm(self.motion, self.closed, double);
        let row = |(index, (pipeline, run)): (usize, (Pipeline, &Vec<Tick>))| {
            let is_single = pipeline == Pipeline::F32Position;
            let mut command = errors::command(run, double, &of_double_nm);
            let mut drift_nm = None;
            if self.motion == Motion::LongRun {
                let (path, end_nm) = if is_single {
                    (long_run.single, long_run.single_end_nm)
                } else {
                    (long_run.integer, long_run.end_nm)
                };
                command = path;
                // The circles are the second and the fourth block.
                drift_nm = Some(end_nm.max(errors::mean_shift_nm(run, 1, 3)));
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
                max_instructions: cost.map(|cost| cost.max),
            }
        };
        Pipeline::ALL.into_iter().zip(self.runs).enumerate().map(row).collect()
    }

    /// Maximum table error of each of [`CURVE_POINTS`] sections: time (s) and distance (nm).
    fn curve(&self, run: &[Tick], double: &[Tick]) -> Vec<(f64, f64)> {
        let section = run.len().div_ceil(CURVE_POINTS).max(1);
        let max = |(run, double): (&[Tick], &[Tick])| {
            let distances_nm = run.iter().zip(double).map(|(r, d)| length(difference_nm(r.table, d.table)));
            numerics::max_abs(distances_nm)
        };
        let maxima = run.chunks(section).zip(double.chunks(section)).map(max);
        maxima.enumerate().map(|(i, nm)| ((i * section) as f64 / self.rate_hz, nm)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::errors::Spread;
    use crate::compare::point::AXES;

    /// 36 s of circles in place of a day.
    fn short() -> Comparison {
        run(&Options { hours: 0.01, emulator: None }, &|_| ()).unwrap()
    }

    fn row<'a>(comparison: &'a Comparison, motion: &str, scalar: &str) -> &'a Row {
        comparison.rows.iter().find(|row| row.motion == motion && row.scalar == scalar).unwrap()
    }

    /// Both axes need Coulomb friction, presliding and a Stribeck effect; the comparison would be too easy without them.
    #[test]
    fn the_machine_has_friction() {
        let machine = Machine::parse(MACHINE, "machine.toml").unwrap();
        assert_eq!(machine.axis.len(), AXES);
        for axis in machine.axis.values() {
            let mechanics = &axis.settings.mechanics;
            assert!(mechanics.coulomb_n > Some(100.0));
            assert!(mechanics.presliding_stiffness_n_per_um > Some(10.0));
            assert!(axis.effect.iter().any(|effect| effect.name() == "stribeck"));
        }
    }

    #[test]
    fn the_aims_are_met_and_f32_positions_are_worse() {
        let comparison = short();
        assert_eq!(comparison.rows.len(), 20);
        for motion in Motion::ALL.map(Motion::name) {
            let [fixed, f32, f64, single] =
                Pipeline::ALL.map(|pipeline| row(&comparison, motion, pipeline.name()));
            // The aim; the error is not zero, since fixed point rounds.
            assert!(fixed.position_error_nm.max < 5.0 && fixed.position_error_nm.rms < 1.0, "{fixed:?}");
            assert!(fixed.position_error_nm.max > 1e-4 && f32.position_error_nm.max > 1e-4);
            assert!(f64.position_error_nm.max == 0.0);
            // The same integer path for all three, within 0.5 nm of the exact one.
            assert!(
                fixed.command_error_nm == f64.command_error_nm
                    && f32.command_error_nm == f64.command_error_nm
            );
            assert!(f64.command_error_nm.max < 0.5);
            // An encoder resolution of 4 to 119 nm affects the table more than the rounding of the control laws.
            assert!(single.position_error_nm.rms > 20.0 * fixed.position_error_nm.rms, "{single:?}");
            for row in [fixed, f32, f64, single] {
                assert_eq!(row.drift_nm.is_some(), motion == "long_run");
                assert_eq!(row.instructions_per_tick, None);
            }
        }
        // Rounding shifts the mean of 50,000 ticks far less than a single tick: there is no drift.
        for scalar in ["fixed", "f32", "f64"] {
            assert!(row(&comparison, "long_run", scalar).drift_nm.unwrap() < 0.01);
        }
        assert!(comparison.long_run.end_nm == 0.0);
    }

    /// Above 1 m the spacing of f32 is 2⁻²³ m = 119.2 nm. Rounding alone has an error of up to half of that,
    /// 119.2/√12 = 34.4 nm rms; the sum with a rounded start has up to twice that error.
    #[test]
    fn f32_positions_at_1_m_lose_as_much_as_their_spacing() {
        let comparison = short();
        let spacing = 1e9 * f64::from(f32::EPSILON);
        for motion in ["steps", "creep"] {
            let Spread { max, rms } = row(&comparison, motion, "f32_position").command_error_nm;
            assert!((0.45 * spacing..1.01 * spacing).contains(&max), "{motion}: {max}");
            let rounding = spacing / 12f64.sqrt();
            assert!((0.8 * rounding..1.45 * rounding).contains(&rms), "{motion}: {rms}");
        }
    }
}
