//! Motions: refused before they start, run as planned, held and stopped.

use shared::config::AxisEnvelope;
use shared::interpolate::feed_hold::FeedState;
use shared::interpolate::{Block, PathError};
use shared::link::message::{Jog, MOTION_BLOCKS, Reply, Request};
use shared::link::report::Activity;
use shared::link::{Envelope, Identity, Refusal};
use shared::safety::Power;
use shared::units::Position;

use super::rig::{ENVELOPE, IDENTITY, Rig, settings};
use super::{jog_at, jog_by, start};

/// The command, m.
fn at_m(rig: &Rig) -> [f64; 2] {
    rig.drive.machine().command().map(Position::to_m)
}

/// Whether the command is exactly at a point.
fn is_at(rig: &Rig, point_m: [f64; 2]) -> bool {
    rig.drive.machine().command() == point_m.map(|m| Position::from_m(m).unwrap())
}

/// Runs with a status request every 50 ms until nothing moves.
fn finish(rig: &mut Rig) {
    for _ in 0..1000 {
        rig.run(1000);
        if rig.status().at_rest {
            return;
        }
    }
    panic!("never at rest: {:?}", rig.status());
}

#[test]
fn a_motion_ends_at_its_last_point_and_follows_its_circle() {
    let mut rig = Rig::enabled();
    let circle = Block::arc([0, 1], [-0.01, 0.0], 1.0, 0.03, 0.5);
    start(&mut rig, &[Block::dwell(0.01), circle, Block::line([0.002, 0.003], 0.03, 0.5)]);
    assert_eq!(rig.status().activity, Activity::Motion);
    let mut farthest = 0f64;
    for _ in 0..40 {
        rig.run(1000);
        let [x, y] = rig.plant.position_m;
        if rig.status().blocks_left == 0 && x < -0.001 {
            farthest = farthest.max(((x + 0.01).hypot(y) - 0.01).abs());
        }
    }
    finish(&mut rig);
    assert!(is_at(&rig, [0.002, 0.003]));
    assert_eq!(rig.status().activity, Activity::Idle);
    // Kv·(friction 20 N)/Kp is passed at each reversal: below the limit of the following error.
    assert!(farthest > 0.0 && farthest < 0.5e-3, "{farthest}");
}

/// The third block leaves the travel: the whole motion is refused, and nothing has moved.
#[test]
fn a_motion_beyond_the_travel_is_refused_before_it_starts() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&Request::NewMotion), Reply::Done);
    for x in [0.05, -0.05] {
        assert_eq!(rig.request(&Request::add_block(Block::line([x, 0.0], 0.03, 0.5))), Reply::Done);
    }
    let error = PathError::BeyondTravel { axis: 1 };
    let out = Request::add_block(Block::line([0.0, 0.101], 0.03, 0.5));
    assert_eq!(rig.refusal(&out), Refusal::Path { block: 2, error });
    assert_eq!(rig.refusal(&Request::StartMotion { blocks: 3 }), Refusal::BlockCount { found: 2 });
    rig.run(2000);
    assert!(is_at(&rig, [0.0, 0.0]));
}

/// Of 150 mm/s, at which a reading becomes a fault, 90 % are allowed, for each axis on its own.
#[test]
fn a_motion_that_is_too_fast_is_refused_before_it_starts() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&Request::NewMotion), Reply::Done);
    let add = |rig: &mut Rig, block| rig.request(&Request::add_block(block));
    let limit_m_per_s = 0.9 * 0.15;
    let too_fast = |block, axis| Reply::Refused(Refusal::TooFast { block, axis, limit_m_per_s });
    assert_eq!(add(&mut rig, Block::line([0.0, 0.05], 0.136, 0.5)), too_fast(0, 1));
    assert_eq!(add(&mut rig, Block::line([0.0, 0.05], 0.134, 0.5)), Reply::Done);
    // At 45° each axis has 0.707 of the feed.
    assert_eq!(add(&mut rig, Block::line([0.05, 0.0], 0.19, 0.5)), Reply::Done);
    assert_eq!(add(&mut rig, Block::line([0.0, 0.05], 0.192, 0.5)), too_fast(2, 0));
    assert_eq!(add(&mut rig, Block::arc([0, 1], [0.0, 0.0], 0.1, 0.136, 0.5)), too_fast(2, 0));
}

