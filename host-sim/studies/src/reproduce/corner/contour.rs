//! Contours at the corner: how far one overshoots, rounds, and differs from another; and the radius of a circle.
//!
//! Along the two lines the plane has axes of its own: `u` along the first line, out of the corner, and `w` along
//! the second. The command has u ≤ 0 before the corner and u = 0 behind it.

use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::Range;

use super::machine::{Track, corner_m};

/// Either side of the moment at which the command stands in the corner: at its end, 33 1/s · 0.3 s = 10 time
/// constants behind it, even the slowest loop has forgotten the corner.
const WINDOW_S: f64 = 0.3;

/// Of two contours, points are compared that are no further apart in time; the path crosses itself nowhere within.
const APART_S: f64 = 0.02;

/// Samples around the moment at which the command is in the corner.
#[must_use]
pub fn window(command: &Track, sample_s: f64) -> Range<usize> {
    let top = command.y_m.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(k, _)| k);
    let half = samples(WINDOW_S, sample_s);
    top.saturating_sub(half)..(top + half).min(command.y_m.len())
}

/// Greatest way beyond the corner along the first line, m: what stands out over the second line as it is
/// travelled once the corner is forgotten, for axes of unequal lag travel beside it.
#[must_use]
pub fn overshoot_m(track: &Track, window: &Range<usize>) -> f64 {
    let beyond: Vec<f64> = along(track, window).map(|[u, _]| u).collect();
    let last = &beyond[beyond.len() - beyond.len() / 10..];
    let steady = numerics::mean(last.iter().copied());
    numerics::max(beyond.iter().copied()) - steady
}

/// Least distance from the corner, m: what it is rounded by.
#[must_use]
pub fn rounding_m(track: &Track, window: &Range<usize>) -> f64 {
    numerics::min(along(track, window).map(|[u, w]| u.hypot(w)))
}

/// Greatest distance of a contour's points from another contour, m.
#[must_use]
pub fn difference_m(one: &Track, other: &Track, window: &Range<usize>, sample_s: f64) -> f64 {
    let (one, other): (Vec<_>, Vec<_>) = (one.points().collect(), other.points().collect());
    let apart = samples(APART_S, sample_s);
    numerics::max_abs(window.clone().map(|k| {
        let near = k.saturating_sub(apart)..(k + apart).min(other.len());
        numerics::min(other[near].windows(2).map(|ends| to_segment_m(one[k], ends[0], ends[1])))
    }))
}

/// Radius of the turning part of a track that turns with its command, m: its projection on the command's own
/// direction from the centre, over the samples of `window`, which has to be whole turns.
#[must_use]
pub fn radius_m(track: &Track, command: &Track, centre_m: [f64; 2], window: &Range<usize>) -> f64 {
    let (mut real, mut imaginary) = (0.0, 0.0);
    let pairs = track.points().zip(command.points()).skip(window.start).take(window.len());
    for (point, asked) in pairs {
        let [x, y] = [point[0] - centre_m[0], point[1] - centre_m[1]];
        let [u, v] = [asked[0] - centre_m[0], asked[1] - centre_m[1]];
        let length = u.hypot(v);
        real += (x * u + y * v) / length;
        imaginary += (y * u - x * v) / length;
    }
    real.hypot(imaginary) / window.len() as f64
}

/// Points of a window in u and w.
fn along<'a>(track: &'a Track, window: &Range<usize>) -> impl Iterator<Item = [f64; 2]> + 'a {
    let [cx, cy] = corner_m();
    track
        .points()
        .skip(window.start)
        .take(window.len())
        .map(move |[x, y]| [(x - cx + y - cy) * FRAC_1_SQRT_2, (x - cx - y + cy) * FRAC_1_SQRT_2])
}

fn to_segment_m(point: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let way = [to[0] - from[0], to[1] - from[1]];
    let off = [point[0] - from[0], point[1] - from[1]];
    let square = way[0].powi(2) + way[1].powi(2);
    let share =
        if square > 0.0 { ((off[0] * way[0] + off[1] * way[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (off[0] - share * way[0]).hypot(off[1] - share * way[1])
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

    /// 10 mm to the corner, `beyond` further, and 10 mm down from there in steps of 10 µm, the second half of it
    /// at `end` beyond the corner.
    fn turned(beyond_um: f64, end_um: f64) -> Track {
        let [cx, cy] = corner_m();
        let at = move |u: f64, w: f64| [cx + (u + w) * FRAC_1_SQRT_2, cy + (u - w) * FRAC_1_SQRT_2];
        let (beyond, end) = (1e-6 * beyond_um, 1e-6 * end_um);
        let up = (-1000..=0).map(move |k| at(1e-5 * f64::from(k) + beyond, 0.0));
        track(up.chain((1..=1000).map(move |k| at(if k < 500 { beyond } else { end }, 1e-5 * f64::from(k)))))
    }

    #[test]
    fn what_stands_out_over_the_corner_is_found() {
        for um in [-30.0_f64, 0.0, 20.0] {
            let (way, whole) = (turned(um, um), 0..2001);
            // What overshoots has passed the corner itself, what falls short has not.
            assert!((1e6 * rounding_m(&way, &whole) - um.min(0.0).abs()).abs() < 1e-3);
            // The second leg is that far from the second line; the first lies on the first.
            let apart = 1e6 * difference_m(&way, &turned(0.0, 0.0), &whole, 1e-4);
            assert!((apart - um.abs()).abs() < 1e-3, "{um}: {apart}");
            // Back from there to 5 µm beside the line, where the last tenth is travelled.
            let overshoot = 1e6 * overshoot_m(&turned(um, 5.0), &whole);
            assert!((overshoot - (um - 5.0).max(0.0)).abs() < 1e-3, "{um}: {overshoot}");
        }
    }

    /// A circle of 9.99 mm that lags by 0.1 rad, off centre by 5 µm: whole turns take the offset out.
    #[test]
    fn a_radius_is_found_behind_lag_and_offset() {
        let round = |r: f64, lag: f64, off: f64| {
            let at = move |k: i32| {
                let angle = std::f64::consts::TAU * f64::from(k) / 500.0 - lag;
                [off + r * angle.cos(), r * angle.sin()]
            };
            track((0..1000).map(at))
        };
        let found = radius_m(&round(9.99e-3, 0.1, 5e-6), &round(1e-2, 0.0, 0.0), [0.0, 0.0], &(0..1000));
        assert!((found - 9.99e-3).abs() < 1e-9, "{found}");
    }
}
