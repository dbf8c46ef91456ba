//! A bump in the mean residual over the position.

use nalgebra::{Matrix3, Vector3};

use super::binned_mean::BinnedMean;
use crate::fit::exclusion::Bump;

/// Largest standard deviation of a bump, as a fraction of the travel.
const MAX_WIDTH: f64 = 0.2;

/// Steps of the search for centre and width.
const STEPS: usize = 24;

/// The least-squares bump on a straight line through the mean residual over the position; `None` if it explains less than
/// `min_fraction` of what is left beside the line alone.
#[must_use]
pub fn fitted_bump(mean: &BinnedMean, min_fraction: f64) -> Option<Bump> {
    let points = &mean.points;
    let (first, last) = (points.first()?.0, points.last()?.0);
    let travel_mm = last - first;
    if points.len() < 16 || travel_mm <= 0.0 {
        return None;
    }
    let narrowest_mm = travel_mm / points.len() as f64;
    let (mut centres, mut widths) = ([first, last], [narrowest_mm, MAX_WIDTH * travel_mm]);
    let mut best: Option<(f64, Bump)> = None;
    // Each pass searches between the neighbours of the best of the one before.
    for _ in 0..3 {
        let [centre_step, width_step] = [centres, widths].map(|[from, to]| (to - from) / STEPS as f64);
        for centre in 0..=STEPS {
            for width in 0..=STEPS {
                let bump = Bump {
                    centre_mm: centre_step.mul_add(centre as f64, centres[0]),
                    width_mm: width_step.mul_add(width as f64, widths[0]),
                };
                let Some(left) = left_beside(points, Some(bump)) else { continue };
                if best.is_none_or(|(least, _)| left < least) {
                    best = Some((left, bump));
                }
            }
        }
        let (_, Bump { centre_mm, width_mm }) = best?;
        centres = [centre_mm - centre_step, centre_mm + centre_step];
        widths = [(width_mm - width_step).max(narrowest_mm), width_mm + width_step];
    }
    let (left, bump) = best?;
    let is_within = bump.width_mm < MAX_WIDTH * travel_mm && (first..=last).contains(&bump.centre_mm);
    (is_within && left <= (1.0 - min_fraction) * left_beside(points, None)?).then_some(bump)
}

/// The sum of squares that a straight line, and a bump, leave of the points.
fn left_beside(points: &[(f64, f64)], bump: Option<Bump>) -> Option<f64> {
    let (first, last) = (points.first()?.0, points.last()?.0);
    // Without a bump, its column and row are those of a unit matrix.
    let columns =
        |x: f64| Vector3::new(1.0, (x - first) / (last - first) - 0.5, bump.map_or(0.0, |b| b.at(x)));
    let mut normal = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for &(x, y) in points {
        let row = columns(x);
        normal += row * row.transpose();
        right += row * y;
    }
    if bump.is_none() {
        normal[(2, 2)] = 1.0;
    }
    let solution = normal.cholesky()?.solve(&right);
    Some(points.iter().map(|&(x, y)| (y - columns(x).dot(&solution)).powi(2)).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn mean(value: impl Fn(f64) -> f64) -> BinnedMean {
        let points = (0..64).map(|i| 2.0 * f64::from(i) - 63.0).map(|mm| (mm, value(mm))).collect();
        BinnedMean { points, fraction: 1.0, centre: 0.0 }
    }

    /// A bump on a slope, with the noise of a few nm, is found within a hundredth of a bin.
    #[test]
    fn a_bump_on_a_slope_is_found() {
        let noise = |mm: f64| 3e-3 * (mm * 12.9898).sin();
        for [centre_mm, width_mm] in [[17.6, 12.5], [-27.9, 3.0], [0.0, 8.0]] {
            let bump = Bump { centre_mm, width_mm };
            let found = fitted_bump(&mean(|mm| 0.02 * mm - 3.0 * bump.at(mm) + noise(mm)), 0.97).unwrap();
            assert!((found.centre_mm - centre_mm).abs() < 0.2, "{found:?}");
            assert!((found.width_mm - width_mm).abs() < 0.2, "{found:?}");
        }
    }

    /// Waves of the screw over the travel of 126 mm, those of the self-test's pitch shapes, are no bump: one lobe of several.
    #[test]
    fn waves_are_no_bump() {
        for phase in 0..8 {
            let phase = TAU * f64::from(phase) / 8.0;
            let shape = |mm: f64| {
                let wave = |period_mm: f64, turn: f64| (TAU * mm / period_mm + turn).sin();
                2.0 * wave(60.0, phase) + 1.5 * wave(100.0, 2.0 * phase) + wave(180.0, 3.0 * phase)
            };
            assert_eq!(fitted_bump(&mean(shape), 0.9), None, "{phase}");
        }
        assert_eq!(fitted_bump(&mean(|mm| 0.1 * mm), 0.9), None, "a slope");
    }
}
