//! Periodic errors as tables over a period.

use heapless::Vec;
use shared::compensate::settings::{CYCLES, Cycle, POINTS};

/// Two periods belong to one table if one is a multiple of the other, within this fraction of it.
const SAME_PERIOD: f64 = 1e-6;

/// A periodic function of the position, and the number of points that a table needs for each of its periods.
pub struct Wave<'a> {
    /// Period, m.
    pub period_m: f64,
    /// Half of the peak-to-peak value, to order waves by their size.
    pub amplitude: f64,
    /// The value at a position, m.
    pub value: Box<dyn Fn(f64) -> f64 + 'a>,
}

/// The tables of periodic functions: those whose periods divide a common one share its table. The second result is the number
/// of functions for which the controller has no table left.
///
/// A table has 64 points, between which the controller interpolates linearly: at the tenth harmonic up to 12 % of its
/// amplitude are left, at the first 0.1 %.
#[must_use]
pub fn tables(mut waves: std::vec::Vec<Wave<'_>>) -> (Vec<Cycle, CYCLES>, usize) {
    // The longest period is the fundamental; of two that do not divide each other, that of the larger wave comes first.
    waves.sort_by(|a, b| b.period_m.total_cmp(&a.period_m));
    let mut groups: std::vec::Vec<std::vec::Vec<Wave<'_>>> = std::vec::Vec::new();
    for wave in waves {
        let divides = |group: &std::vec::Vec<Wave<'_>>| {
            let order = group[0].period_m / wave.period_m;
            (order - order.round()).abs() < SAME_PERIOD * order
        };
        match groups.iter_mut().find(|group| divides(group)) {
            Some(group) => group.push(wave),
            None => groups.push(vec![wave]),
        }
    }
    let size = |group: &std::vec::Vec<Wave<'_>>| group.iter().map(|wave| wave.amplitude.abs()).sum::<f64>();
    groups.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let left_out = groups.iter().skip(CYCLES).map(std::vec::Vec::len).sum();
    (groups.iter().take(CYCLES).map(|group| table(group)).collect(), left_out)
}

fn table(group: &[Wave<'_>]) -> Cycle {
    let period_m = group[0].period_m;
    let value = |k: usize| {
        let position_m = period_m * k as f64 / POINTS as f64;
        group.iter().map(|wave| (wave.value)(position_m)).sum()
    };
    Cycle { period_m, values: (0..POINTS).map(value).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(period_m: f64, amplitude: f64) -> Wave<'static> {
        let value = move |x: f64| amplitude * (TAU * x / period_m).sin();
        Wave { period_m, amplitude, value: Box::new(value) }
    }

    /// The lead of 10 mm with its second harmonic is one table, a belt of 37 mm another, a third period has no place.
    #[test]
    fn harmonics_share_a_table() {
        let (made, left_out) =
            tables(vec![wave(0.01, 3e-6), wave(0.005, 1e-6), wave(0.037, 2e-6), wave(0.023, 1e-7)]);
        assert_eq!((made.len(), left_out), (2, 1));
        assert!((made[0].period_m - 0.01).abs() < 1e-15 && (made[1].period_m - 0.037).abs() < 1e-15);
        // At an eighth of the lead: 3·sin(45°) + 1·sin(90°).
        assert!((made[0].values[8] - (3e-6 * 0.5f64.sqrt() + 1e-6)).abs() < 1e-15);
        assert!((made[1].values[16] - 2e-6).abs() < 1e-15);
    }
}
