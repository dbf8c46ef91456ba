//! The size of a step of a signal that moves.

use std::ops::Range;

use super::channels::references;
use super::findings::ChannelLocation;

/// Numbers of samples on each side, and degrees of the polynomials through them: many samples if the difference of the
/// channels is smooth, few if it is not.
const FITS: [(usize, usize); 9] =
    [(8, 1), (16, 1), (16, 2), (32, 1), (32, 2), (64, 2), (64, 3), (128, 3), (256, 3)];
/// Smallest number of samples on each side.
const MIN_FIT: usize = 8;
/// Largest difference between two results, in standard errors of the one with fewer samples, if both describe the signal.
const MAX_DIFFERENCE: f64 = 1.5;

/// A step.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Size, in the unit of the signal.
    pub size: f64,
    /// Standard deviation about the polynomials on both sides.
    pub scatter: f64,
    /// Standard error of the size.
    error: f64,
}

/// Least-squares polynomial through values at 0, 1, …: its value at `at`, and the sum of squared deviations.
fn polynomial(values: &[f64], degree: usize, at: f64) -> (f64, f64) {
    let half = 0.5 * (values.len() as f64 - 1.0);
    let power = |t: f64, degree: usize| (0..degree).map(|_| t).product::<f64>();
    let scaled = |i: usize| (i as f64 - half) / half;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Gram-Schmidt: orthogonal polynomials over the samples, each with its value at `at`.
    let mut basis: Vec<(Vec<f64>, f64)> = Vec::new();
    let mut deviations = values.to_vec();
    let mut value = 0.0;
    for degree in 0..=degree {
        let mut next: Vec<f64> = (0..values.len()).map(|i| power(scaled(i), degree)).collect();
        let mut next_at = power((at - half) / half, degree);
        for (other, other_at) in &basis {
            let share = product(&next, other) / product(other, other);
            next.iter_mut().zip(other).for_each(|(next, other)| *next -= share * other);
            next_at -= share * other_at;
        }
        let coefficient = product(&deviations, &next) / product(&next, &next);
        deviations.iter_mut().zip(&next).for_each(|(deviation, next)| *deviation -= coefficient * next);
        value += coefficient * next_at;
        basis.push((next, next_at));
    }
    (value, product(&deviations, &deviations))
}

/// The step of a signal across samples that are displaced otherwise, from polynomials through `fit` samples on both sides
/// within `limits`; `None` if there are too few.
fn step(
    signal: impl Fn(usize) -> f64,
    across: &Range<usize>,
    limits: &Range<usize>,
    (fit, degree): (usize, usize),
) -> Option<Step> {
    let before = across.start.saturating_sub(fit).max(limits.start)..across.start;
    let after = across.end..(across.end + fit).min(limits.end);
    let least = if degree > 1 { fit } else { MIN_FIT };
    if before.len() < least || after.len() < least {
        return None;
    }
    let [before, after] = [before, after].map(|range| range.map(&signal).collect::<Vec<f64>>());
    // Both polynomials are continued to the middle between them.
    let half_gap = 0.5 * (across.len() + 1) as f64;
    let (first, first_squares) = polynomial(&before, degree, before.len() as f64 - 1.0 + half_gap);
    let (second, second_squares) = polynomial(&after, degree, -half_gap);
    let count = (before.len() + after.len()) as f64;
    let variance = (first_squares + second_squares) / (count - 2.0 * (degree as f64 + 1.0));
    // At the end of a polynomial of degree p through n points the variance is (p + 1)²/n of theirs.
    let parts = 1.0 / before.len() as f64 + 1.0 / after.len() as f64;
    let error = (degree as f64 + 1.0) * (variance * parts).sqrt();
    Some(Step { size: second - first, scatter: variance.sqrt(), error })
}

/// The most accurate one of several results, from few to many samples, among those that agree with all accepted before them
/// (Lepski, 1990): long polynomials have little variance, but do not describe a signal that bends.
fn agreed(steps: impl Iterator<Item = Step>) -> Option<Step> {
    let mut accepted: Vec<Step> = Vec::new();
    for step in steps {
        let agrees = |other: &Step| (step.size - other.size).abs() <= MAX_DIFFERENCE * other.error;
        if accepted.iter().all(agrees) {
            accepted.push(step);
        }
    }
    accepted.into_iter().min_by(|a, b| a.error.total_cmp(&b.error))
}

/// The step of a channel across samples, relative to the other channel that moves most like it there, or by itself if there is
/// no other one.
#[must_use]
pub fn best_step(
    values: &[f64],
    place: &ChannelLocation<'_>,
    across: &Range<usize>,
    limits: &Range<usize>,
) -> Option<Step> {
    let to = |reference: Option<&[f64]>, fit| {
        step(|i| values[i] - reference.map_or(0.0, |reference| reference[i]), across, limits, fit)
    };
    let others = references(place.axis(), place.channel).filter_map(|(_, other)| {
        let shortest = to(Some(other), FITS[0])?;
        Some((other, shortest.scatter))
    });
    let reference = others.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(other, _)| other);
    agreed(FITS.into_iter().filter_map(|fit| to(reference, fit)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_continued_exactly() {
        let at = |t: f64| 3.0 - 0.2 * t + 0.01 * t * t - 1e-4 * t * t * t;
        let values: Vec<f64> = (0..40).map(|i| at(f64::from(i))).collect();
        for outside in [-0.5, 39.5] {
            let (value, squares) = polynomial(&values, 3, outside);
            assert!((value - at(outside)).abs() < 1e-9 && squares < 1e-15, "{value} {squares}");
        }
    }

    /// A signal that bends 20 samples before and after the step: lines beyond the bend are rejected.
    #[test]
    fn the_step_of_a_bent_signal_is_that_of_short_lines() {
        let noise = |i: usize| 1e-3 * ((i as f64 * 12.9898).sin() * 43_758.545).fract();
        let signal = |i: usize| {
            let bend = if i < 980 { 0.0 } else { 0.02 * (i as f64 - 980.0).min(40.0) };
            bend + noise(i) + if i < 1000 { 0.0 } else { 0.5 }
        };
        let steps: Vec<Step> =
            FITS.iter().filter_map(|&fit| step(signal, &(1000..1000), &(0..2000), fit)).collect();
        assert_eq!(steps.len(), FITS.len());
        let found = agreed(steps.into_iter()).unwrap();
        // Uniform noise within ±1e-3 has a standard deviation of 0.6e-3; at lines through 16 points, 2·√(2/16) of it.
        assert!((found.size - 0.5).abs() < 3.0 * 0.41e-3, "{found:?}");
    }
}
