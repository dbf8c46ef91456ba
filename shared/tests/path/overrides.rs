//! Feed override: the path is run slower or faster, without a jump, and stays the same path.

use super::*;

const RATE_HZ: f64 = 4000.0;

/// Deceleration of a stop, and of a change of the override, m/s².
const STOP: f64 = 2.0;

/// 2 m/s² as position units per tick² with 16 fraction bits.
fn stop() -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁶³")]
    let units = (STOP * PER_M / (RATE_HZ * RATE_HZ) * 65_536.0) as u64;
    units
}

const FEED: f64 = 0.1;
const ACCELERATION: f64 = 1.0;

/// A line, a quarter circle and a line, at 0.1 m/s and 1 m/s².
fn path(ramps: Ramps) -> Path<2> {
    let mut path = Path::new(at([0.0, 0.0]), RATE_HZ);
    for block in [
        Block::line([0.02, 0.0], FEED, ACCELERATION).with_ramps(ramps).within(0.0),
        Block::arc([0, 1], [0.02, 0.02], 0.25, FEED, ACCELERATION).with_ramps(ramps).within(0.0),
        Block::line([0.04, 0.06], FEED, ACCELERATION).with_ramps(ramps),
    ] {
        path.push(&block).unwrap();
    }
    path
}

/// Distance of a point from that path.
fn distance_to_path([x, y]: Point) -> f64 {
    let first = distance_to_line([x, y], [0.0, 0.0], [0.02, 0.0]);
    let last = distance_to_line([x, y], [0.04, 0.02], [0.04, 0.06]);
    let on_arc = (x >= 0.02 && y <= 0.02).then(|| ((x - 0.02).hypot(y - 0.02) - 0.02).abs());
    first.min(last).min(on_arc.unwrap_or(f64::INFINITY))
}

const RAMPS: [Ramps; 3] = [Ramps::Trapezoid, Ramps::SCurve { jerk_m_per_s3: 50.0 }, Ramps::Exponential];

fn run_to_end(path: &mut Path<2>) -> Vec<[Position; 2]> {
    let mut commands = vec![path.command()];
    while !path.is_done() {
        commands.push(path.advance());
        assert!(commands.len() < 100_000, "no end");
    }
    commands
}

/// At 200 % from the start, the commands are every second one of the planned path, to the bit: the positions are the same, and so is every
/// rounding.
#[test]
fn at_200_percent_the_path_is_every_second_command_of_the_planned_one() {
    for ramps in RAMPS {
        let planned = run_to_end(&mut path(ramps));
        let mut faster = path(ramps);
        faster.set_override(200, stop());
        assert_eq!(faster.rate_percent(), 200);
        let faster = run_to_end(&mut faster);
        assert_eq!(faster.len(), planned.len() / 2 + 1, "{ramps:?}");
        assert!(faster.iter().zip(planned.iter().step_by(2)).all(|(a, b)| a == b), "{ramps:?}");
        assert_eq!(faster.last(), planned.last());
    }
}

/// At 50 % every second command is one of the planned path, but for the rounding of half ticks: at most 8 position units (8/1024 nm) of
/// the length each, of which there are some 2,000.
#[test]
fn at_50_percent_every_second_command_is_one_of_the_planned_path() {
    for ramps in [Ramps::Trapezoid, Ramps::SCurve { jerk_m_per_s3: 50.0 }] {
        let planned = run_to_end(&mut path(ramps));
        let mut slower = path(ramps);
        slower.set_override(50, stop());
        let slower = run_to_end(&mut slower);
        assert!(slower.len().abs_diff(2 * planned.len()) <= 3, "{} {}", slower.len(), planned.len());
        for (slow, plan) in slower.iter().step_by(2).zip(&planned) {
            let apart = slow.iter().zip(plan).map(|(a, b)| (*a - *b).unsigned_abs()).max().unwrap();
            assert!(apart <= 8, "{ramps:?}: {apart}");
        }
    }
}

/// What is done to the path at a tick.
#[derive(Clone, Copy, Debug)]
enum Action {
    Override(u8),
    Hold,
    Resume,
}

fn actions() -> impl Strategy<Value = Vec<(usize, Action)>> {
    let action = prop_oneof![
        6 => (0u8..=200).prop_map(Action::Override),
        1 => Just(Action::Hold),
        2 => Just(Action::Resume),
    ];
    prop::collection::vec((1usize..500, action), 1..12)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 200 }))]

    /// Whatever is overridden, held and resumed, and when: every command is on the path and the last one is its end; the speed is at most
    /// that of the greatest override r, r·F, and the accelerations at most r²·A of the block and 2 m/s² of the change. A jump would be an
    /// acceleration of many times that: 1 % of the speed in a tick is 4 m/s².
    #[test]
    fn no_sequence_of_overrides_and_holds_jumps_or_leaves_the_path(
        actions in actions(), ramps in prop::sample::select(RAMPS.to_vec()),
    ) {
        let mut path = path(ramps);
        let mut commands = vec![path.command(); 4];
        let mut most: f64 = 1.0;
        for (ticks, action) in actions {
            commands.extend((0..ticks).map(|_| path.advance()));
            match action {
                Action::Override(percent) => {
                    path.set_override(percent, stop());
                    most = most.max(f64::from(percent) / 100.0);
                }
                Action::Hold => path.hold(stop()),
                Action::Resume => path.resume(stop()),
            }
        }
        path.resume(stop());
        path.set_override(100, stop());
        commands.extend(run_to_end(&mut path).into_iter().skip(1));
        commands.extend([path.command(); 4]);
        prop_assert_eq!(path.command(), at([0.04, 0.06]));
        for point in metres(&commands) {
            prop_assert!(distance_to_path(point) < 1e-9, "{point:?}");
        }
        let speed = greatest(&commands, RATE_HZ, 1);
        prop_assert!(speed <= most * FEED * (1.0 + 1e-6) + quantum(RATE_HZ, 1), "{speed} m/s at {most}");
        let acceleration = greatest(&commands, RATE_HZ, 2);
        let limit = most * most * ACCELERATION + STOP;
        prop_assert!(acceleration <= limit * (1.0 + 1e-3) + quantum(RATE_HZ, 2), "{acceleration} of {limit} m/s²");
    }
}

