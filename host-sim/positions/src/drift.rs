//! What the runs tell of a drift: its course over the clock, and how much it varies over position.

use numerics::distributions::student_t_975;

use super::course::Course;
use super::fit::{Fit, Samples, whole};
use super::variant::{Drift, Gap, Grid, Mean, Variant};

/// The form with a value at each knot of each part.
fn fullest(has_both_ways: bool) -> Variant {
    let gap = if has_both_ways { Gap::Map } else { Gap::None };
    Variant { mean: Mean::Map, gap, drift: Drift::Map }
}

/// Mean of a course over samples.
#[must_use]
pub fn mean_course(course: &Course, samples: &Samples) -> f64 {
    numerics::mean(samples.places.iter().map(|place| course.at(place.instant)))
}

/// The course with the time constant that leaves least, with its interval, if that is bounded on both sides. Otherwise the course of a
/// warm-up whose end is not shown, or what leaves least if the runs contradict that.
#[must_use]
pub fn course(
    samples: &Samples,
    knots_mm: &[f64],
    has_both_ways: bool,
    (span, runs): ([f64; 2], usize),
) -> (Course, Option<[f64; 2]>) {
    let fitted = |time_constant: Option<f64>| {
        let course = Course { time_constant, span };
        let grid = Grid::new(knots_mm.to_vec(), course, mean_course(&course, samples));
        Fit::of(&fullest(has_both_ways), &grid, samples, 0.0)
    };
    let unknown = Course::unknown(span, runs);
    let Some(line) = fitted(None) else { return (unknown, None) };
    let freedom = line.freedom - 1.0;
    let squares = |constant: f64| fitted(Some(constant)).map_or(f64::INFINITY, |fit| fit.squares());
    let Some(profile) = Profile::of(&Course::tried(span), &squares).filter(|_| freedom >= 1.0) else {
        return (unknown, None);
    };
    let t = student_t_975(whole(freedom));
    let limit = profile.least.min(line.squares()) * (1.0 + t * t / freedom);
    let ends = profile.ends(limit, &squares);
    if let ([Some(low), Some(high)], true) = (ends, line.squares() > limit) {
        return (Course { time_constant: Some(profile.best), span }, Some([low, high]));
    }
    let is_contradicted = unknown.time_constant.is_none_or(|constant| squares(constant) > limit);
    let shown = (profile.least < line.squares()).then_some(profile.best);
    (if is_contradicted { Course { time_constant: shown, span } } else { unknown }, None)
}

/// What time constants leave: those that were tried, and the best between them.
struct Profile {
    tried: Vec<(f64, f64)>,
    best: f64,
    least: f64,
}

impl Profile {
    fn of(constants: &[f64], squares: &impl Fn(f64) -> f64) -> Option<Self> {
        const GOLDEN: f64 = 0.618_033_988_749_895;
        let tried: Vec<(f64, f64)> =
            constants.iter().map(|&constant| (constant, squares(constant))).collect();
        let index = (0..tried.len()).min_by(|a, b| tried[*a].1.total_cmp(&tried[*b].1))?;
        let mut low = tried[index.saturating_sub(1)].0;
        let mut high = tried[(index + 1).min(tried.len() - 1)].0;
        for _ in 0..16 {
            let (left, right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
            if squares(left) < squares(right) { high = right } else { low = left }
        }
        let best = 0.5 * (low + high);
        Some(Self { least: squares(best), best, tried })
    }

    /// Where the squares reach a limit below and above the best; `None` where they do not.
    fn ends(&self, limit: f64, squares: &impl Fn(f64) -> f64) -> [Option<f64>; 2] {
        let below = self.tried.iter().rev().find(|(constant, left)| *constant < self.best && *left > limit);
        let above = self.tried.iter().find(|(constant, left)| *constant > self.best && *left > limit);
        let between = |outside: f64| {
            let (mut inside, mut outside) = (self.best, outside);
            for _ in 0..12 {
                let middle = 0.5 * (inside + outside);
                if squares(middle) > limit { outside = middle } else { inside = middle }
            }
            0.5 * (inside + outside)
        };
        [below, above].map(|end| end.map(|(constant, _)| between(*constant)))
    }
}

/// How strongly a drift over position is held to a straight line: the variance of the scatter divided by that of the drift from target to
/// target, both from the readings (empirical Bayes). `None` if the drift varies no more than the scatter makes it.
#[must_use]
pub fn ridge(samples: &Samples, grid: &Grid, has_both_ways: bool) -> Option<f64> {
    let variant = fullest(has_both_ways);
    let fit = Fit::of(&variant, grid, samples, 0.0)?;
    let variance = fit.scatter_um()?.powi(2);
    let columns = variant.columns(grid).drift;
    let bent = grid.without_line();
    let values = &bent * fit.coefficients.rows(columns.start, columns.len());
    let free = grid.knots_mm.len().checked_sub(2).filter(|free| *free > 0)?;
    let of_scatter = variance * (&bent * fit.covariance(columns) * bent.transpose()).trace();
    let of_drift = (values.norm_squared() - of_scatter) / free as f64;
    (of_drift > 0.0).then(|| (variance / of_drift).max(1e-9))
}
