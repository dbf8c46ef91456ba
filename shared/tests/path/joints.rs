//! Joints: speed over many of them, and limits where several come together.

use super::*;

/// 2π·50 mm in chords of 0.1 mm. What limits is the queue: its end has to be within reach at every time. When a
/// block is begun, 14 lie behind it, for this host pushes between ticks. A joint, which turns by 2 mrad, could be
/// passed at the feed but for its neighbours: with r = W·v/L = 1 it has 2/(1 + √5) = 0.618 of a tick, passes at 62 mm/s,
/// and takes v·u/T = 0.12 m/s² twice over: v = √(2·0.8·1.4 mm) = 47 mm/s, all the way round.
#[test]
fn look_ahead_carries_speed_over_short_blocks() {
    let (radius, count, feed, acceleration) = (0.05, 3142, 0.1, 1.0);
    let point =
        |k: i32| [radius * (TAU * f64::from(k) / 3142.0).cos(), radius * (TAU * f64::from(k) / 3142.0).sin()];
    let chords = |ramps| -> Vec<_> {
        (1..=count)
            .map(|k| Block::line(point(k), feed, acceleration).with_ramps(ramps).within(1e-6))
            .collect()
    };
    let length = f64::from(count) * 2.0 * radius * (TAU / 3142.0 / 2.0).sin();
    for ramps in [Ramps::Trapezoid, Ramps::SCurve { jerk_m_per_s3: 200.0 }] {
        let commands = travel(point(0), 1000.0, Smoothing::None, &chords(ramps));
        let seconds = commands.len() as f64 / 1000.0;
        let of_queue = length / (2.0 * 0.8 * acceleration * 14.0 * 1e-4).sqrt();
        // From rest to rest in each chord it would take 2·√(L/A), 63 s in all. With a jerk limit the acceleration
        // is zero at every joint, which costs a chain of short blocks half its speed.
        let slower = if ramps == Ramps::Trapezoid { 1.1 } else { 2.4 };
        assert!(
            seconds > 0.9 * of_queue && seconds < slower * of_queue,
            "{seconds} s, expected {of_queue} s"
        );
        assert!(greatest(&commands, 1000.0, 2) <= acceleration * (1.0 + 1e-6) + quantum(1000.0, 2));
    }
}

/// A line, a quarter of a circle that leaves it smoothly, and a line again, without a stop.
#[test]
fn a_smooth_path_does_not_stop() {
    let blocks = |ramps| {
        let on = |block: Block<2>| block.with_ramps(ramps).within(0.0);
        [
            on(Block::line([0.05, 0.0], 0.05, 2.0)),
            on(Block::arc([0, 1], [0.05, 0.02], 0.25, 0.05, 2.0)),
            on(Block::line([0.07, 0.07], 0.05, 2.0)),
        ]
    };
    let commands = travel([0.0, 0.0], 4000.0, Smoothing::None, &blocks(Ramps::Trapezoid));
    let path = 0.05 + 0.02 * TAU / 4.0 + 0.05;
    let expected = path / 0.05 + 0.05 / 2.0;
    let seconds = (commands.len() - 8) as f64 / 4000.0;
    assert!((seconds - expected).abs() < 2.0 / 4000.0, "{seconds} s, expected {expected}");
    // v²/R = 0.125 m/s² begins at once: 500 m/s³ at 4 kHz. A jerk limit of J = 100 slows the joints, not to rest:
    // an arc spares J/16, half of it for the curvature, half of that for each side: v² = J/64·T·R.
    let smooth = travel([0.0, 0.0], 4000.0, Smoothing::None, &blocks(Ramps::SCurve { jerk_m_per_s3: 100.0 }));
    assert!(greatest(&smooth, 4000.0, 3) <= 100.0 * (1.0 + 1e-6) + quantum(4000.0, 3));
    let slowest = smooth[200..smooth.len() - 200].windows(2).map(|w| {
        let [x, y] = [0, 1].map(|axis| (w[1][axis] - w[0][axis]) as f64 / PER_M * 4000.0);
        x.hypot(y)
    });
    let (slowest, expected) = (slowest.fold(f64::MAX, f64::min), (100.0 / 64.0 / 4000.0 * 0.02f64).sqrt());
    assert!((slowest / expected - 1.0).abs() < 0.1, "{slowest} m/s, expected {expected}");
}

