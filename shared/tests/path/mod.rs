//! Accuracy and limits of a path: every command against geometry in f64, whose 53 bits resolve 0.4 fm at 2 m.

mod filters;
mod holds;
mod joints;
mod overrides;
mod stops;

use std::f64::consts::{E, TAU};

use proptest::prelude::*;
use shared::interpolate::feed_hold::FeedState;
use shared::interpolate::{Block, Path, Ramps, Smoothing};
use shared::units::{PER_M, Position};

type Point = [f64; 2];

fn at(point: Point) -> [Position; 2] {
    point.map(|m| Position::from_m(m).unwrap())
}

/// All commands, with four ticks of standstill before and after them.
fn travel(start: Point, rate_hz: f64, smoothing: Smoothing, blocks: &[Block<2>]) -> Vec<[Position; 2]> {
    let mut path = Path::new(at(start), rate_hz);
    path.smooth(&[smoothing; 2]).unwrap();
    let mut blocks = blocks.iter();
    let mut next = blocks.next();
    let mut commands = vec![path.command(); 4];
    loop {
        while let Some(block) = next
            && path.has_room()
        {
            path.push(block).unwrap();
            next = blocks.next();
        }
        if path.is_done() {
            commands.extend([path.command(); 4]);
            return commands;
        }
        commands.push(path.advance());
        assert!(commands.len() < 5_000_000, "no end");
    }
}

fn metres(commands: &[[Position; 2]]) -> Vec<Point> {
    commands.iter().map(|point| point.map(Position::to_m)).collect()
}

/// Greatest magnitude of the n-th difference of the commands over the n-th power of a tick, SI.
fn greatest(commands: &[[Position; 2]], rate_hz: f64, order: u32) -> f64 {
    let mut rows: Vec<[i64; 2]> = commands.iter().map(|point| point.map(|position| position.0)).collect();
    for _ in 0..order {
        rows = rows.windows(2).map(|w| [w[1][0] - w[0][0], w[1][1] - w[0][1]]).collect();
    }
    let most = rows.iter().map(|[x, y]| (*x as f64).hypot(*y as f64)).fold(0.0, f64::max);
    most / PER_M * rate_hz.powi(order.cast_signed())
}

/// Greatest effect of rounding both axes to position units on the n-th difference: 2ⁿ half units each.
fn quantum(rate_hz: f64, order: u32) -> f64 {
    f64::from(1 << order) * 0.5 * 2f64.sqrt() / PER_M * rate_hz.powi(order.cast_signed())
}

