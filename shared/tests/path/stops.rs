//! Stops along the path.

use super::*;

/// A stop on an arc takes v²/2a, stays on the arc and ends at standstill.
#[test]
fn a_stop_on_an_arc_stays_on_the_arc() {
    let (rate, radius) = (4000.0, 0.05);
    let mut path = Path::new(at([radius, 0.0]), rate);
    path.push(&Block::arc([0, 1], [0.0, 0.0], 1.0, 0.1, 1.0).within(0.0)).unwrap();
    path.push(&Block::line([0.1, 0.0], 0.1, 1.0)).unwrap();
    for _ in 0..4000 {
        path.advance();
    }
    let angle = |[x, y]: [Position; 2]| y.to_m().atan2(x.to_m());
    let from = angle(path.command());
    let deceleration = 2.0 * PER_M / (rate * rate) * 65_536.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1.4e11")]
    path.brake(deceleration as u64);
    assert!(!path.has_stopped());
    let mut ticks = 0;
    while !path.has_stopped() {
        let [x, y] = path.advance();
        assert!((x.to_m().hypot(y.to_m()) - radius).abs() < 0.5e-9);
        ticks += 1;
    }
    // 0.1 m/s at 2 m/s²: 50 ms and 2.5 mm; a sum over ticks differs from the integral by half a tick.
    assert!((198..=202).contains(&ticks), "{ticks} ticks");
    let distance = (angle(path.command()) - from) * radius;
    assert!((distance - 2.5e-3).abs() < 0.1 / rate, "{distance} m");
    let stopped = path.command();
    assert_eq!(path.advance(), stopped);
}

/// The commands up to standstill, with a stop after `after` ticks.
fn braked(start: Point, rate_hz: f64, blocks: &[Block<2>], after: usize) -> Vec<[Position; 2]> {
    let mut path = Path::new(at(start), rate_hz);
    for block in blocks {
        path.push(block).unwrap();
    }
    let mut commands: Vec<_> = (0..after).map(|_| path.advance()).collect();
    path.brake(0);
    while !path.has_stopped() {
        commands.push(path.advance());
        assert!(commands.len() < 100_000, "no stop");
    }
    commands
}

/// A stop never exceeds the feed and stays on the path: shortly before a corner with almost zero speed, where a step
/// extrapolated from the previous tick would lead backwards, and on blocks that are shorter than the travel of a tick.
#[test]
fn a_stop_beside_a_joint_stays_on_the_path() {
    let corner = [Block::line([0.1, 0.0], 0.1, 2.0).within(0.0), Block::line([0.1, 0.1], 0.1, 1.0)];
    for after in 21_000..21_400 {
        let commands = braked([0.0, 0.0], 20_000.0, &corner, after);
        assert!(greatest(&commands, 20_000.0, 1) <= 0.1 * (1.0 + 1e-6) + quantum(20_000.0, 1), "{after}");
    }
    let short = [Block::line([0.1, 0.0], 0.1, 0.1).within(0.0), Block::line([0.100_005, 0.0], 0.1, 1000.0)];
    let commands = metres(&braked([0.0, 0.0], 1000.0, &short, 1500));
    assert!(commands.windows(2).all(|w| w[0][0] <= w[1][0] && w[1][0] <= 0.100_005 + 1e-12));
    // A polygon whose sides are shorter than the travel of a tick: within 0.5 nm of its sides.
    let point =
        |k: u32| [5e-5 * (TAU * f64::from(k) / 400.0).cos(), 5e-5 * (TAU * f64::from(k) / 400.0).sin()];
    let sides: Vec<_> = (1..=16).map(|k| Block::line(point(k), 0.1, 1.0).within(1e-6)).collect();
    for after in 1..20 {
        for command in metres(&braked(point(0), 1000.0, &sides, after)) {
            let distance = (0..16)
                .map(|k| distance_to_line(command, point(k), point(k + 1)))
                .fold(f64::INFINITY, f64::min);
            assert!(distance < 0.5e-9, "{distance:e} m from the path, stop after {after} ticks");
        }
    }
}

