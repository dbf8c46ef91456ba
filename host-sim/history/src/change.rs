//! When a series changed, and by how much.

use crate::least_squares::Regression;

/// A fit whose squares exceed those of the best by this many variances is worse with 95 % probability.
const WORSE: f64 = 3.84;

/// The form of a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// From one trace to the next.
    Step,
    /// Steadily from one trace on.
    Growth,
    /// The traces do not tell.
    Unclear,
}

impl Shape {
    /// Its name in files.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Growth => "growth",
            Self::Unclear => "unclear",
        }
    }
}

/// A change within a stretch of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Index of the first value after it.
    pub first: usize,
    /// The earliest and the latest index that the values allow, 95 %.
    pub range: [usize; 2],
    /// Its form.
    pub shape: Shape,
    /// What it amounts to at the last value of the stretch.
    pub size: f64,
    /// Half width of the 95 % interval of the size, at this form and index.
    pub half_width: f64,
}

/// What a value has in addition after a change of a form that begins at an index.
fn added(shape: Shape, first: usize, at: usize, days: &[f64]) -> f64 {
    match shape {
        _ if at < first => 0.0,
        Shape::Growth => days[at] - days[first - 1],
        Shape::Step | Shape::Unclear => 1.0,
    }
}

/// The change that leaves the least of the values. `rows` are the regressors without the change, `days` the time of each value.
/// `None` if there are too few values.
#[must_use]
pub fn of(rows: &[Vec<f64>], values: &[f64], days: &[f64]) -> Option<Change> {
    let with_change = |shape: Shape, first: usize| -> Vec<Vec<f64>> {
        let with = |(at, row): (usize, &Vec<f64>)| [&row[..], &[added(shape, first, at, days)]].concat();
        rows.iter().enumerate().map(with).collect()
    };
    let shapes = [Shape::Step, Shape::Growth];
    let mut fits: Vec<(Shape, usize, Regression)> = Vec::new();
    for first in 1..values.len() {
        for shape in shapes {
            fits.extend(Regression::of(&with_change(shape, first), values).map(|fit| (shape, first, fit)));
        }
    }
    let squares = |fit: &(Shape, usize, Regression)| fit.2.squares;
    let best = fits.iter().min_by(|a, b| squares(a).total_cmp(&squares(b)))?;
    let (shape, first, fit) = best;
    if fit.freedom == 0 {
        return None;
    }
    let allowed = fit.squares + WORSE * fit.variance();
    let as_good = || fits.iter().filter(|other| squares(other) <= allowed);
    let other_shape = as_good().any(|other| other.0 != *shape);
    let firsts = || as_good().map(|other| other.1);
    let last = values.len() - 1;
    let full = added(*shape, *first, last, days);
    let mut effect = vec![0.0; rows.first()?.len()];
    effect.push(full);
    Some(Change {
        first: *first,
        range: [firsts().min().unwrap_or(*first), firsts().max().unwrap_or(*first)],
        shape: if other_shape { Shape::Unclear } else { *shape },
        size: fit.at(&effect),
        half_width: fit.half_width(&effect),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::noise::box_muller;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// 200 drawn series: the index is within its range, and the size within its interval, in about 95 of 100. The interval of the size
    /// is that at the best index, so that it holds somewhat less often; the lower bound has five standard errors (1.5 % each) of room.
    #[test]
    fn a_step_and_a_growth_are_dated_and_measured() {
        for (shape, full) in [(Shape::Step, 1.5), (Shape::Growth, 2.0)] {
            let (mut dated, mut measured, mut wrong_shape) = (0, 0, 0);
            for seed in 0..200 {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let days: Vec<f64> = (0..40).map(|i| 7.0 * f64::from(i)).collect();
                let (first, last) = (24, 39);
                let scale = full / added(shape, first, last, &days);
                let value = |at: usize| 3.0 + scale * added(shape, first, at, &days);
                let values: Vec<f64> = (0..40).map(|at| value(at) + 0.3 * box_muller(&mut rng)).collect();
                let change = of(&vec![vec![1.0]; 40], &values, &days).unwrap();
                dated += usize::from((change.range[0]..=change.range[1]).contains(&first));
                measured += usize::from((change.size - full).abs() <= change.half_width);
                let other = if shape == Shape::Step { Shape::Growth } else { Shape::Step };
                wrong_shape += usize::from(change.shape == other);
            }
            assert!(dated >= 178, "{shape:?}: {dated} of 200 dated");
            assert!((160..=200).contains(&measured), "{shape:?}: {measured} of 200 measured");
            assert!(wrong_shape <= 4, "{shape:?}: {wrong_shape} of 200 with the other form");
        }
    }
}
