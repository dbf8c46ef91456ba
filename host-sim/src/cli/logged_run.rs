//! A simulated run whose log is written row by row, so that memory does not grow with its duration.

use std::path::Path;

use anyhow::{Error, Result};

use super::input_error::Inputs;
use super::progress::Progress;
use contour::vector::Point;
use contour::{ContourError, Evaluation, NominalPath};
use files::format::significant;
use files::log::{Channel, write_rows};
use files::output::OutputError;
use model::axis::KeyNames;
use model::machine::Machine;
use motion::MAX_AXES;
use plant::controller::{Controller, Status};
use plant::simulate::{Run, Sample, SimulationError};

/// Statistics of a finished run.
pub struct RunStatistics {
    /// Rows of the log.
    pub samples: u64,
    axes: Vec<AxisStatistics>,
    contour_error: Option<ContourError>,
}

struct AxisStatistics {
    name: String,
    names: KeyNames,
    force_limit_n: Option<f64>,
    following_error_um: Magnitude,
    force_n: Magnitude,
    /// Number of rows with the force at its limit.
    rows_at_limit: u64,
}

/// Running rms and maximum magnitude of a signal.
#[derive(Default)]
struct Magnitude {
    squares: f64,
    max: f64,
}

impl Magnitude {
    fn add(&mut self, value: f64) {
        self.squares += value * value;
        self.max = self.max.max(value.abs());
    }

    fn rms(&self, samples: u64) -> f64 {
        (self.squares / samples.max(1) as f64).sqrt()
    }
}

/// A force reading of at least this fraction of the limit counts as being at the limit, since readings have noise.
const AT_LIMIT: f64 = 0.99;

/// Runs a motion and writes its log to `out`, completely or not at all. `on_status` receives the status of every tick.
///
/// # Errors
/// Input that the controller refuses, a fault of the loop, output that cannot be written.
pub fn run(
    run: &Run<'_>,
    controller: &mut dyn Controller,
    out: &Path,
    inputs: &Inputs<'_>,
    mut on_status: impl FnMut(&Status),
) -> Result<RunStatistics> {
    let progress = Progress::start();
    let mut statistics = RunStatistics::new(run.machine);
    let path = NominalPath::of_blocks(run.start_m, run.blocks);
    let mut evaluation = Evaluation::new(&path, 1.0 / run.machine.sample_rate_hz);
    let is_linear = run.machine.axis.values().all(|axis| axis.settings.names == KeyNames::Linear);
    let mut failed = None;
    let written = write_rows(out, &run.empty_log(), |rows| {
        let ran = run.rows(
            controller,
            |time_s, status, _| {
                progress.machine_time(time_s);
                on_status(status);
            },
            |samples| {
                statistics.add(samples);
                let [command, tool] = positions_m(samples);
                evaluation.add(&command, &tool);
                rows.row(samples.iter().flat_map(Sample::values))
            },
        );
        ran.map_err(|error| match error {
            SimulationError::Log(error) => error,
            error => {
                failed = Some(error);
                std::io::Error::other("the run stopped")
            }
        })
    });
    drop(progress);
    // Degrees and millimetres make no contour.
    statistics.contour_error = evaluation.finish().filter(|_| is_linear);
    match failed {
        Some(error) => Err(inputs.error(error)),
        None => written.map(|()| statistics).map_err(|error: OutputError| Error::from(error)),
    }
}

/// Command and tool position of a row, m.
fn positions_m(samples: &[Sample]) -> [Point; 2] {
    let mut points = [[0.0; MAX_AXES]; 2];
    for (axis, sample) in samples.iter().enumerate().take(MAX_AXES) {
        points[0][axis] = 1e-3 * sample.command_mm;
        points[1][axis] = 1e-3 * sample.tool_mm;
    }
    points
}

impl RunStatistics {
    fn new(machine: &Machine) -> Self {
        let axes = machine.axis.iter().map(|(name, axis)| AxisStatistics {
            name: name.clone(),
            names: axis.settings.names,
            force_limit_n: axis.settings.controller.force_limit_n,
            following_error_um: Magnitude::default(),
            force_n: Magnitude::default(),
            rows_at_limit: 0,
        });
        Self { samples: 0, axes: axes.collect(), contour_error: None }
    }

    fn add(&mut self, samples: &[Sample]) {
        self.samples += 1;
        for (axis, sample) in self.axes.iter_mut().zip(samples) {
            axis.following_error_um.add(1e3 * (sample.command_mm - sample.motor_mm));
            axis.force_n.add(sample.force_n);
            let is_at_limit = |limit_n| sample.force_n.abs() > AT_LIMIT * limit_n;
            axis.rows_at_limit += u64::from(axis.force_limit_n.is_some_and(is_at_limit));
        }
    }

    /// A table of following error and force, a sentence for each axis whose force was at its limit, and the contour error
    /// at the tool.
    #[must_use]
    pub fn summary(&self) -> String {
        let has = |names| self.axes.iter().any(|axis| axis.names == names);
        let [error, force] = match (has(KeyNames::Linear), has(KeyNames::Rotary)) {
            (_, false) => ["following error µm", "force N"],
            (false, true) => ["following error mdeg", "torque N·m"],
            (true, true) => ["following error µm, mdeg", "force N, torque N·m"],
        };
        let mut lines = vec![
            format!("{:<6}{error:>28}{force:>24}", "axis"),
            format!("{:<6}{:>14}{:>14}{:>12}{:>12}", "", "rms", "greatest", "rms", "greatest"),
        ];
        for AxisStatistics { name, following_error_um, force_n, .. } in &self.axes {
            let [error, force] =
                [following_error_um, force_n].map(|signal| (signal.rms(self.samples), signal.max));
            lines.push(format!(
                "{name:<6}{:>14}{:>14}{:>12.1}{:>12.1}",
                significant(error.0, 3),
                significant(error.1, 3),
                force.0,
                force.1
            ));
        }
        for axis in self.axes.iter().filter(|axis| axis.rows_at_limit > 0) {
            let percent = 100.0 * axis.rows_at_limit as f64 / self.samples.max(1) as f64;
            lines.push(format!(
                "\n{}: the force is at its limit in {percent:.2} % of the samples.",
                axis.name
            ));
        }
        if let Some(error) = &self.contour_error {
            let axes: Vec<String> = self.axes.iter().map(|axis| axis.name.clone()).collect();
            lines.push(format!("\n{}", contour::text::of(error, Channel::Tool, &axes)));
        }
        lines.join("\n")
    }
}
