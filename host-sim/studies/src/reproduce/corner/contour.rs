//! Contours at the corner: overshoot, rounding, and distance between two contours; and the radius of a circle.
//!
//! Coordinates along the two lines: `u` along the first line, positive beyond the corner, and `w` along the second. The
//! command has u ≤ 0 before the corner and u = 0 after it.

use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::Range;

use super::machine::{Track, corner_m};

/// Half width of the evaluated window about the time at which the command is in the corner, s. It ends 33 1/s · 0.3 s = 10
/// time constants after the corner, when the transient of the slowest loop has decayed.
const HALF_WINDOW_S: f64 = 0.3;

/// Maximum time difference of points of two contours that are compared, s.
const MAX_TIME_DIFFERENCE_S: f64 = 0.02;

/// Samples around the time at which the command is in the corner, where Y has its maximum.
#[must_use]
pub fn window(command: &Track, sample_s: f64) -> Range<usize> {
    let corner = command.y_m.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(k, _)| k);
    let half = samples(HALF_WINDOW_S, sample_s);
    corner.saturating_sub(half)..(corner + half).min(command.y_m.len())
}

/// Overshoot, m: maximum `u` relative to the steady `u` on the second line. The latter is not zero if the axes lag
/// differently; it is the mean over the last tenth of the window.
#[must_use]
pub fn overshoot_m(track: &Track, window: &Range<usize>) -> f64 {
    let beyond: Vec<f64> = along(track, window).map(|[u, _]| u).collect();
    let last = &beyond[beyond.len() - beyond.len() / 10..];
    let steady = numerics::mean(last.iter().copied());
    numerics::max(beyond.iter().copied()) - steady
}

/// Rounding, m: minimum distance from the corner.
#[must_use]
pub fn rounding_m(track: &Track, window: &Range<usize>) -> f64 {
    numerics::min(along(track, window).map(|[u, w]| libm::hypot(u, w)))
}

/// Maximum distance of the points of one contour from another contour, m.
#[must_use]
pub fn difference_m(one: &Track, other: &Track, window: &Range<usize>, sample_s: f64) -> f64 {
    let (one, other): (Vec<_>, Vec<_>) = (one.points().collect(), other.points().collect());
    let reach = samples(MAX_TIME_DIFFERENCE_S, sample_s);
    numerics::max_abs(window.clone().map(|k| {
        let near = k.saturating_sub(reach)..(k + reach).min(other.len());
        numerics::min(other[near].windows(2).map(|ends| to_segment_m(one[k], ends[0], ends[1])))
    }))
}

/// Radius of the fundamental of a circular track, m: magnitude of its mean complex ratio to the unit vector from the
/// centre to the command, over the samples of `window`, which must be whole turns.
#[must_use]
pub fn radius_m(track: &Track, command: &Track, centre_m: [f64; 2], window: &Range<usize>) -> f64 {
    let (mut real, mut imaginary) = (0.0, 0.0);
    let pairs = track.points().zip(command.points()).skip(window.start).take(window.len());
    for (point, commanded) in pairs {
        let [x, y] = [point[0] - centre_m[0], point[1] - centre_m[1]];
        let [u, v] = [commanded[0] - centre_m[0], commanded[1] - centre_m[1]];
        let length = libm::hypot(u, v);
        real += (x * u + y * v) / length;
        imaginary += (y * u - x * v) / length;
    }
    libm::hypot(real, imaginary) / window.len() as f64
}

/// Points of a window in `u` and `w`, m.
fn along<'a>(track: &'a Track, window: &Range<usize>) -> impl Iterator<Item = [f64; 2]> + 'a {
    let [cx, cy] = corner_m();
    track
        .points()
        .skip(window.start)
        .take(window.len())
        .map(move |[x, y]| [(x - cx + y - cy) * FRAC_1_SQRT_2, (x - cx - y + cy) * FRAC_1_SQRT_2])
}

/// Distance of a point from a line segment, m.
fn to_segment_m(point: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let segment = [to[0] - from[0], to[1] - from[1]];
    let offset = [point[0] - from[0], point[1] - from[1]];
    let square = segment[0].powi(2) + segment[1].powi(2);
    let fraction = if square > 0.0 {
        ((offset[0] * segment[0] + offset[1] * segment[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    libm::hypot(offset[0] - fraction * segment[0], offset[1] - fraction * segment[1])
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred samples")]
fn samples(time_s: f64, sample_s: f64) -> usize {
    (time_s / sample_s).round() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(points: impl Iterator<Item = [f64; 2]>) -> Track {
        let (x_m, y_m) = points.map(|[x, y]| (x, y)).unzip();
        Track { x_m, y_m }
    }

    /// 10 mm to the corner, overshooting by `beyond_um`, then 10 mm along the second line in steps of 10 µm, the second
    /// half of it at u = `end_um`.
    fn corner_track(beyond_um: f64, end_um: f64) -> Track {
        let [cx, cy] = corner_m();
        let at = move |u: f64, w: f64| [cx + (u + w) * FRAC_1_SQRT_2, cy + (u - w) * FRAC_1_SQRT_2];
        let (beyond, end) = (1e-6 * beyond_um, 1e-6 * end_um);
        let up = (-1000..=0).map(move |k| at(1e-5 * f64::from(k) + beyond, 0.0));
        track(up.chain((1..=1000).map(move |k| at(if k < 500 { beyond } else { end }, 1e-5 * f64::from(k)))))
    }

    #[test]
    fn overshoot_and_rounding_are_found() {
        for um in [-30.0_f64, 0.0, 20.0] {
            let (track, window) = (corner_track(um, um), 0..2001);
            // A track that overshoots passes through the corner; one that falls short does not.
            assert!((1e6 * rounding_m(&track, &window) - um.min(0.0).abs()).abs() < 1e-3);
            // On the second line the distance is `um`; on the first it is 0.
            let distance = 1e6 * difference_m(&track, &corner_track(0.0, 0.0), &window, 1e-4);
            assert!((distance - um.abs()).abs() < 1e-3, "{um}: {distance}");
            // Relative to a steady 5 µm at the end of the window.
            let overshoot = 1e6 * overshoot_m(&corner_track(um, 5.0), &window);
            assert!((overshoot - (um - 5.0).max(0.0)).abs() < 1e-3, "{um}: {overshoot}");
        }
    }

    /// A circle of 9.99 mm with a lag of 0.1 rad and an offset of 5 µm, which whole turns cancel.
    #[test]
    fn the_radius_is_independent_of_lag_and_offset() {
        let circle = |r: f64, lag: f64, offset: f64| {
            let at = move |k: i32| {
                let angle = std::f64::consts::TAU * f64::from(k) / 500.0 - lag;
                [offset + r * angle.cos(), r * angle.sin()]
            };
            track((0..1000).map(at))
        };
        let found = radius_m(&circle(9.99e-3, 0.1, 5e-6), &circle(1e-2, 0.0, 0.0), [0.0, 0.0], &(0..1000));
        assert!((found - 9.99e-3).abs() < 1e-9, "{found}");
    }
}