/// The mean of the last commands, as the filter gives it.
fn mean_of(commands: &[[Position; 2]], ticks: usize, at: usize) -> Point {
    let window = (0..ticks).map(|ago| commands[at.saturating_sub(ago)]);
    window.fold([0.0; 2], |sum, point| [0, 1].map(|axis| sum[axis] + point[axis].to_m() / ticks as f64))
}

/// The filter of an axis sees each movement of the path: at an override, over a joint, in a stop and at its end.
#[test]
fn a_filtered_path_is_the_mean_of_the_path() {
    const TICKS: usize = 40;
    let rate_hz = 4000.0;
    let deceleration = 1.5 * PER_M / (rate_hz * rate_hz) * 65_536.0;
    for (percent, stops) in [(100, false), (100, true), (50, false), (130, false), (200, true), (70, true)] {
        let run = |smoothing| {
            let mut path = Path::new(at([0.0; 2]), rate_hz);
            path.smooth(&[smoothing; 2]).unwrap();
            let ends = if stops { &[[0.04, 0.0]][..] } else { &[[0.02, 0.0], [0.04, 0.0]] };
            for &to in ends {
                path.push(&Block::line(to, 0.1, 1.0)).unwrap();
            }
            let mut commands = vec![path.command()];
            let end = |path: &Path<2>| if stops { path.has_stopped() } else { path.is_done() };
            while !end(&path) {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁵³")]
                match commands.len() {
                    500 => path.set_override(percent, deceleration as u64),
                    1300 if stops => path.brake(deceleration as u64),
                    _ => {}
                }
                commands.push(path.advance());
                assert!(commands.len() < 20_000, "no end");
            }
            commands
        };
        let time_s = TICKS as f64 / rate_hz;
        let (plain, mut filtered) = (run(Smoothing::None), run(Smoothing::Trapezoid { time_s }));
        // A path with a filter waits for it at a stop: the second block starts later by its memory.
        let stop = plain.iter().position(|point| point[0] >= at([0.02, 0.0])[0] && !stops);
        for (tick, filtered) in filtered.iter().enumerate().take(stop.unwrap_or(plain.len())) {
            let mean = mean_of(&plain, TICKS, tick);
            let found = filtered.map(Position::to_m);
            assert!((mean[0] - found[0]).abs() < 1e-12, "{percent} % {stops} {tick}: {found:?} {mean:?}");
        }
        let last = filtered.pop().unwrap();
        assert_eq!(Some(&last), plain.last(), "{percent} % {stops}");
    }
}

/// Without ramps the path ends at its feed: a stop that is started 5 ticks before ends with the path, and not when the speed would be zero,
/// after 0.1 m/s over 1 m/s², 400 ticks.
#[test]
fn a_stop_ends_where_the_path_does() {
    let rate_hz = 4000.0;
    let mut path = Path::new(at([0.0; 2]), rate_hz);
    path.smooth(&[Smoothing::Trapezoid { time_s: 0.1 }; 2]).unwrap();
    let line = Block::line([0.05, 0.0], 0.1, 1.0).with_ramps(Ramps::AfterInterpolation);
    path.push(&line).unwrap();
    // 50 mm at 0.1 m/s take 2000 ticks.
    for _ in 0..1995 {
        path.advance();
    }
    path.brake(0);
    let mut ticks = 0;
    while !path.has_stopped() {
        path.advance();
        ticks += 1;
        assert!(ticks < 430, "no end");
    }
    // The path and the memory of the filter, 400 ticks.
    assert!((390..=412).contains(&ticks), "{ticks}");
    assert_eq!(path.command(), at([0.05, 0.0]));
}

/// Ramps of limited jerk have seven segments: the tick in which one ends, or is found to end, and no other has time for less urgent work.
#[test]
fn segment_ends_are_told() {
    let mut path = Path::new(at([0.0; 2]), 4000.0);
    path.push(&Block::line([0.05, 0.0], 0.1, 1.0).with_ramps(Ramps::SCurve { jerk_m_per_s3: 50.0 })).unwrap();
    let mut told = 0;
    let mut ticks = 0;
    while !path.is_done() {
        path.advance();
        ticks += 1;
        told += u32::from(path.take_segment_end());
    }
    assert!((7..=14).contains(&told) && ticks > 2000, "{told} of {ticks}");
    assert!(!path.take_segment_end());
}
