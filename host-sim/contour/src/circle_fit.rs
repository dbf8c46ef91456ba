//! Finds a circle in the commands of two axes.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

/// Largest speed that counts as standstill, as a fraction of the largest speed in the log.
const STANDSTILL_FRACTION: f64 = 0.01;

/// Largest distance of the command from the circle, as a fraction of the radius.
const MAX_DISTANCE_FRACTION: f64 = 1e-3;

/// Arcs belong to one circle if their centres and radii differ by less than this fraction of the radius.
const SAME_CIRCLE_FRACTION: f64 = 0.01;

/// Smallest angle of an arc; a rounded corner is shorter.
const MIN_ARC_RAD: f64 = TAU / 6.0;
/// Smallest angle of all arcs of a circle together.
const MIN_CIRCLE_RAD: f64 = TAU / 2.0;

/// A circle in the plane of two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Circle {
    /// Centre, m.
    pub centre: [f64; 2],
    /// Radius, m.
    pub radius: f64,
    /// The parts of the command on this circle, in order of time.
    pub arcs: Vec<Arc>,
}

/// A part of a command on a circle, in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Arc {
    /// Range of samples.
    pub samples: Range<usize>,
    /// Seen with the first axis to the right and the second up.
    pub is_clockwise: bool,
    /// Angle that the command sweeps, rad, not negative.
    pub swept_rad: f64,
}

/// The largest circle in the command of two axes, one value per sample, m.
#[must_use]
pub fn find(x: &[f64], y: &[f64]) -> Option<Circle> {
    let mut arcs: Vec<Circle> = moving(x, y).into_iter().filter_map(|samples| fit(x, y, samples)).collect();
    arcs.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    arcs.iter().find_map(|largest| {
        let tolerance = SAME_CIRCLE_FRACTION * largest.radius;
        let is_same = |arc: &&Circle| {
            let distance = libm::hypot(arc.centre[0] - largest.centre[0], arc.centre[1] - largest.centre[1]);
            distance < tolerance && (arc.radius - largest.radius).abs() < tolerance
        };
        let mut same: Vec<Arc> = arcs.iter().filter(is_same).flat_map(|circle| circle.arcs.clone()).collect();
        same.sort_by_key(|arc| arc.samples.start);
        let swept_rad: f64 = same.iter().map(|arc| arc.swept_rad).sum();
        (swept_rad >= MIN_CIRCLE_RAD).then(|| Circle { arcs: same, ..largest.clone() })
    })
}

/// The ranges of samples between standstills, and between points at which the motion turns back by more than 90°.
fn moving(x: &[f64], y: &[f64]) -> Vec<Range<usize>> {
    let step = |i: usize| libm::hypot(x[i + 1] - x[i], y[i + 1] - y[i]);
    let steps = x.len().min(y.len()).saturating_sub(1);
    let min_step = STANDSTILL_FRACTION * numerics::max_abs((0..steps).map(step));
    let turns_back = |i: usize| {
        i > 0 && (x[i + 1] - x[i]) * (x[i] - x[i - 1]) + (y[i + 1] - y[i]) * (y[i] - y[i - 1]) < 0.0
    };
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for i in (0..steps).filter(|&i| step(i) > min_step) {
        match ranges.last_mut() {
            Some(last) if last.end == i && !turns_back(i) => last.end = i + 1,
            _ => ranges.push(i..i + 1),
        }
    }
    ranges
}

/// The circle that most of a range of samples lies on, with its longest uninterrupted arc.
fn fit(x: &[f64], y: &[f64], range: Range<usize>) -> Option<Circle> {
    const ROUNDS: i32 = 12;
    let mut kept: Vec<usize> = range.clone().collect();
    let (mut centre, mut radius) = ([0.0; 2], 0.0);
    // Samples off the circle are left out of the next fit. The limit falls from a tenth of the radius to its end value.
    for round in 0..=ROUNDS {
        (centre, radius) = least_squares(x, y, &kept)?;
        let max_distance =
            radius * 0.1 * libm::pow(10.0 * MAX_DISTANCE_FRACTION, f64::from(round) / f64::from(ROUNDS));
        let is_on =
            |i: &usize| (libm::hypot(x[*i] - centre[0], y[*i] - centre[1]) - radius).abs() < max_distance;
        kept = range.clone().filter(is_on).collect();
        if 2 * kept.len() < range.len() {
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
    let angle = |i: usize| libm::atan2(y[i] - centre[1], x[i] - centre[0]);
    let swept_rad: f64 = samples
        .clone()
        .skip(1)
        .map(|i| (angle(i) - angle(i - 1) + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU)
        .sum();
    let arc = Arc { samples, is_clockwise: swept_rad < 0.0, swept_rad: swept_rad.abs() };
    (arc.swept_rad >= MIN_ARC_RAD).then(|| Circle { centre, radius, arcs: vec![arc] })
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
        find(&x, &y)
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
            assert!((arc.swept_rad - TAU).abs() < 0.1, "{arc:?}");
            assert!(arc.samples.len() < 3100, "the line in front is not part of it: {arc:?}");
        }
    }

    #[test]
    fn a_motion_that_turns_back_without_a_standstill_has_two_directions() {
        let mut path = arc([0.0, 0.0], 0.05, 0.0, TAU, 3000);
        path.extend(arc([0.0, 0.0], 0.05, TAU, 0.0, 3000).into_iter().skip(1));
        let directions: Vec<bool> = of(&path).unwrap().arcs.iter().map(|arc| arc.is_clockwise).collect();
        assert_eq!(directions, [false, true]);
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