fn distance_to_line([x, y]: Point, [ax, ay]: Point, [bx, by]: Point) -> f64 {
    let (dx, dy) = (bx - ax, by - ay);
    let along = (((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    (x - ax - along * dx).hypot(y - ay - along * dy)
}

fn ramps() -> impl Strategy<Value = Ramps> {
    prop_oneof![
        Just(Ramps::Trapezoid),
        Just(Ramps::Exponential),
        (20.0..5000.0f64).prop_map(|jerk_m_per_s3| Ramps::SCurve { jerk_m_per_s3 }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 48 }))]

    /// A circle of up to 1 m radius within ±2 m: every command is within 0.5 nm of the circle, the circle closes exactly,
    /// and feed, acceleration and jerk (magnitude of the vector) are within their limits at every tick, to 1e-6 and the
    /// rounding to position units.
    #[test]
    fn a_circle_is_exact_and_keeps_its_limits(
        centre in [-1.0..1.0f64, -1.0..1.0], radius in 1e-3..1.0f64, angle in 0.0..TAU, ramps in ramps(),
        turns in prop::sample::select(vec![1.0, -1.0, 2.0]), feed in 0.05..1.0f64, acceleration in 0.5..20.0f64,
    ) {
        let rate = 4000.0;
        prop_assume!(TAU * radius / feed < 20.0);
        let start = [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()];
        let block = Block::arc([0, 1], centre, turns, feed, acceleration).with_ramps(ramps);
        let commands = travel(start, rate, Smoothing::None, &[block]);
        prop_assert_eq!(commands.last(), commands.first(), "not closed");
        // The circle passes through the start, which is rounded to position units.
        let radius_of = |[x, y]: Point| (x - Position::from_m(centre[0]).unwrap().to_m()).hypot(y - Position::from_m(centre[1]).unwrap().to_m());
        let points = metres(&commands);
        let exact = radius_of(points[0]);
        let worst = points.iter().map(|&point| (radius_of(point) - exact).abs()).fold(0.0, f64::max);
        prop_assert!(worst < 0.5e-9, "{worst:e} m from the circle");
        let kept = |limit: f64, order| greatest(&commands, rate, order) <= limit * (1.0 + 1e-6) + quantum(rate, order);
        prop_assert!(kept(feed, 1));
        prop_assert!(kept(acceleration, 2), "{} m/s², limit {acceleration}", greatest(&commands, rate, 2));
        if let Ramps::SCurve { jerk_m_per_s3 } = ramps {
            prop_assert!(kept(jerk_m_per_s3, 3), "{} m/s³, limit {jerk_m_per_s3}", greatest(&commands, rate, 3));
        }
    }

    /// Any chain of lines with any corner tolerance: without axis filters every command is within 0.5 nm of the lines, all
    /// limits are kept, and the last command is exactly the programmed end point.
    #[test]
    fn a_chain_of_lines_is_exact_and_keeps_its_limits(
        points in prop::collection::vec([-2.0..2.0f64, -2.0..2.0], 2..6), step in 1e-4..1e-1f64,
        jerk in prop::option::of(50.0..5000.0f64), tolerance in 0.0..1e-4f64,
        feed in 0.05..1.0f64, acceleration in 1.0..20.0f64,
    ) {
        let rate = 2000.0;
        // Short lines around a random point of the travel.
        let corners: Vec<Point> = points.iter().enumerate().map(|(k, [x, y])| {
            let near = if k == 0 { 0.0 } else { step };
            [points[0][0] + (x - points[0][0]) * near, points[0][1] + (y - points[0][1]) * near]
        }).collect();
        prop_assume!(corners.windows(2).all(|w| (w[0][0] - w[1][0]).hypot(w[0][1] - w[1][1]) > 1e-9));
        let ramps = jerk.map_or(Ramps::Trapezoid, |jerk_m_per_s3| Ramps::SCurve { jerk_m_per_s3 });
        let blocks: Vec<_> = corners[1..].iter()
            .map(|&to| Block::line(to, feed, acceleration).with_ramps(ramps).within(tolerance)).collect();
        let commands = travel(corners[0], rate, Smoothing::None, &blocks);
        prop_assert_eq!(*commands.last().unwrap(), at(*corners.last().unwrap()));
        let worst = metres(&commands).iter().map(|&point| {
            corners.windows(2).map(|w| distance_to_line(point, w[0], w[1])).fold(f64::MAX, f64::min)
        }).fold(0.0, f64::max);
        prop_assert!(worst < 0.5e-9, "{worst:e} m from the lines");
        let kept = |limit: f64, order| greatest(&commands, rate, order) <= limit * (1.0 + 1e-6) + quantum(rate, order);
        prop_assert!(kept(feed, 1), "{} m/s, limit {feed}", greatest(&commands, rate, 1));
        prop_assert!(kept(acceleration, 2), "{} m/s², limit {acceleration}", greatest(&commands, rate, 2));
        if let Some(jerk) = jerk {
            prop_assert!(kept(jerk, 3), "{} m/s³, limit {jerk}", greatest(&commands, rate, 3));
        }
    }

    /// With axis filters a corner is passed at speed and rounded by at most the tolerance. Where the tolerance limits the
    /// speed, the corner is rounded by at least a third of it. This holds for a tolerance above twice the deviation of the
    /// adjacent ramps at v = 0 (u·A·T²/48; lag: u·A·τ²/e), and below the deviation at the speed that half the acceleration,
    /// which is reserved for the joint, allows (½A·T·T/8; lag: ½A·τ·τ/e).
    #[test]
    fn a_corner_is_rounded_within_its_tolerance(
        angle in 0.1..3.0f64, tolerance in 1e-6..100e-6f64, which in 0..3usize, s_curve in any::<bool>(),
    ) {
        let (rate, acceleration) = (4000.0, 1.0);
        let smoothing = [
            Smoothing::Trapezoid { time_s: 0.04 },
            Smoothing::SCurve { time_s: 0.03, jerk_time_s: 0.01 },
            Smoothing::Exponential { time_constant_s: 0.02 },
        ][which];
        let ramps = if s_curve { Ramps::SCurve { jerk_m_per_s3: 1e5 } } else { Ramps::Trapezoid };
        let corners = [[0.0, 0.0], [0.05, 0.0], [0.05 + 0.05 * angle.cos(), 0.05 * angle.sin()]];
        let blocks = corners[1..].iter().map(|&to| Block::line(to, 0.5, acceleration).with_ramps(ramps).within(tolerance));
        let commands = travel(corners[0], rate, smoothing, &blocks.collect::<Vec<_>>());
        prop_assert_eq!(*commands.last().unwrap(), at(corners[2]));
        let worst = metres(&commands).iter()
            .map(|&point| distance_to_line(point, corners[0], corners[1]).min(distance_to_line(point, corners[1], corners[2])))
            .fold(0.0, f64::max);
        prop_assert!(worst <= tolerance + 1e-9, "{worst:e} m, tolerance {tolerance:e}");
        // On the bisector, the distance to the lines is cos(angle/2) times the distance to the corner.
        let u = 2.0 * (angle / 2.0).sin();
        let (by_ramps, reserved) = [
            (0.04f64.powi(2) / 48.0, 0.04f64.powi(2) / 16.0),
            ((0.03f64.powi(2) + 0.01f64.powi(2)) / 48.0, 0.03f64.powi(2) / 16.0),
            (0.02f64.powi(2) / E, 0.02f64.powi(2) / E / 2.0),
        ][which];
        if tolerance > 2.0 * by_ramps * u * acceleration && tolerance < reserved * acceleration {
            let least = tolerance / 3.0 * (angle / 2.0).cos();
            prop_assert!(worst >= least, "{worst:e} m, expected at least {least:e}");
        }
    }
}

/// The figures of `docs/controller.md`: `cargo test -p shared --test integration path::figures -- --nocapture`.
#[test]
fn figures() {
    println!("circle of 1 m about (1 m, -1 m): distance from the circle, nm; greatest value over limit - 1");
    println!("{:>12} {:>6} {:>9} {:>9} {:>9} {:>9}", "ramps", "Hz", "nm", "feed", "acc.", "jerk");
    for (name, ramps) in [
        ("trapezoid", Ramps::Trapezoid),
        ("exponential", Ramps::Exponential),
        ("S-curve", Ramps::SCurve { jerk_m_per_s3: 100.0 }),
    ] {
        for rate in [1000.0, 20_000.0] {
            let block = Block::arc([0, 1], [1.0, -1.0], if cfg!(miri) { 1e-3 } else { 1.0 }, 1.0, 5.0);
            let commands = travel([2.0, -1.0], rate, Smoothing::None, &[block.with_ramps(ramps)]);
            let off = metres(&commands).into_iter().map(|[x, y]| ((x - 1.0).hypot(y + 1.0) - 1.0).abs());
            let off_nm = off.fold(0.0, f64::max) * 1e9;
            let excess = |limit: f64, order| greatest(&commands, rate, order) / limit - 1.0;
            let jerk = if name == "S-curve" { excess(100.0, 3) } else { f64::NAN };
            let [feed, acceleration] = [excess(1.0, 1), excess(5.0, 2)];
            println!("{name:>12} {rate:>6} {off_nm:>9.1e} {feed:>9.1e} {acceleration:>9.1e} {jerk:>9.1e}");
            // 2 m is rounded to 4e-7 nm in f64, a position to 1e-6 nm.
            assert!(off_nm < 1e-5, "{off_nm}");
            assert!(feed < 1e-6 && acceleration < 1e-6 + quantum(rate, 2) / 5.0);
        }
    }
    println!("after interpolation, R = 20 mm at 0.1 m/s: shrinkage, µm, derived and measured");
    let (rate, radius, feed) = (4000.0, 0.02, 0.1);
    let omega = feed / radius / rate;
    let mean = |ticks: f64| (ticks * omega / 2.0).sin() / (ticks * (omega / 2.0).sin());
    let alpha = 1.0 - (-1.0f64 / 80.0).exp();
    let lag = alpha / (1.0 + (1.0 - alpha).powi(2) - 2.0 * (1.0 - alpha) * omega.cos()).sqrt();
    for (smoothing, gain) in [
        (Smoothing::Trapezoid { time_s: 0.05 }, mean(200.0)),
        (Smoothing::SCurve { time_s: 0.05, jerk_time_s: 0.03 }, mean(200.0) * mean(120.0)),
        (Smoothing::Exponential { time_constant_s: 0.02 }, lag),
    ] {
        let block = Block::arc([0, 1], [0.0, 0.0], 3.0, feed, 10.0).with_ramps(Ramps::AfterInterpolation);
        let commands = metres(&travel([radius, 0.0], rate, smoothing, &[block]));
        let [x, y] = commands[commands.len() / 2];
        let (derived, measured) = (radius * (1.0 - gain) * 1e6, (radius - x.hypot(y)) * 1e6);
        println!("{derived:>14.5} {measured:>14.5}  {smoothing:?}");
        assert!((derived - measured).abs() < 1e-5);
    }
}

/// An arc whose end point lies off the circle is corrected evenly over its length and keeps all limits, or it is rejected.
#[test]
fn a_short_arc_to_an_end_off_the_circle_keeps_its_limits() {
    use shared::interpolate::PathError;
    use shared::interpolate::block::Shape;
    let to = |length: f64, off: f64| {
        let (sine, cosine) = (length / 0.01).sin_cos();
        let to_m = [(0.01 + off) * cosine, (0.01 + off) * sine];
        let shape = Shape::ArcTo { plane: [0, 1], centre_m: [0.0, 0.0], to_m, positive: true };
        Block { shape, ..Block::line([0.0, 0.0], 0.01, 1.0) }
    };
    for (length, off) in [(1e-6, 1.9e-6), (20e-6, 1.9e-6), (1e-3, 1.9e-6)] {
        let mut path = Path::new(at([0.01, 0.0]), 4000.0);
        assert_eq!(path.push(&to(length, off)), Err(PathError::EndOffArc), "{length}");
    }
    for (length, off) in [(2e-6, 1e-9), (20e-6, 10e-9), (2e-3, 1.9e-6), (5e-3, -1.9e-6)] {
        let line = Block::line([0.01, 0.0], 0.01, 1.0).within(1e-9);
        let commands = travel([0.01, -0.005], 4000.0, Smoothing::None, &[line, to(length, off)]);
        for (order, limit) in [(1, 0.01), (2, 1.0)] {
            let worst = greatest(&commands, 4000.0, order);
            assert!(worst <= limit * (1.0 + 1e-6) + quantum(4000.0, order), "{length} {order}: {worst}");
        }
    }
}

#[test]
fn a_centre_out_of_range_and_negative_filter_times_are_rejected() {
    use shared::interpolate::{Field, PathError};
    let mut path = Path::new(at([100.0, 0.0]), 20_000.0);
    let arc = Block::arc([0, 1], [-100.0, 0.0], 0.5, 40.0, 1000.0);
    assert_eq!(path.push(&arc), Err(PathError::TooLarge(Field::Centre)));
    for smoothing in [
        Smoothing::Trapezoid { time_s: -1e-4 },
        Smoothing::SCurve { time_s: 1e-3, jerk_time_s: -1e-4 },
        Smoothing::Exponential { time_constant_s: -1e-4 },
    ] {
        assert_eq!(path.smooth(&[smoothing; 2]), Err(PathError::NotPositive(Field::Smoothing)));
    }
}
