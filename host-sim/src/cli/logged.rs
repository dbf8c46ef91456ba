//! A run that is logged to a file row by row, so that memory does not grow with its time.

use std::path::Path;

use anyhow::{Error, Result};

use super::progress::Progress;
use super::refusal::Given;
use files::log::write_rows;
use files::output::OutputError;
use link::controller::{Controller, Status};
use model::machine::Machine;
use plant::simulate::{Run, Sample, SimulationError};

/// What a finished run was like.
pub struct Logged {
    /// Rows of the log.
    pub samples: u64,
    axes: Vec<Seen>,
}

/// What has been seen of one axis.
struct Seen {
    name: String,
    limit_n: Option<f64>,
    following_um: Figures,
    force_n: Figures,
    /// Rows with the force at its limit.
    at_limit: u64,
}

#[derive(Default)]
struct Figures {
    squares: f64,
    greatest: f64,
}

impl Figures {
    fn add(&mut self, value: f64) {
        self.squares += value * value;
        self.greatest = self.greatest.max(value.abs());
    }

    fn rms(&self, samples: u64) -> f64 {
        (self.squares / samples.max(1) as f64).sqrt()
    }
}

/// Runs and logs to `out`, whole or not at all.
///
/// # Errors
/// Input that the controller refuses, a loop that does not hold, output that cannot be written.
pub fn run(
    run: &Run<'_>,
    controller: &mut dyn Controller,
    out: &Path,
    given: &Given<'_>,
    mut watch: impl FnMut(&Status),
) -> Result<Logged> {
    let progress = Progress::start();
    let mut logged = Logged::new(run.machine);
    let mut stopped = None;
    let written = write_rows(out, &run.empty_log(), |rows| {
        let ran = run.rows(
            controller,
            |time_s, status, _| {
                progress.machine_time(time_s);
                watch(status);
            },
            |samples| {
                logged.add(samples);
                rows.row(samples.iter().flat_map(Sample::values))
            },
        );
        ran.map_err(|error| match error {
            SimulationError::Log(error) => error,
            error => {
                stopped = Some(error);
                std::io::Error::other("the run stopped")
            }
        })
    });
    drop(progress);
    match stopped {
        Some(error) => Err(given.blamed(error)),
        None => written.map(|()| logged).map_err(|error: OutputError| Error::from(error)),
    }
}

impl Logged {
    fn new(machine: &Machine) -> Self {
        let axes = machine.axis.iter().map(|(name, axis)| Seen {
            name: name.clone(),
            limit_n: axis.settings.controller.force_limit_n,
            following_um: Figures::default(),
            force_n: Figures::default(),
            at_limit: 0,
        });
        Self { samples: 0, axes: axes.collect() }
    }

    fn add(&mut self, samples: &[Sample]) {
        self.samples += 1;
        for (axis, sample) in self.axes.iter_mut().zip(samples) {
            axis.following_um.add(1e3 * (sample.command_mm - sample.motor_mm));
            axis.force_n.add(sample.force_n);
            // The reading has noise; 1 % below the limit is at it.
            axis.at_limit += u64::from(axis.limit_n.is_some_and(|limit| sample.force_n.abs() > 0.99 * limit));
        }
    }

    /// Following error and force of each axis.
    #[must_use]
    pub fn summary(&self) -> String {
        let mut lines = vec![
            format!("{:<6}{:>28}{:>24}", "axis", "following error µm", "force N"),
            format!("{:<6}{:>14}{:>14}{:>12}{:>12}", "", "rms", "greatest", "rms", "greatest"),
        ];
        for Seen { name, following_um, force_n, .. } in &self.axes {
            let [error, force] =
                [following_um, force_n].map(|figures| (figures.rms(self.samples), figures.greatest));
            lines.push(format!(
                "{name:<6}{:>14.3}{:>14.3}{:>12.1}{:>12.1}",
                error.0, error.1, force.0, force.1
            ));
        }
        for axis in self.axes.iter().filter(|axis| axis.at_limit > 0) {
            let percent = 100.0 * axis.at_limit as f64 / self.samples.max(1) as f64;
            lines.push(format!(
                "\n{}: the force stands at its limit in {percent:.2} % of the samples.",
                axis.name
            ));
        }
        lines.join("\n")
    }
}