/// The greatest speed itself is allowed, the next number is not. The way is a binary fraction, so that its direction is exactly 1.
#[test]
fn the_greatest_speed_of_an_axis_is_allowed() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&Request::NewMotion), Reply::Done);
    let mut add = |to_m, feed: f64| rig.request(&Request::add_block(Block::line(to_m, feed, 0.5)));
    let limit_m_per_s: f64 = 0.9 * 0.15;
    assert_eq!(add([0.0, 0.03125], limit_m_per_s), Reply::Done);
    let refused = Reply::Refused(Refusal::TooFast { block: 1, axis: 1, limit_m_per_s });
    assert_eq!(add([0.0, 0.0], limit_m_per_s.next_up()), refused);
    // From (0, 31.25 mm) 20 mm along x and 10 mm along y: x has 2/√5 of the feed, y half of that.
    assert_eq!(add([0.02, 0.041_25], 0.134 * 5f64.sqrt() / 2.0), Reply::Done);
    let refused = Reply::Refused(Refusal::TooFast { block: 2, axis: 0, limit_m_per_s });
    assert_eq!(add([0.0, 0.031_25], 0.136 * 5f64.sqrt() / 2.0), refused);
}

/// A board whose axes have no ends.
static ENDLESS: Envelope<2> = {
    let [x, y] = ENVELOPE.axes;
    let axes = [AxisEnvelope { travel_m: None, ..x }, AxisEnvelope { travel_m: None, ..y }];
    Envelope { axes, ..ENVELOPE }
};

/// An axis without soft limits can be jogged at a speed in either direction.
#[test]
fn without_soft_limits_a_jog_runs_in_either_direction() {
    let mut settings = settings();
    settings.axes[0].travel_m = None;
    for velocity in [0.03, -0.03] {
        let mut rig = Rig::of(&Identity { envelope: &ENDLESS, ..IDENTITY }, settings.clone());
        rig.enable();
        assert_eq!(rig.request(&jog_at(velocity)), Reply::Done);
        rig.run(4000);
        // 0.2 s at 30 mm/s, less half of the 60 ms of the acceleration, and the lag of the axis.
        let moved_m = rig.plant.position_m[0] * velocity.signum();
        assert!((4e-3..6e-3).contains(&moved_m), "{moved_m} m");
    }
}

#[test]
fn a_motion_longer_than_the_board_holds_is_refused() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&Request::NewMotion), Reply::Done);
    for k in 0..MOTION_BLOCKS {
        let x = if k.is_multiple_of(2) { 0.01 } else { 0.0 };
        assert_eq!(rig.request(&Request::add_block(Block::line([x, 0.0], 0.1, 2.0))), Reply::Done);
    }
    let full = Refusal::MotionFull { max: 64 };
    assert_eq!(rig.refusal(&Request::add_block(Block::line([0.02, 0.0], 0.1, 2.0))), full);
    assert_eq!(rig.request(&Request::StartMotion { blocks: 64 }), Reply::Done);
    finish(&mut rig);
    assert!(is_at(&rig, [0.0, 0.0]));
}

#[test]
fn nothing_starts_with_the_drives_off_or_while_something_moves() {
    let mut rig = Rig::new();
    assert_eq!(rig.refusal(&jog_by(1e-3)), Refusal::DrivesOff);
    assert_eq!(rig.request(&Request::NewMotion), Reply::Done);
    assert_eq!(rig.request(&Request::add_block(Block::line([0.01, 0.0], 0.03, 0.5))), Reply::Done);
    assert_eq!(rig.refusal(&Request::StartMotion { blocks: 1 }), Refusal::DrivesOff);
    rig.close_switch();
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(2);
    assert_eq!(rig.request(&jog_by(1e-3)), Reply::Done);
    assert_eq!(rig.refusal(&jog_by(1e-3)), Refusal::Moving);
    assert_eq!(rig.refusal(&Request::NewMotion), Refusal::Moving);
    assert_eq!(rig.refusal(&Request::StartMotion { blocks: 1 }), Refusal::Moving);
    finish(&mut rig);
    // The motion was checked from another position.
    assert_eq!(rig.refusal(&Request::StartMotion { blocks: 1 }), Refusal::Displaced);
}

#[test]
fn a_held_motion_is_resumed_and_ends_at_its_last_point() {
    let mut rig = Rig::enabled();
    start(&mut rig, &[Block::line([0.03, 0.0], 0.03, 0.5), Block::line([0.03, 0.02], 0.03, 0.5)]);
    rig.run(8000);
    assert_eq!(rig.request(&Request::Hold), Reply::Done);
    rig.run(600);
    let held = at_m(&rig);
    assert!(held[0] > 0.009 && held[0] < 0.014, "{held:?}");
    assert_eq!(rig.status().feed, FeedState::Held);
    rig.run(5000);
    assert!(is_at(&rig, held) && rig.status().activity == Activity::Motion);
    // Held is not at rest: nothing else starts.
    assert_eq!(rig.refusal(&jog_by(1e-3)), Refusal::Moving);
    assert_eq!(rig.request(&Request::Resume), Reply::Done);
    assert_eq!(rig.refusal(&Request::Resume), Refusal::NotHeld);
    finish(&mut rig);
    assert!(is_at(&rig, [0.03, 0.02]));
}

