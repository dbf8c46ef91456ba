//! Steady-state friction maps: one row a run at constant speed, mean torque or force against mean speed.
//!
//! Declared is Coulomb and viscous friction, the same both ways. [`read`] takes the file in, [`law`] holds
//! what friction may do beside that, [`fit`] makes the weighted residual small, [`search`] adds one term
//! after the other as long as runs that were left out support it, [`unexplained`] says what stays, [`json`]
//! is the result for programs.

pub mod fit;
pub mod json;
pub mod law;
pub mod read;
pub mod search;
pub mod unexplained;

use files::error::InputError;

/// What a map's speeds and forces are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Revolutions a minute and mN·m.
    Rotary,
    /// mm/s and N.
    Linear,
}

impl Unit {
    /// Of a force, for people.
    #[must_use]
    pub const fn force(self) -> &'static str {
        match self {
            Self::Rotary => "mN·m",
            Self::Linear => "N",
        }
    }

    /// Of a speed, for people.
    #[must_use]
    pub const fn speed(self) -> &'static str {
        match self {
            Self::Rotary => "rpm",
            Self::Linear => "mm/s",
        }
    }

    /// What drives, for people.
    #[must_use]
    pub const fn drive(self) -> &'static str {
        match self {
            Self::Rotary => "torque",
            Self::Linear => "force",
        }
    }

    /// How keys of forces end.
    #[must_use]
    pub const fn force_key(self) -> &'static str {
        match self {
            Self::Rotary => "mnm",
            Self::Linear => "n",
        }
    }

    /// How keys of speeds end.
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
    /// Mean torque or force of the drive, in [`Unit::force`]; positive in + direction.
    pub force: f64,
    /// Standard deviation of the force within the run: ripple and noise together.
    pub deviation: Option<f64>,
    /// Standard error of the mean force: the deviation over the root of the number of samples.
    pub error: Option<f64>,
}

/// A map that can be explained: runs that move, sorted by speed.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionMap {
    /// Where it was read from.
    pub source: String,
    /// Of all its figures.
    pub unit: Unit,
    /// By rising velocity.
    pub runs: Vec<Run>,
    /// For each of them, its place in the file among the runs that move: the order in time.
    pub order: Vec<usize>,
    /// Runs that stand still and were left out: there friction is whatever balances the drive.
    pub standing: usize,
}

/// Least number of runs that move: two numbers are declared, and as many more have to contradict them.
const LEAST_RUNS: usize = 5;

/// Least number of different speeds, whichever the direction: two are on a line in any case.
const LEAST_SPEEDS: usize = 3;

impl FrictionMap {
    /// Takes runs in, in the order of the file.
    ///
    /// # Errors
    /// Where too few of them move to say anything.
    pub fn new(source: &str, unit: Unit, runs: Vec<Run>) -> Result<Self, InputError> {
        let total = runs.len();
        let mut moving: Vec<(usize, Run)> =
            runs.into_iter().filter(|run| run.velocity != 0.0).enumerate().collect();
        let standing = total - moving.len();
        if moving.len() < LEAST_RUNS {
            let found = if standing > 0 {
                format!("{}, and {standing} at speed 0", moving.len())
            } else {
                moving.len().to_string()
            };
            return Err(InputError::expected(source, format!("{LEAST_RUNS} runs that move or more"), found));
        }
        moving.sort_by(|a, b| a.1.velocity.total_cmp(&b.1.velocity));
        let mut speeds: Vec<f64> = moving.iter().map(|(_, run)| run.velocity.abs()).collect();
        speeds.sort_by(f64::total_cmp);
        // Runs at one set point differ by a little: what is nearer than a hundredth counts once.
        speeds.dedup_by(|next, last| *next < 1.01 * *last);
        if speeds.len() < LEAST_SPEEDS {
            return Err(InputError::expected(
                source,
                format!("runs at {LEAST_SPEEDS} different speeds or more"),
                speeds.len(),
            ));
        }
        if moving.iter().all(|(_, run)| run.force == 0.0) {
            return Err(InputError::expected(source, "a force that is not 0 in every run", "0"));
        }
        let (order, runs) = moving.into_iter().unzip();
        Ok(Self { source: source.to_owned(), unit, runs, order, standing })
    }

    /// Whether there are runs in both directions.
    #[must_use]
    pub fn is_two_way(&self) -> bool {
        let first = self.runs.first().is_some_and(|run| run.velocity < 0.0);
        let last = self.runs.last().is_some_and(|run| run.velocity > 0.0);
        first && last
    }

    /// The standard error of a run's mean, root mean square over the runs; `None` where the file has none.
    #[must_use]
    pub fn noise(&self) -> Option<f64> {
        let squares: Option<Vec<f64>> = self.runs.iter().map(|run| run.error.map(|e| e * e)).collect();
        squares.map(|squares| (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt())
    }

    /// The deviation within a run, root mean square over the runs; `None` where the file has none.
    #[must_use]
    pub fn ripple(&self) -> Option<f64> {
        let squares: Option<Vec<f64>> = self.runs.iter().map(|run| run.deviation.map(|d| d * d)).collect();
        squares.map(|squares| (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt())
    }
}

#[cfg(test)]
mod tests;
