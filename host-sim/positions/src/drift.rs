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
/// warm-up whose end is not shown, or a straight line if the runs contradict that.
#[must_use]
pub fn course(
    samples: &Samples,
    knots_mm: &[f64],
    has_both_ways: bool,
    (span, runs): ([f64; 2], usize),
) -> (Course, Option<[f64; 2]>) {
    let squares = |time_constant: Option<f64>| {
        let course = Course { time_constant, span };
        let grid = Grid::new(knots_mm.to_vec(), course, mean_course(&course, samples));
        Fit::of(&fullest(has_both_ways), &grid, samples, 0.0).map(|fit| (fit.squares(), fit.freedom - 1.0))
    };
    let unknown = Course::unknown(span, runs);
    let tried: Vec<(f64, f64)> = Course::tried(span)
        .into_iter()
        .filter_map(|constant| Some((constant, squares(Some(constant))?.0)))
        .collect();
    let (Some((line, freedom)), Some(&(best, least))) =
        (squares(None), tried.iter().min_by(|a, b| a.1.total_cmp(&b.1)))
    else {
        return (unknown, None);
    };
    if freedom < 1.0 {
        return (unknown, None);
    }
    let t = student_t_975(whole(freedom));
    let limit = least.min(line) * (1.0 + t * t / freedom);
    let within: Vec<f64> =
        tried.iter().filter(|(_, squares)| *squares <= limit).map(|(constant, _)| *constant).collect();
    let ends = within.first().copied().zip(within.last().copied());
    let is_bounded = line > limit && tried.first().is_some_and(|(_, squares)| *squares > limit);
    match ends.filter(|_| is_bounded) {
        Some((low, high)) => (Course { time_constant: Some(best), span }, Some([low, high])),
        None => {
            let is_contradicted =
                unknown.time_constant.is_some_and(|constant| ends.is_none_or(|(low, _)| constant < low));
            (if is_contradicted { Course { time_constant: None, span } } else { unknown }, None)
        }
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