#[test]
fn a_stopped_motion_is_discarded_with_the_drives_on() {
    let mut rig = Rig::enabled();
    start(&mut rig, &[Block::line([0.03, 0.0], 0.03, 0.5), Block::line([0.03, 0.02], 0.03, 0.5)]);
    rig.run(8000);
    assert_eq!(rig.request(&Request::Stop), Reply::Done);
    // 30 mm/s at 2 m/s² take 15 ms and 0.225 mm.
    rig.run(600);
    let status = rig.status();
    assert_eq!((status.power, status.at_rest, status.blocks_left), (Power::On, true, 0));
    let stopped = at_m(&rig);
    assert!(stopped[0] < 0.013 && stopped[1] == 0.0, "{stopped:?}");
    rig.run(5000);
    assert!(is_at(&rig, stopped));
    assert_eq!(rig.request(&jog_by(-1e-3)), Reply::Done);
}

/// A jog at a speed ends at the travel; a jog beyond it is refused; another jog needs the end of this one.
#[test]
fn jogs_stay_within_the_travel() {
    let mut rig = Rig::enabled();
    let error = PathError::BeyondTravel { axis: 0 };
    assert_eq!(rig.refusal(&jog_by(0.11)), Refusal::Path { block: 0, error });
    for _ in 0..40 {
        assert_eq!(rig.request(&jog_at(0.03)), Reply::Done);
        rig.run(2000);
        if rig.status().at_rest {
            break;
        }
        assert_eq!(rig.refusal(&jog_at(-0.03)), Refusal::Moving);
    }
    assert!(is_at(&rig, [0.1, 0.0]));
    let other = Jog { axis: 2, distance_m: Some(1.0), velocity_m_per_s: 0.1, acceleration_m_per_s2: 1.0 };
    assert_eq!(rig.refusal(&Request::Jog(other)), Refusal::NoSuchAxis);
    let standing = Jog { axis: 1, velocity_m_per_s: 0.0, ..other };
    assert!(matches!(rig.refusal(&Request::Jog(standing)), Refusal::Path { .. }));
    let nan = Jog { axis: 1, distance_m: Some(f64::NAN), ..other };
    assert!(matches!(rig.refusal(&Request::Jog(nan)), Refusal::Path { .. }));
}

/// A motion that has been started moves, although the axes still stand: nothing else can be started before its first block.
#[test]
fn a_started_motion_is_not_at_rest_before_its_first_block() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.drive.can_start(), Ok(()));
    rig.drive.start_motion(1, 100);
    assert!(rig.drive.machine().is_at_rest());
    assert_eq!((rig.drive.is_at_rest(), rig.drive.can_start()), (Err(Refusal::Moving), Err(Refusal::Moving)));
}

/// The limit of a motion holds for a jog by a distance and for one at a speed, in both directions.
#[test]
fn a_jog_that_is_too_fast_is_refused() {
    let limit_m_per_s: f64 = 0.9 * 0.15;
    let mut rig = Rig::enabled();
    for (distance_m, sign) in [(Some(0.01), 1.0), (Some(-0.01), 1.0), (None, 1.0), (None, -1.0)] {
        let jog = |velocity: f64| {
            let velocity_m_per_s = sign * velocity;
            Request::Jog(Jog { axis: 1, distance_m, velocity_m_per_s, acceleration_m_per_s2: 2.0 })
        };
        let refused = Refusal::TooFast { block: 0, axis: 1, limit_m_per_s };
        assert_eq!(rig.refusal(&jog(limit_m_per_s * 1.001)), refused, "{distance_m:?} {sign}");
        assert!(rig.status().at_rest);
        assert_eq!(rig.request(&jog(limit_m_per_s * 0.999)), Reply::Done);
        assert_eq!(rig.request(&Request::Stop), Reply::Done);
        finish(&mut rig);
    }
}

/// The last of 24 blocks moves y onto a switch that has become active since it was checked. The queue holds 16 blocks: when the first of
/// them have ended, the last is planned and refused, and the path stops there, instead of running to its 23rd block and waiting for ever.
#[test]
fn a_block_that_fails_stops_the_motion() {
    let mut rig = Rig::enabled();
    let mut blocks: Vec<Block<2>> =
        (1..24).map(|k| Block::line([f64::from(k) * 1e-3, 0.0], 0.02, 0.5)).collect();
    blocks.push(Block::line([0.023, 0.01], 0.02, 0.5));
    start(&mut rig, &blocks);
    rig.run(200);
    rig.plant.limits[1] = [false, true];
    finish(&mut rig);
    let status = rig.status();
    assert_eq!((status.activity, status.blocks_left, status.power), (Activity::Idle, 0, Power::On));
    let [x_m, y_m] = at_m(&rig);
    assert!(x_m < 0.012 && y_m == 0.0, "{x_m} {y_m}");
    rig.run(5000);
    assert!(is_at(&rig, [x_m, y_m]));
}
