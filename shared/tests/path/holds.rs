//! Feed hold along the path.

use super::*;

/// 2 m/s² as position units per tick² with 16 fraction bits.
fn per_tick2(rate_hz: f64) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁶³")]
    let units = (2.0 * PER_M / (rate_hz * rate_hz) * 65_536.0) as u64;
    units
}

fn blocks(ramps: Ramps) -> [Block<2>; 3] {
    [
        Block::line([0.02, 0.0], 0.1, 1.0).with_ramps(ramps).within(0.0),
        Block::arc([0, 1], [0.02, 0.02], 0.25, 0.1, 1.0).with_ramps(ramps).within(0.0),
        Block::line([0.04, 0.06], 0.1, 1.0).with_ramps(ramps),
    ]
}

/// Runs a path with a hold after `after` ticks and a pause. Returns the commands and the number of ticks that it stood.
fn held(ramps: Ramps, rate_hz: f64, after: usize) -> (Vec<[Position; 2]>, usize) {
    let mut path = Path::new(at([0.0, 0.0]), rate_hz);
    for block in blocks(ramps) {
        path.push(&block).unwrap();
    }
    let mut commands: Vec<_> = (0..after).map(|_| path.advance()).collect();
    path.hold(per_tick2(rate_hz));
    while path.feed_state() != FeedState::Held {
        commands.push(path.advance());
        assert!(commands.len() < after + 2000, "not held");
    }
    let standing = path.command();
    for _ in 0..500 {
        assert_eq!(path.advance(), standing);
        commands.push(standing);
    }
    assert!(!path.is_done());
    path.resume(per_tick2(rate_hz));
    while !path.is_done() {
        commands.push(path.advance());
        assert!(commands.len() < 40_000, "never done");
    }
    (commands, 500)
}

/// Distance of a point from the line, the quarter circle and the line of [`blocks`].
fn distance_to_path([x, y]: [f64; 2]) -> f64 {
    let first = distance_to_line([x, y], [0.0, 0.0], [0.02, 0.0]);
    let last = distance_to_line([x, y], [0.04, 0.02], [0.04, 0.06]);
    let on_arc = (x >= 0.02 && y <= 0.02).then(|| ((x - 0.02).hypot(y - 0.02) - 0.02).abs());
    first.min(last).min(on_arc.unwrap_or(f64::INFINITY))
}

/// A held path stays on the path, exceeds neither feed nor the sum of the accelerations (1 of the block and 2 of the hold), and
/// ends at its end, for every kind of ramps, and wherever it is held.
#[test]
fn a_hold_stays_on_the_path_and_within_the_accelerations() {
    let rate = 4000.0;
    for ramps in [Ramps::Trapezoid, Ramps::SCurve { jerk_m_per_s3: 50.0 }, Ramps::Exponential] {
        for after in [1, 150, 399, 800, 1200, 1999, 2600] {
            let (commands, _) = held(ramps, rate, after);
            assert_eq!(*commands.last().unwrap(), at([0.04, 0.06]));
            for point in metres(&commands) {
                assert!(distance_to_path(point) < 1e-9, "{ramps:?} {after}: {point:?}");
            }
            assert!(
                greatest(&commands, rate, 1) <= 0.1 * (1.0 + 1e-6) + quantum(rate, 1),
                "{ramps:?} {after}"
            );
            // The block's 1 m/s² along and across the path, and the 2 m/s² of the hold.
            let acceleration = greatest(&commands, rate, 2);
            assert!(
                acceleration <= 3.0 * (1.0 + 1e-3) + quantum(rate, 2),
                "{ramps:?} {after}: {acceleration}"
            );
        }
    }
}

fn run(path: &mut Path<2>, ticks: usize) {
    for _ in 0..ticks {
        path.advance();
    }
}

