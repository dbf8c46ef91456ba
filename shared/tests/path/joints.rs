//! Joints: speed over a chain of short blocks, and limits where several joints are close together.

use super::*;

/// A circle of 2π·50 mm in chords of L = 0.1 mm. The speed is limited by the queue, at whose end the path must be able to
/// stop: 14 blocks, 1.4 mm, when a block starts, because this host pushes between ticks. A joint turns by u = 2 mrad. Alone
/// it could be passed at A'·T/u = 0.25 m/s; with a neighbour within a tick at the feed, W·v = L, it may use the fraction x = 1/2, with which it
/// may be passed at the feed, and takes v·u/(T·x) = 0.4 m/s² of 1 m/s². So v = √(2·0.6 m/s²·1.4 mm) = 41 mm/s.
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
        let expected = length / (2.0 * 0.6 * acceleration * 14.0 * 1e-4).sqrt();
        // With a stop after each chord, 2·√(L/A) each, the circle would take 63 s. With a jerk limit the acceleration is
        // zero at every joint, which halves the speed over short blocks.
        let max_ratio = if ramps == Ramps::Trapezoid { 1.1 } else { 2.4 };
        assert!(
            seconds > 0.9 * expected && seconds < max_ratio * expected,
            "{seconds} s, expected {expected} s"
        );
        assert!(greatest(&commands, 1000.0, 2) <= acceleration * (1.0 + 1e-6) + quantum(1000.0, 2));
    }
}

/// A line, a tangential quarter circle and a line are travelled without a stop.
#[test]
fn a_smooth_path_does_not_stop() {
    let blocks = |ramps| {
        let exact = |block: Block<2>| block.with_ramps(ramps).within(0.0);
        [
            exact(Block::line([0.05, 0.0], 0.05, 2.0)),
            exact(Block::arc([0, 1], [0.05, 0.02], 0.25, 0.05, 2.0)),
            exact(Block::line([0.07, 0.07], 0.05, 2.0)),
        ]
    };
    let commands = travel([0.0, 0.0], 4000.0, Smoothing::None, &blocks(Ramps::Trapezoid));
    let path = 0.05 + 0.02 * TAU / 4.0 + 0.05;
    let expected = path / 0.05 + 0.05 / 2.0;
    let seconds = (commands.len() - 8) as f64 / 4000.0;
    assert!((seconds - expected).abs() < 2.0 / 4000.0, "{seconds} s, expected {expected}");
    // The centripetal acceleration v²/R = 0.125 m/s² starts within a tick: 500 m/s³ at 4 kHz. With a jerk limit of
    // J = 100 m/s³ the joints are passed at a lower speed: an arc reserves J/16 for joints, of which the change of curvature
    // may use half, and half of that on each side: v² = J/64·T·R.
    let smooth = travel([0.0, 0.0], 4000.0, Smoothing::None, &blocks(Ramps::SCurve { jerk_m_per_s3: 100.0 }));
    assert!(greatest(&smooth, 4000.0, 3) <= 100.0 * (1.0 + 1e-6) + quantum(4000.0, 3));
    let slowest = smooth[200..smooth.len() - 200].windows(2).map(|w| {
        let [x, y] = [0, 1].map(|axis| (w[1][axis] - w[0][axis]) as f64 / PER_M * 4000.0);
        x.hypot(y)
    });
    let (slowest, expected) = (slowest.fold(f64::MAX, f64::min), (100.0 / 64.0 / 4000.0 * 0.02f64).sqrt());
    assert!((slowest / expected - 1.0).abs() < 0.1, "{slowest} m/s, expected {expected}");
}

/// Joints within the window of a filter, or within a tick, together keep the acceleration limit and the tolerance.
#[test]
fn joints_within_a_window_together_keep_limits_and_tolerance() {
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
        // The polygon lies outside its inscribed circle.
        let inner = radius * (TAU / f64::from(count) / 2.0).cos();
        let off = |[x, y]: &Point| (inner - (x + radius).hypot(*y)).max(0.0);
        let worst = metres(&commands).iter().map(off).fold(0.0, f64::max);
        assert!(worst <= tolerance + 1e-9, "{smoothing:?} {count}: {worst} m, tolerance {tolerance}");
    }
}