/// Joints that follow each other within the window of a filter, or within a tick, share what one may take.
#[test]
fn corners_that_come_together_keep_limits_and_tolerance_together() {
    let polygon = |count: u32, radius: f64, feed, acceleration, tolerance: f64, ramps| -> Vec<Block<2>> {
        let angle = move |k: u32| TAU * f64::from(k) / f64::from(count);
        let to = move |k: u32| [radius * (angle(k).cos() - 1.0), radius * angle(k).sin()];
        (1..=3 * count)
            .map(|k| Block::line(to(k), feed, acceleration).with_ramps(ramps).within(tolerance))
            .collect()
    };
    let trapezoid = Smoothing::Trapezoid { time_s: 0.05 };
    let exponential = Smoothing::Exponential { time_constant_s: 0.02 };
    let s_curve = Smoothing::SCurve { time_s: 0.05, jerk_time_s: 0.02 };
    for (smoothing, ramps, count, radius, feed, tolerance, rate_hz) in [
        (trapezoid, Ramps::Trapezoid, 20, 2.5e-3, 0.5, 1e-3, 4000.0),
        (trapezoid, Ramps::Trapezoid, 40, 2.5e-3, 0.5, 50e-6, 4000.0),
        (exponential, Ramps::Trapezoid, 20, 2.5e-3, 0.5, 1e-3, 4000.0),
        (s_curve, Ramps::Trapezoid, 20, 2.5e-3, 0.5, 1e-3, 4000.0),
        (trapezoid, Ramps::AfterInterpolation, 20, 2.5e-3, 0.5, 1e-3, 4000.0),
        (trapezoid, Ramps::Trapezoid, 100, 5e-3, 0.1, 20e-6, 4000.0),
        (Smoothing::None, Ramps::Trapezoid, 20, 0.32e-6, 0.5, 0.0, 1000.0),
        (Smoothing::None, Ramps::Trapezoid, 40, 1e-6, 0.5, 0.0, 1000.0),
    ] {
        let blocks = polygon(count, radius, feed, 1.0, tolerance, ramps);
        let commands = travel([0.0, 0.0], rate_hz, smoothing, &blocks);
        let worst = greatest(&commands, rate_hz, 2);
        assert!(worst <= 1.0 + 1e-6 + quantum(rate_hz, 2) + 0.002, "{smoothing:?} {count}: {worst} m/s²");
        // The polygon lies between the circle and the circle of its sides' middles.
        let inner = radius * (TAU / f64::from(count) / 2.0).cos();
        let off = |[x, y]: &Point| (inner - (x + radius).hypot(*y)).max(0.0);
        let worst = metres(&commands).iter().map(off).fold(0.0, f64::max);
        assert!(worst <= tolerance + 1e-9, "{smoothing:?} {count}: {worst} m of {tolerance}");
    }
}

/// The first step of an exponential ramp is its greatest acceleration, and so is the last step's: between blocks there
/// has to be room for both.
#[test]
fn exponential_ramps_do_not_add_to_their_neighbours() {
    let back_and_forth = |first, second| {
        let there = Block::line([0.01, 0.0], 0.1, 1.0).with_ramps(first);
        travel(
            [0.0, 0.0],
            1000.0,
            Smoothing::None,
            &[there, Block::line([0.0, 0.0], 0.1, 1.0).with_ramps(second)],
        )
    };
    for first in [Ramps::Exponential, Ramps::Trapezoid] {
        for second in [Ramps::Exponential, Ramps::Trapezoid] {
            let worst = greatest(&back_and_forth(first, second), 1000.0, 2);
            assert!(
                (0.9..=1.0 + 1e-6 + quantum(1000.0, 2)).contains(&worst),
                "{first:?} {second:?}: {worst}"
            );
        }
    }
}

/// A jerk that is as good as none leaves the acceleration what it is, at joints, too.
#[test]
fn a_huge_jerk_keeps_the_acceleration() {
    let huge = |to, feed, acceleration, jerk_m_per_s3| {
        Block::line(to, feed, acceleration).with_ramps(Ramps::SCurve { jerk_m_per_s3 }).within(0.0)
    };
    let chain = [huge([0.001, 0.0], 0.1, 0.001, 1e6), huge([0.002, 0.0], 0.1, 0.001, 1e6)];
    let single = [huge([0.01, 0.0], 0.03, 0.001_26, 2e5)];
    for (blocks, rate_hz, limit) in [(&chain[..], 1000.0, 0.001), (&single, 4000.0, 0.001_26)] {
        let worst = greatest(&travel([0.0, 0.0], rate_hz, Smoothing::None, blocks), rate_hz, 2);
        assert!(worst <= limit * (1.0 + 1e-6) + quantum(rate_hz, 2), "{worst} of {limit}");
    }
}
