//! The results of a comparison.

use serde::Serialize;

use super::errors::Spread;
use super::long_run::LongRunPath;
use super::pipeline::Pipeline;

/// One motion in one arithmetic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the motion.
    pub motion: &'static str,
    /// Name of the pipeline.
    pub scalar: &'static str,
    /// Distances of the commands from the exact path at the same tick.
    pub command_error_nm: Spread,
    /// Distances of the tables from those of the run in double precision.
    pub position_error_nm: Spread,
    /// For the long run: distance of the last command from the programmed end along the path, or distance between the
    /// mean table positions at the beginning and at the end, whichever is greater.
    pub drift_nm: Option<f64>,
    /// Instructions of a tick with position loops on the emulated core, median.
    pub instructions_per_tick: Option<u32>,
    /// Maximum table error of each section of the motion: time (s) and distance (nm).
    #[serde(skip)]
    pub curve: Vec<(f64, f64)>,
    /// Instructions of a tick with position loops, maximum.
    #[serde(skip)]
    pub max_instructions: Option<u32>,
}

/// All motions in all pipelines.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// By motion, then by pipeline.
    pub rows: Vec<Row>,
    /// Turns of the long run.
    #[serde(skip)]
    pub turns: u32,
    /// Length of the long run, h.
    #[serde(skip)]
    pub hours: f64,
    /// The path of the long run.
    #[serde(skip)]
    pub long_run: LongRunPath,
    /// Reason why no instructions were counted.
    #[serde(skip)]
    pub not_counted: Option<String>,
}

impl Comparison {
    /// The rows of a pipeline.
    pub fn of(&self, pipeline: Pipeline) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.scalar == pipeline.name())
    }
}
