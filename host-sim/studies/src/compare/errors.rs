//! Errors of a run against the exact path and against the run in double precision.

use super::exact_path::ExactPath;
use super::motion::Motion;
use super::pipeline::Tick;
use super::point::{AXES, Point, difference_nm, length};

/// Maximum and root mean square of distances, nm.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Spread {
    /// Maximum.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
}

/// Accumulates the [`Spread`] of distances.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpreadSum {
    max: f64,
    squares: f64,
    count: u64,
}

impl SpreadSum {
    /// Adds a distance, nm.
    pub fn add(&mut self, nm: f64) {
        self.max = self.max.max(nm);
        self.squares += nm * nm;
        self.count += 1;
    }

    /// The spread of all distances that were added.
    #[must_use]
    pub fn spread(&self) -> Spread {
        Spread { max: self.max, rms: (self.squares / self.count.max(1) as f64).sqrt() }
    }
}

/// Error of each command of the run in double precision, nm: the vector from the nearest point of the exact path.
#[must_use]
pub fn of_double_nm(motion: Motion, turns: u32, double: &[Tick]) -> Vec<[f64; AXES]> {
    let mut start = motion.start();
    let mut exact = Vec::new();
    for block in motion.blocks(turns) {
        exact.push(ExactPath::of(&block, start));
        start = exact.last().map_or(start, ExactPath::end);
    }
    let of = |tick: &Tick| exact.get(tick.block).map_or([f64::NAN; AXES], |path| path.error_nm(tick.command));
    double.iter().map(of).collect()
}

/// Distances of the commands of a run from the exact path at that tick, with the result of [`of_double_nm`].
#[must_use]
pub fn command(run: &[Tick], double: &[Tick], of_double_nm: &[[f64; AXES]]) -> Spread {
    let mut sum = SpreadSum::default();
    for ((run, double), error_nm) in run.iter().zip(double).zip(of_double_nm) {
        sum.add(command_nm(run.command, double.command, *error_nm));
    }
    sum.spread()
}

/// Distance of a command from the exact path at that tick, nm, from the command in double precision and its error, nm.
#[must_use]
pub fn command_nm(command: Point, double: Point, error_nm: [f64; AXES]) -> f64 {
    let [x, y] = difference_nm(command, double);
    length([x + error_nm[0], y + error_nm[1]])
}

/// Distances between the tables of two runs.
#[must_use]
pub fn position(run: &[Tick], double: &[Tick]) -> Spread {
    let mut sum = SpreadSum::default();
    for (run, double) in run.iter().zip(double) {
        sum.add(length(difference_nm(run.table, double.table)));
    }
    sum.spread()
}

/// Distance between the mean table positions of two blocks with the same commands, nm.
///
/// The means are those of the second halves, in which the start from a standstill has decayed.
#[must_use]
pub fn mean_shift_nm(run: &[Tick], first: usize, last: usize) -> f64 {
    let Some(origin) = run.first().map(|tick| tick.table) else { return 0.0 };
    let mean = |block: usize| {
        let of: Vec<&Tick> = run.iter().filter(|tick| tick.block == block).collect();
        let half = &of[of.len() / 2..];
        let mut sum = [0.0; AXES];
        for tick in half {
            let [x, y] = difference_nm(tick.table, origin);
            sum = [sum[0] + x, sum[1] + y];
        }
        sum.map(|sum| sum / half.len().max(1) as f64)
    };
    let (a, b) = (mean(first), mean(last));
    length([b[0] - a[0], b[1] - a[1]])
}

#[cfg(test)]
mod tests {
    use shared::units::Position;

    use super::*;

    fn tick(block: usize, command_m: f64, table_m: f64) -> Tick {
        let at = |m: f64| [Position::from_m(m).unwrap(), Position(0)];
        Tick { block, command: at(command_m), table: at(table_m), cost: None }
    }

    #[test]
    fn maximum_and_root_mean_square_are_those_by_hand() {
        let double = [tick(0, 1.0, 1.0), tick(0, 1.0, 1.0)];
        let run = [tick(0, 1.0 + 3e-9, 1.0), tick(0, 1.0 - 4e-9, 1.0 + 2e-9)];
        let of_double_nm = [[0.0; AXES], [0.0, 3.0]];
        // 3, and √(4² + 3²) = 5: √((9 + 25)/2) = 4.123.
        let spread = command(&run, &double, &of_double_nm);
        assert!((spread.max - 5.0).abs() < 1e-5 && (spread.rms - 17f64.sqrt()).abs() < 1e-5, "{spread:?}");
        let spread = position(&run, &double);
        assert!((spread.max - 2.0).abs() < 1e-5 && (spread.rms - 2f64.sqrt()).abs() < 1e-5, "{spread:?}");
    }

    #[test]
    fn the_shift_of_the_mean_ignores_the_start() {
        // The first halves of the blocks differ widely, the second halves by 7 nm.
        let run: Vec<Tick> = [(0, 0.5), (0, 1.0), (1, 0.1), (1, 1.0 + 7e-9)]
            .map(|(block, table)| tick(block, 0.0, table))
            .to_vec();
        assert!((mean_shift_nm(&run, 0, 1) - 7.0).abs() < 1e-5);
    }
}
