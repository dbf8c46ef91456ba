//! Finds a circle that two axes were commanded to run.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use trace::signals::Signals;

/// Slower than this share of a log's fastest speed the axes stand, and a stretch ends.
const STANDING: f64 = 0.01;

/// The command counts as on the circle within this share of its radius.
const ON_CIRCLE: f64 = 1e-3;

/// Arcs whose centres and radii differ by less than this share of the radius are one circle.
const SAME: f64 = 0.01;

/// Less than this angle of an arc is a rounded corner, and of all arcs no circle.
const LEAST_ARC: f64 = TAU / 6.0;
const LEAST_CIRCLE: f64 = TAU / 2.0;

/// A circle in the plane of the first two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Circle {
    /// Number of the log.
    pub log: usize,
    /// Its centre, m.
    pub centre: [f64; 2],
    /// m.
    pub radius: f64,
    /// The stretches of the log on it.
    pub arcs: Vec<Arc>,
}

/// One stretch of a log on a circle, run in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Arc {
    /// Samples.
    pub samples: Range<usize>,
    /// Seen with the first axis to the right and the second up.
    pub is_clockwise: bool,
    /// Angle run, not negative.
    pub swept: f64,
}

/// The largest circle in the logs.
pub fn find(logs: &[Signals]) -> Option<Circle> {
    let circles = logs.iter().enumerate().filter_map(|(log, signals)| {
        let [x, y] = signals.axes.get(..2)? else { return None };
        of_log(log, x.command.as_ref()?, y.command.as_ref()?)
    });
    // The first of several that are equal.
    circles.fold(None, |best: Option<Circle>, circle| match best {
        Some(best) if best.radius >= circle.radius => Some(best),
        _ => Some(circle),
    })
}

fn of_log(log: usize, x: &[f64], y: &[f64]) -> Option<Circle> {
    let mut arcs: Vec<Circle> =
        moving(x, y).into_iter().filter_map(|samples| fit(log, x, y, samples)).collect();
    arcs.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    arcs.iter().find_map(|largest| {
        let near = SAME * largest.radius;
        let is_same = |arc: &&Circle| {
            let apart = (arc.centre[0] - largest.centre[0]).hypot(arc.centre[1] - largest.centre[1]);
            apart < near && (arc.radius - largest.radius).abs() < near
        };
        let mut together: Vec<Arc> =
            arcs.iter().filter(is_same).flat_map(|circle| circle.arcs.clone()).collect();
        together.sort_by_key(|arc| arc.samples.start);
        let swept: f64 = together.iter().map(|arc| arc.swept).sum();
        (swept >= LEAST_CIRCLE).then(|| Circle { arcs: together, ..largest.clone() })
    })
}

/// The stretches between standstills.
fn moving(x: &[f64], y: &[f64]) -> Vec<Range<usize>> {
    let step = |i: usize| (x[i + 1] - x[i]).hypot(y[i + 1] - y[i]);
    let steps = x.len().min(y.len()).saturating_sub(1);
    let least = STANDING * numerics::max_abs((0..steps).map(step));
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for i in (0..steps).filter(|&i| step(i) > least) {
        match stretches.last_mut() {
            Some(last) if last.end == i => last.end = i + 1,
            _ => stretches.push(i..i + 1),
        }
    }
    stretches
}