fn run(path: &mut Path<2>, ticks: usize) -> Vec<[Position; 2]> {
    (0..ticks).map(|_| path.advance()).collect()
}

fn speed(commands: &[[Position; 2]]) -> f64 {
    greatest(&commands[commands.len() - 2..], RATE_HZ, 1)
}

/// In the cruise the speed goes from 100 % to 150 % with 2 m/s²: 0.05 m/s in 25 ms, which is 100 ticks.
#[test]
fn the_override_changes_the_speed_with_the_declared_acceleration() {
    let mut path = Path::new(at([0.0, 0.0]), RATE_HZ);
    path.push(&Block::line([0.2, 0.0], FEED, ACCELERATION)).unwrap();
    let cruise = run(&mut path, 800);
    assert!((speed(&cruise) - FEED).abs() < 1e-6);
    path.set_override(150, stop());
    let ramp = run(&mut path, 99);
    assert!(path.rate_percent() < 150 && path.feed_state() == FeedState::Running);
    assert!((greatest(&ramp, RATE_HZ, 2) - STOP).abs() < 0.01 * STOP + quantum(RATE_HZ, 2));
    let faster = run(&mut path, 5);
    assert!((speed(&faster) - 1.5 * FEED).abs() < 1e-6 && path.rate_percent() == 150);
}

/// At 0 % the path stands and is neither held nor done; a resume does not move it, another override does.
#[test]
fn at_0_percent_the_path_stands() {
    let mut path = path(Ramps::Trapezoid);
    run(&mut path, 600);
    path.set_override(0, stop());
    // 0.1 m/s at 2 m/s²: 200 ticks.
    run(&mut path, 201);
    let standing = path.command();
    assert_eq!((path.rate_percent(), path.feed_state()), (0, FeedState::Running));
    path.resume(stop());
    path.hold(stop());
    assert_eq!(path.feed_state(), FeedState::Held);
    path.resume(stop());
    assert!(run(&mut path, 100).iter().all(|command| *command == standing) && !path.is_done());
    assert_eq!(path.feed_state(), FeedState::Running);
    path.set_override(1, stop());
    assert_ne!(run(&mut path, 100)[99], standing);
    path.set_override(100, stop());
    assert_eq!(run_to_end(&mut path).last(), Some(&at([0.04, 0.06])));
}

/// An override that is set while the path is held takes effect with the resume; one that is set while it is discarded, in the next path.
#[test]
fn an_override_neither_revives_a_held_nor_a_discarded_path() {
    let mut path = path(Ramps::Trapezoid);
    run(&mut path, 600);
    path.hold(stop());
    path.set_override(200, stop());
    run(&mut path, 300);
    assert_eq!((path.feed_state(), path.rate_percent()), (FeedState::Held, 0));
    path.resume(stop());
    run(&mut path, 401);
    assert_eq!((path.feed_state(), path.rate_percent()), (FeedState::Running, 200));
    path.discard(stop());
    path.set_override(70, stop());
    while !path.is_done() {
        path.advance();
    }
    // At rest the next path starts at the override; a reset ends it.
    assert_eq!((path.feed_state(), path.rate_percent()), (FeedState::Running, 70));
    path.push(&Block::line([0.0, 0.0], FEED, ACCELERATION)).unwrap();
    let commands = run_to_end(&mut path);
    assert!((greatest(&commands, RATE_HZ, 1) - 0.7 * FEED).abs() < 1e-6 + quantum(RATE_HZ, 1));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 1 } else { 200 }))]

    /// A stop with 0.3 m/s² at any override and any time: without a jump at its start or at the end of the path, on the path. Where the
    /// block decelerates faster, so does the stop: by r²·1 m/s². The joints add as much again; the greatest speed of the exponential
    /// ramps at the end of a block ends in a step of the same size.
    #[test]
    fn a_stop_at_any_override_does_not_jump(
        percent in 0u8..=200, after in 1usize..2500, ramps in prop::sample::select(RAMPS.to_vec()),
    ) {
        let mut path = path(ramps);
        path.set_override(percent, stop());
        let mut commands = vec![path.command(); 4];
        commands.extend(run(&mut path, after));
        path.brake(stop() * 3 / 20);
        // An override does not change a stop.
        path.set_override(200 - percent, stop());
        while !path.has_stopped() {
            commands.push(path.advance());
            prop_assert!(commands.len() < after + 10_000, "not stopped");
        }
        commands.extend([path.command(); 4]);
        for point in metres(&commands) {
            prop_assert!(distance_to_path(point) < 1e-9, "{point:?}");
        }
        let rate = f64::from(percent.max(100)) / 100.0;
        let acceleration = greatest(&commands, RATE_HZ, 2);
        let limit = 2.0 * rate * rate * ACCELERATION;
        prop_assert!(acceleration <= limit * (1.0 + 1e-2) + quantum(RATE_HZ, 2), "{acceleration} of {limit} m/s²");
    }
}