/// An exponential ramp has its greatest acceleration in its first and in its last tick. It must not coincide with that of
/// the adjacent block.
#[test]
fn exponential_ramps_do_not_add_to_the_acceleration_of_adjacent_blocks() {
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

/// A jerk limit of 1e6 and 2e5 m/s³, far above the 1 and 5 m/s³ of the acceleration limit in one tick, has no effect: the
/// acceleration limit is kept, also at joints.
#[test]
fn a_huge_jerk_limit_keeps_the_acceleration_limit() {
    let huge = |to, feed, acceleration, jerk_m_per_s3| {
        Block::line(to, feed, acceleration).with_ramps(Ramps::SCurve { jerk_m_per_s3 }).within(0.0)
    };
    let chain = [huge([0.001, 0.0], 0.1, 0.001, 1e6), huge([0.002, 0.0], 0.1, 0.001, 1e6)];
    let single = [huge([0.01, 0.0], 0.03, 0.001_26, 2e5)];
    for (blocks, rate_hz, limit) in [(&chain[..], 1000.0, 0.001), (&single, 4000.0, 0.001_26)] {
        let worst = greatest(&travel([0.0, 0.0], rate_hz, Smoothing::None, blocks), rate_hz, 2);
        assert!(worst <= limit * (1.0 + 1e-6) + quantum(rate_hz, 2), "{worst} m/s², limit {limit}");
    }
}

/// A block that runs to a stop keeps it. The next one, that is pushed then, starts as if it were alone: nothing of its acceleration is taken by
/// a joint that is not passed.
#[test]
fn a_block_behind_a_running_one_starts_from_rest() {
    let ticks = |path: &mut Path<2>| {
        let mut ticks = 0i32;
        while !path.is_done() {
            path.advance();
            ticks += 1;
        }
        ticks
    };
    let (first, second) =
        (Block::line([0.05, 0.0], 0.1, 1.0).within(1e-5), Block::line([0.05, 0.05], 0.1, 1.0));
    let alone = |block, start| {
        let mut path = Path::new(at(start), 4000.0);
        path.push(&block).unwrap();
        ticks(&mut path)
    };
    let separate = alone(first, [0.0; 2]) + alone(second, [0.05, 0.0]);
    let mut path = Path::new(at([0.0; 2]), 4000.0);
    path.push(&first).unwrap();
    for _ in 0..1000 {
        path.advance();
    }
    path.push(&second).unwrap();
    let together = 1000 + ticks(&mut path);
    assert!((together - separate).abs() <= 2, "{together}, {separate}");
}

/// In pieces of 0.5 mm, with filters of 10 ms, that the path passes in half of that: a straight line takes the time of one block, d/v + v/A and the
/// time of the filters, and a circle of chords, whose joints take a part of the acceleration from the ramps at both ends, at most that of
/// ramps with half of it.
#[test]
fn a_path_of_short_blocks_runs_at_the_feed() {
    let (feed, acceleration, radius, rate_hz, time_s) = (0.1, 2.0, 0.05, 4000.0, 0.01);
    let count = 628;
    let circumference = TAU * radius;
    let chord = |k: i32| {
        let angle = TAU * f64::from(k) / f64::from(count);
        Block::line([radius * angle.cos(), radius * angle.sin()], feed, acceleration).within(1e-5)
    };
    let piece = |k: i32| {
        Block::line([circumference * f64::from(k) / f64::from(count), 0.0], feed, acceleration).within(1e-5)
    };
    let seconds = |start, blocks: Vec<Block<2>>| {
        travel(start, rate_hz, Smoothing::Trapezoid { time_s }, &blocks).len() as f64 / rate_hz
    };
    let line = seconds([0.0; 2], (1..=count).map(piece).collect());
    let circle = seconds([radius, 0.0], (1..=count).map(chord).collect());
    let shortest = circumference / feed + feed / acceleration + time_s;
    // Eight ticks of standstill are counted, and the last digit of the acceleration of the ramps costs one more.
    assert!((line - shortest - 8.0 / rate_hz).abs() <= 2.0 / rate_hz, "{line} s, {shortest} s");
    assert!(
        (shortest..shortest + feed / acceleration + 8.0 / rate_hz).contains(&circle),
        "{circle} s, {shortest} s"
    );
}