/// The circle that most of a stretch lies on, with the longest part of the stretch that does.
fn fit(log: usize, x: &[f64], y: &[f64], stretch: Range<usize>) -> Option<Circle> {
    const ROUNDS: i32 = 12;
    let mut kept: Vec<usize> = stretch.clone().collect();
    let (mut centre, mut radius) = ([0.0; 2], 0.0);
    // From a tenth of the radius on, what lies off is left out of the next fit.
    for round in 0..=ROUNDS {
        (centre, radius) = least_squares(x, y, &kept)?;
        let near = radius * 0.1 * (10.0 * ON_CIRCLE).powf(f64::from(round) / f64::from(ROUNDS));
        let is_on = |i: &usize| ((x[*i] - centre[0]).hypot(y[*i] - centre[1]) - radius).abs() < near;
        kept = stretch.clone().filter(is_on).collect();
        if 2 * kept.len() < stretch.len() {
            return None;
        }
    }
    let mut runs = kept.chunk_by(|a, b| a + 1 == *b);
    let mut longest = runs.next()?;
    for run in runs.filter(|run| !run.is_empty()) {
        if run.len() > longest.len() {
            longest = run;
        }
    }
    let samples = longest[0]..longest[longest.len() - 1] + 1;
    let angle = |i: usize| (y[i] - centre[1]).atan2(x[i] - centre[0]);
    let swept: f64 = samples
        .clone()
        .skip(1)
        .map(|i| (angle(i) - angle(i - 1) + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU)
        .sum();
    let arc = Arc { samples, is_clockwise: swept < 0.0, swept: swept.abs() };
    (arc.swept >= LEAST_ARC).then(|| Circle { log, centre, radius, arcs: vec![arc] })
}

/// Least-squares circle through points, linear in 2·centre and radius² − centre² (Kåsa, 1976).
fn least_squares(x: &[f64], y: &[f64], points: &[usize]) -> Option<([f64; 2], f64)> {
    let mean = |values: &[f64]| numerics::mean(points.iter().map(|&i| values[i]));
    let (x0, y0) = (mean(x), mean(y));
    let mut normal = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for &i in points {
        let (dx, dy) = (x[i] - x0, y[i] - y0);
        let row = Vector3::new(dx, dy, 1.0);
        normal += row * row.transpose();
        right += row * (dx * dx + dy * dy);
    }
    let solution = normal.lu().solve(&right)?;
    let (cx, cy) = (0.5 * solution[0], 0.5 * solution[1]);
    let radius = (solution[2] + cx * cx + cy * cy).sqrt();
    (radius.is_finite() && radius > 0.0).then_some(([x0 + cx, y0 + cy], radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a path with its corners, straight or on arcs, at a constant speed.
    fn arc(centre: [f64; 2], radius: f64, from: f64, to: f64, samples: usize) -> Vec<(f64, f64)> {
        let angle = |i: usize| from + (to - from) * i as f64 / samples as f64;
        (0..=samples)
            .map(|i| (centre[0] + radius * angle(i).cos(), centre[1] + radius * angle(i).sin()))
            .collect()
    }

    fn of(path: &[(f64, f64)]) -> Option<Circle> {
        let (x, y): (Vec<f64>, Vec<f64>) = path.iter().copied().unzip();
        of_log(0, &x, &y)
    }

    #[test]
    fn both_directions_of_a_circle_are_found_and_what_is_no_circle_is_left_out() {
        let mut path: Vec<(f64, f64)> = (0..300).map(|i| (0.1 + 1e-4 * f64::from(i - 300), 0.02)).collect();
        path.extend(arc([0.05, 0.02], 0.05, 0.0, TAU, 3000));
        path.extend(vec![(0.1, 0.02); 100]);
        path.extend(arc([0.05, 0.02], 0.05, 0.0, -TAU, 3000));
        let circle = of(&path).unwrap();
        assert!((circle.radius - 0.05).abs() < 1e-6, "{circle:?}");
        assert!((circle.centre[0] - 0.05).hypot(circle.centre[1] - 0.02) < 1e-6, "{circle:?}");
        let directions: Vec<bool> = circle.arcs.iter().map(|arc| arc.is_clockwise).collect();
        assert_eq!(directions, [false, true]);
        for arc in &circle.arcs {
            assert!((arc.swept - TAU).abs() < 0.1, "{arc:?}");
            assert!(arc.samples.len() < 3100, "the line in front is not part of it: {arc:?}");
        }
    }

    #[test]
    fn lines_squares_and_rounded_corners_are_no_circles() {
        let line: Vec<(f64, f64)> = (0..1000).map(|i| (1e-4 * f64::from(i), 2e-4 * f64::from(i))).collect();
        assert_eq!(of(&line), None);
        let side = |i: i32| f64::from(i) * 1e-4;
        let mut square: Vec<(f64, f64)> = (0..500).map(|i| (side(i), 0.0)).collect();
        square.extend((0..500).map(|i| (0.05, side(i))));
        square.extend((0..500).map(|i| (0.05 - side(i), 0.05)));
        square.extend((0..500).map(|i| (0.0, 0.05 - side(i))));
        assert_eq!(of(&square), None);
        assert_eq!(of(&arc([0.0, 0.0], 0.002, 0.0, TAU / 4.0, 400)), None);
        assert_eq!(of(&vec![(0.0, 0.0); 500]), None);
        assert_eq!(of(&[]), None);
    }

    #[test]
    fn the_largest_circle_is_taken() {
        let mut path = arc([0.0, 0.0], 0.01, 0.0, TAU, 1000);
        path.extend(vec![(0.01, 0.0); 50]);
        path.extend(arc([-0.02, 0.0], 0.03, 0.0, TAU, 3000));
        let circle = of(&path).unwrap();
        assert!((circle.radius - 0.03).abs() < 1e-6, "{circle:?}");
    }
}
