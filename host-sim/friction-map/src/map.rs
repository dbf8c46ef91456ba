//! The runs of a friction map.

use files::error::InputError;

/// Units of a map's speeds and forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Revolutions per minute and mN·m.
    Rotary,
    /// mm/s and N.
    Linear,
}

impl Unit {
    /// Printed unit of a force or torque.
    #[must_use]
    pub const fn force(self) -> &'static str {
        match self {
            Self::Rotary => "mN·m",
            Self::Linear => "N",
        }
    }

    /// Printed unit of a speed.
    #[must_use]
    pub const fn speed(self) -> &'static str {
        match self {
            Self::Rotary => "rpm",
            Self::Linear => "mm/s",
        }
    }

    /// Printed unit of a viscous coefficient.
    #[must_use]
    pub const fn viscous(self) -> &'static str {
        match self {
            Self::Rotary => "mN·m per rpm",
            Self::Linear => "N·s/m",
        }
    }

    /// Printed name of the drive's quantity.
    #[must_use]
    pub const fn drive(self) -> &'static str {
        match self {
            Self::Rotary => "torque",
            Self::Linear => "force",
        }
    }

    /// Suffix of the JSON keys of forces.
    #[must_use]
    pub const fn force_key(self) -> &'static str {
        match self {
            Self::Rotary => "mnm",
            Self::Linear => "n",
        }
    }

    /// Suffix of the JSON keys of speeds.
    #[must_use]
    pub const fn speed_key(self) -> &'static str {
        match self {
            Self::Rotary => "rpm",
            Self::Linear => "mm_s",
        }
    }
}

/// One run at constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Mean speed, signed, in [`Unit::speed`].
    pub velocity: f64,
    /// Mean torque or force of the drive, in [`Unit::force`]; positive if it acts in + direction.
    pub force: f64,
    /// Standard deviation of the force within the run, including ripple and noise.
    pub deviation: Option<f64>,
    /// Standard error of the mean force: the deviation divided by √(number of samples).
    pub error: Option<f64>,
}

/// A friction map without its runs at standstill.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionMap {
    /// Name of the file.
    pub source: String,
    /// Units of all values.
    pub unit: Unit,
    /// Moving runs by ascending velocity.
    pub runs: Vec<Run>,
    /// For each of `runs`, its index among the moving runs of the file, which is the order in time.
    pub file_order: Vec<usize>,
    /// Number of runs at speed 0. They are left out, as friction at standstill balances any force of the drive.
    pub standstill_runs: usize,
}

/// Minimum number of moving runs: the two declared parameters and three degrees of freedom to test them.
const MIN_RUNS: usize = 5;

/// Minimum number of different speeds, regardless of direction. Two speeds always determine a straight line.
const MIN_SPEEDS: usize = 3;

/// Ratio within which speeds count as equal, as the speeds of runs at one set point differ slightly.
const SAME_SPEED: f64 = 1.01;

/// The different speeds (absolute values) of runs, in ascending order.
pub(crate) fn distinct_speeds<'a>(runs: impl IntoIterator<Item = &'a Run>) -> Vec<f64> {
    let mut speeds: Vec<f64> = runs.into_iter().map(|run| run.velocity.abs()).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup_by(|next, last| *next < SAME_SPEED * *last);
    speeds
}

impl FrictionMap {
    /// A map of runs in the order of the file.
    ///
    /// # Errors
    /// If too few of them move, at too few speeds, or if all forces are 0.
    pub fn new(source: &str, unit: Unit, runs: Vec<Run>) -> Result<Self, InputError> {
        let total = runs.len();
        let mut moving: Vec<(usize, Run)> =
            runs.into_iter().filter(|run| run.velocity != 0.0).enumerate().collect();
        let standstill_runs = total - moving.len();
        if moving.len() < MIN_RUNS {
            let found = if standstill_runs > 0 {
                format!("{}, and {standstill_runs} at speed 0", moving.len())
            } else {
                moving.len().to_string()
            };
            return Err(InputError::expected(source, format!("{MIN_RUNS} moving runs or more"), found));
        }
        moving.sort_by(|a, b| a.1.velocity.total_cmp(&b.1.velocity));
        let speeds = distinct_speeds(moving.iter().map(|(_, run)| run));
        if speeds.len() < MIN_SPEEDS {
            let expected = format!("runs at {MIN_SPEEDS} different speeds or more");
            return Err(InputError::expected(source, expected, speeds.len()));
        }
        if moving.iter().all(|(_, run)| run.force == 0.0) {
            return Err(InputError::expected(source, "a force that is not 0 in every run", "0"));
        }
        let (file_order, runs) = moving.into_iter().unzip();
        Ok(Self { source: source.to_owned(), unit, runs, file_order, standstill_runs })
    }

    /// Whether there are runs in both directions.
    #[must_use]
    pub fn has_both_directions(&self) -> bool {
        let first = self.runs.first().is_some_and(|run| run.velocity < 0.0);
        let last = self.runs.last().is_some_and(|run| run.velocity > 0.0);
        first && last
    }

    /// Standard error of a run's mean, rms over the runs, in [`Unit::force`]; `None` if the file does not contain it.
    #[must_use]
    pub fn standard_error(&self) -> Option<f64> {
        let errors: Option<Vec<f64>> = self.runs.iter().map(|run| run.error).collect();
        errors.map(numerics::rms)
    }

    /// Standard deviation of the force within a run, rms over the runs, in [`Unit::force`]; `None` if the file does not
    /// contain it.
    #[must_use]
    pub fn deviation_within_runs(&self) -> Option<f64> {
        let deviations: Option<Vec<f64>> = self.runs.iter().map(|run| run.deviation).collect();
        deviations.map(numerics::rms)
    }
}