/// From 0.1 m/s at 2 m/s² the path stands after 50 ms and 2.5 mm.
#[test]
fn a_hold_has_the_declared_deceleration() {
    let rate = 4000.0;
    let mut path = Path::new(at([0.0, 0.0]), rate);
    path.push(&Block::line([0.1, 0.0], 0.1, 1.0)).unwrap();
    // After 100 ms of ramp, at the feed.
    let before = (0..1000).map(|_| path.advance()).last().unwrap();
    path.hold(per_tick2(rate));
    let mut ticks = 0;
    while path.feed_state() != FeedState::Held {
        path.advance();
        ticks += 1;
    }
    assert!((199..=201).contains(&ticks), "{ticks}");
    let [distance, _] = [path.command()[0].to_m() - before[0].to_m(), 0.0];
    assert!((distance - 2.5e-3).abs() < 0.1 / rate, "{distance}");
}

/// A path that is discarded ends where it stands, and takes other blocks from there.
#[test]
fn a_discarded_path_ends_at_standstill() {
    let rate = 4000.0;
    let mut path = Path::new(at([0.0, 0.0]), rate);
    path.push(&Block::line([0.1, 0.0], 0.1, 1.0)).unwrap();
    run(&mut path, 1000);
    path.discard(per_tick2(rate));
    // Neither a hold nor a resume revives it.
    path.hold(per_tick2(rate));
    path.resume(per_tick2(rate));
    let mut ticks = 0;
    while !path.is_done() {
        path.advance();
        ticks += 1;
        assert!(ticks < 300);
    }
    let [x, _] = path.command();
    // 20 mm at the feed after 5 mm of ramp, and 2.5 mm of the stop: 22.5 mm in all.
    assert!((x.to_m() - 0.0225).abs() < 0.1 / rate, "{}", x.to_m());
    assert_eq!(path.feed_state(), FeedState::Running);
    path.push(&Block::line([0.0, 0.0], 0.1, 1.0)).unwrap();
    while !path.is_done() {
        path.advance();
    }
    assert_eq!(path.command(), at([0.0, 0.0]));
}

/// A stop during a hold starts from the present speed: it takes the way that the remaining speed needs, and no more.
#[test]
fn a_stop_within_a_hold_continues_from_its_speed() {
    let rate = 4000.0;
    let mut path = Path::new(at([0.0, 0.0]), rate);
    path.push(&Block::line([0.1, 0.0], 0.1, 1.0)).unwrap();
    run(&mut path, 1000);
    path.hold(per_tick2(rate));
    run(&mut path, 100);
    let before = path.command()[0].to_m();
    path.brake(per_tick2(rate));
    let mut commands = vec![];
    while !path.has_stopped() {
        commands.push(path.advance());
    }
    // Half of the speed is left: 0.05²/(2·2) = 0.625 mm.
    let distance = path.command()[0].to_m() - before;
    assert!((distance - 0.625e-3).abs() < 2.0 * 0.1 / rate, "{distance}");
}

/// Blocks that are planned on a copy of the queue give the same path as blocks that are pushed, also while it runs; a copy
/// that is out of date is refused.
#[test]
fn a_queue_is_planned_on_a_copy() {
    let rate = 4000.0;
    let mut pushed = Path::new(at([0.0, 0.0]), rate);
    let mut adopted = pushed.clone();
    let mut copy = Path::AT_ZERO;
    for block in blocks(Ramps::Trapezoid) {
        pushed.push(&block).unwrap();
        copy.copy_queue(&adopted);
        copy.push(&block).unwrap();
        assert!(adopted.adopt_queue(&copy));
        for _ in 0..40 {
            assert_eq!(pushed.advance(), adopted.advance());
        }
    }
    copy.copy_queue(&adopted);
    copy.push(&Block::line([0.0, 0.0], 0.1, 1.0)).unwrap();
    while !pushed.is_done() {
        assert_eq!(pushed.advance(), adopted.advance());
    }
    assert!(adopted.is_done() && !adopted.adopt_queue(&copy));
    assert!(adopted.is_done());
}
