//! How far a run lies from the exact path, and from the run in double precision.

use super::AXES;
use super::exact::{Exact, Point, apart_nm, length};
use super::motion::Motion;
use super::pipeline::{Tick, start_of};

/// Greatest and root mean square, nm.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Spread {
    /// Greatest.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
}

/// Adds a [`Spread`] up.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    most: f64,
    squares: f64,
    count: u64,
}

impl Sum {
    /// Adds a distance, nm.
    pub fn add(&mut self, nm: f64) {
        self.most = self.most.max(nm);
        self.squares += nm * nm;
        self.count += 1;
    }

    /// What has been added.
    #[must_use]
    pub fn spread(&self) -> Spread {
        Spread { max: self.most, rms: (self.squares / self.count.max(1) as f64).sqrt() }
    }
}

/// Where the command of a run should have been at each tick: the point of the exact path nearest to the
/// command of the run in double precision, as its offset from that command, nm.
#[must_use]
pub fn off_exact(motion: Motion, turns: u32, double: &[Tick]) -> Vec<[f64; AXES]> {
    let mut start = start_of(motion);
    let mut exact = Vec::new();
    for block in motion.blocks(turns) {
        exact.push(Exact::of(&block, start));
        start = exact.last().map_or(start, Exact::end);
    }
    let of = |tick: &Tick| exact.get(tick.block).map_or([f64::NAN; AXES], |e| e.off_nm(tick.command));
    double.iter().map(of).collect()
}

/// Distances between the commands of a run and where they should have been; `off` is from [`off_exact`].
#[must_use]
pub fn command(run: &[Tick], double: &[Tick], off: &[[f64; AXES]]) -> Spread {
    let mut sum = Sum::default();
    for ((run, double), off) in run.iter().zip(double).zip(off) {
        sum.add(command_nm(run.command, double.command, *off));
    }
    sum.spread()
}

/// Distance between a command and where it should be, for the command in double precision and how far
/// that is off.
#[must_use]
pub fn command_nm(command: Point, double: Point, off: [f64; AXES]) -> f64 {
    let [x, y] = apart_nm(command, double);
    length([x + off[0], y + off[1]])
}

/// Distances between the tables of two runs.
#[must_use]
pub fn position(run: &[Tick], double: &[Tick]) -> Spread {
    let mut sum = Sum::default();
    for (run, double) in run.iter().zip(double) {
        sum.add(length(apart_nm(run.table, double.table)));
    }
    sum.spread()
}

/// How far the mean of the table has moved from one block to another with the same commands, nm.
///
/// Over the second half of either, so that coming out of a standstill has no part in it.
#[must_use]
pub fn mean_moved_nm(run: &[Tick], first: usize, last: usize) -> f64 {
    let Some(origin) = run.first().map(|tick| tick.table) else { return 0.0 };
    let mean = |block: usize| {
        let of: Vec<&Tick> = run.iter().filter(|tick| tick.block == block).collect();
        let half = &of[of.len() / 2..];
        let mut sum = [0.0; AXES];
        for tick in half {
            let [x, y] = apart_nm(tick.table, origin);
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
    fn greatest_and_root_mean_square_are_by_hand() {
        let double = [tick(0, 1.0, 1.0), tick(0, 1.0, 1.0)];
        let run = [tick(0, 1.0 + 3e-9, 1.0), tick(0, 1.0 - 4e-9, 1.0 + 2e-9)];
        let off = [[0.0; AXES], [0.0, 3.0]];
        // 3, and 4 with 3 across: 5. √((9 + 25)/2) = 4.123.
        let spread = command(&run, &double, &off);
        assert!((spread.max - 5.0).abs() < 1e-5 && (spread.rms - 17f64.sqrt()).abs() < 1e-5, "{spread:?}");
        let spread = position(&run, &double);
        assert!((spread.max - 2.0).abs() < 1e-5 && (spread.rms - 2f64.sqrt()).abs() < 1e-5, "{spread:?}");
    }

    #[test]
    fn a_mean_that_moves_is_seen_and_a_start_is_not() {
        // The first half of each block is far off; the second halves lie 7 nm apart.
        let run: Vec<Tick> = [(0, 0.5), (0, 1.0), (1, 0.1), (1, 1.0 + 7e-9)]
            .map(|(block, table)| tick(block, 0.0, table))
            .to_vec();
        assert!((mean_moved_nm(&run, 0, 1) - 7.0).abs() < 1e-5);
    }
}
