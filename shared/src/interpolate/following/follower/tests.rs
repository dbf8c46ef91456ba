extern crate std;

use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::units::PER_NM;

/// Position ticks per second.
const RATE_HZ: f64 = 4000.0;

/// 5 mm for 4000 counts: 1.25 µm a count.
const SETTINGS: FollowSettings = FollowSettings {
    input: 0,
    distance_m: 5e-3,
    counts: 4000,
    speed_m_per_s: 0.05,
    acceleration_m_per_s2: 2.0,
    lag_m: 10e-3,
};

/// A count, position units.
const COUNT: i64 = 1250 * PER_NM;

/// Deceleration of a stop, m/s².
const STOP_M_PER_S2: f64 = 0.5;

const UNLIMITED: [Position; 2] = [Position(i64::MIN), Position(i64::MAX)];

/// Where the command is at the engagement.
const START: Position = Position(7_654_321_000_000);

struct Run {
    follower: Follower,
    command: Position,
    count: u32,
    travel: [Position; 2],
    /// The commands from the engagement on.
    commands: Vec<i64>,
    ending: Option<Ending>,
}

impl Run {
    fn new(settings: &FollowSettings) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "32,768 units a tick²")]
        let deceleration = (STOP_M_PER_S2 * PER_M / (RATE_HZ * RATE_HZ) * 65_536.0) as u64;
        // The counter wraps soon.
        let count = u32::MAX - 5;
        let follower = Follower::new(settings, count, START, RATE_HZ, deceleration).unwrap();
        Self {
            follower,
            command: START,
            count,
            travel: UNLIMITED,
            commands: [START.0; 2].into(),
            ending: None,
        }
    }

    /// A tick with the counter further by a number of counts.
    fn tick(&mut self, moved: i32) {
        self.count = self.count.wrapping_add_signed(moved);
        let ending = self.follower.step(self.count, &mut self.command, self.travel);
        self.ending = self.ending.or(ending);
        self.commands.push(self.command.0);
    }

    /// Ticks with the counter at a speed, counts per second.
    fn turn(&mut self, counts_per_s: f64, ticks: u32) {
        let at = |tick: u32| (f64::from(tick) * counts_per_s / RATE_HZ).floor();
        for tick in 0..ticks {
            #[expect(clippy::cast_possible_truncation, reason = "counts of a tick")]
            self.tick((at(tick + 1) - at(tick)) as i32);
        }
    }

    /// Speed of the command over the last tick, m/s.
    fn speed(&self) -> f64 {
        let [.., before, last] = self.commands[..] else { panic!() };
        (last - before) as f64 / PER_M * RATE_HZ
    }

    /// Greatest magnitudes of speed and acceleration, m/s and m/s².
    fn extremes(&self) -> [f64; 2] {
        let speeds: Vec<f64> =
            self.commands.windows(2).map(|pair| (pair[1] - pair[0]) as f64 / PER_M * RATE_HZ).collect();
        let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, b| a.max(b.abs()));
        let mut changes = speeds.windows(2).map(|pair| (pair[1] - pair[0]) * RATE_HZ);
        [greatest(&mut speeds.iter().copied()), greatest(&mut changes)]
    }
}

/// What the rounding of positions to a unit adds to an acceleration, m/s²: two units a tick².
const ROUNDING_M_PER_S2: f64 = 2.0 * RATE_HZ * RATE_HZ / PER_M;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Whatever the master does, speed and acceleration remain within their limits, and when it stands the axis comes to rest at the distance of all its
    /// counts: within 8 units, 8·10⁻¹⁵ m, to which the observer rounds.
    #[test]
    fn limits_hold_and_no_count_is_lost(
        distance_um in 1i32..20_000, negative: bool, counts in 1000u32..100_000,
        parts in proptest::collection::vec((-9000f64..9000.0, 1u32..2000), 1..6),
    ) {
        let distance_m = 1e-6 * f64::from(if negative { -distance_um } else { distance_um });
        let settings = FollowSettings { distance_m, counts, lag_m: 0.1, ..SETTINGS };
        let mut run = Run::new(&settings);
        let first = run.count;
        for (speed, ticks) in parts {
            run.turn(speed, ticks);
        }
        let n = i128::from(run.count.wrapping_sub(first).cast_signed());
        run.turn(0.0, 40_000);
        let [speed, acceleration] = run.extremes();
        prop_assert!(speed <= SETTINGS.speed_m_per_s * (1.0 + 1e-9), "{speed} m/s");
        prop_assert!(acceleration <= 2.0 + ROUNDING_M_PER_S2, "{acceleration} m/s²");
        if run.ending.is_none() {
            let distance = i128::from(Position::from_m(distance_m).unwrap().0);
            let exact = (n * distance).div_euclid(i128::from(counts));
            let off = i128::from(run.command - START) - exact;
            prop_assert!(off.abs() <= 8, "{off} units from {exact}");
        }
    }

    /// The command does not leave the travel, and what ends the following leaves the axis where it can stop: its speed then falls to zero.
    #[test]
    fn the_travel_is_not_left(
        below in 0i64..1 << 44, above in 0i64..1 << 44, speed in -9000f64..9000.0, ticks in 1u32..4000, back in -9000f64..9000.0,
    ) {
        let mut run = Run::new(&FollowSettings { lag_m: 0.1, ..SETTINGS });
        run.travel = [START - below, START + above];
        run.turn(speed, ticks);
        run.turn(back, ticks);
        run.turn(0.0, 4000);
        let range = run.travel[0].0..=run.travel[1].0;
        prop_assert!(run.commands.iter().all(|command| range.contains(command)));
        if run.ending.is_some() {
            prop_assert_eq!(run.ending, Some(Ending::Travel));
            prop_assert!(run.follower.has_stopped());
        }
    }
}

/// At constant speed the command is at the setpoint, within the count to which it is quantised, and as fast. 4000 counts/s are 5 mm/s; in half a second
/// the start, 5 mm/s over 2 m/s², and what the observer takes, e^(−250/s·0.5 s), are over. The velocity has the ripple of a count, which
/// comes in every tick: none.
#[test]
fn at_constant_speed_it_does_not_lag() {
    let mut run = Run::new(&SETTINGS);
    run.turn(4000.0, 2000);
    assert!(run.follower.lag(run.command).abs() < COUNT / 100, "{}", run.follower.lag(run.command));
    assert!((run.speed() - 5e-3).abs() < 1e-6, "{}", run.speed());
    assert_eq!(run.ending, None);
}

/// A count changes the velocity by (α² + β·(2α − α²) − α²·β) of its way in a tick, with α = 1/16 and β = 1/80: 0.0054 of 5 mm/s. Then the
/// command goes to it without passing it by more than the observer does, a tenth of a count.
#[test]
fn a_count_does_not_kick() {
    let mut run = Run::new(&SETTINGS);
    run.tick(1);
    let (alpha, beta) = (1.0 / 16.0, 1.0 / 80.0);
    let share = alpha * alpha * (1.0 - beta) + beta * (2.0 * alpha - alpha * alpha);
    assert!((run.speed() / (5e-3 * share) - 1.0).abs() < 1e-4, "{} m/s of {}", run.speed(), 5e-3 * share);
    run.turn(0.0, 8000);
    let farthest = run.commands.iter().max().unwrap() - START.0;
    assert!((COUNT..COUNT + COUNT / 4).contains(&farthest), "{farthest} of {COUNT}");
    assert!((run.command - START - COUNT).abs() <= 8);
}

/// A master that turns already at the engagement: nothing jumps, and what is lost while the axis accelerates is caught up. At 20 mm/s it
/// accelerates for 10 ms, and loses v²/(2a), 0.1 mm, and the delay of the observer.
#[test]
fn a_flying_engagement_is_caught_up() {
    let mut run = Run::new(&SETTINGS);
    let mut most = 0;
    for _ in 0..800 {
        run.tick(4);
        most = most.max(run.follower.lag(run.command));
    }
    let most_m = most as f64 / PER_M;
    assert!((0.1e-3..0.25e-3).contains(&most_m), "{most_m} m");
    run.turn(16_000.0, 2000);
    assert!(run.follower.lag(run.command).abs() < COUNT / 100);
    // The catching up is at most a·τ/2 faster than the counter: 20 mm/s; here 0.2 mm·50/s.
    let [speed, _] = run.extremes();
    assert!((0.022..0.04).contains(&speed), "{speed} m/s");
}

/// A master of 60 mm/s before an axis of 50: the lag grows by 10 mm/s until it is 10 mm, and the axis then stops within v²/(2·0.5 m/s²), 2.5 mm. It
/// does not move again, whatever the counter does.
#[test]
fn a_master_that_is_too_fast_ends_it() {
    let mut run = Run::new(&SETTINGS);
    let mut ticks = 0;
    while run.ending.is_none() && ticks < 8000 {
        run.tick(12);
        ticks += 1;
    }
    assert_eq!(run.ending, Some(Ending::Lag));
    let lag_m = run.follower.lag(run.command) as f64 / PER_M;
    // A tick's way of the counter is 15 µm, and that of the axis, which it makes in this tick, 12.5 µm.
    assert!((9.98e-3..10.02e-3).contains(&lag_m), "{lag_m} m");
    // 10 mm at 10 mm/s; the start has taken 50 mm/s·25 ms/2 of it, and 10 mm/s·25 ms.
    assert!((3500..4000).contains(&ticks), "{ticks} ticks");
    let from = run.command;
    run.turn(-40_000.0, 4000);
    let way_m = (run.command - from) as f64 / PER_M;
    assert!((way_m / 2.5e-3 - 1.0).abs() < 0.01, "{way_m} m");
    assert!(run.follower.has_stopped() && run.speed() == 0.0);
}

/// A stop decelerates at once with the declared deceleration: 20 mm/s in 40 ms, over 0.4 mm.
/// A lag of exactly the limit is none too many; a unit more is.
#[test]
fn the_lag_may_be_its_limit() {
    let lag_m = 1e-3;
    let limit = 1_000_000 * PER_NM;
    for (excess, expected) in [(0, None), (1, Some(Ending::Lag))] {
        let mut run = Run::new(&FollowSettings { lag_m, ..SETTINGS });
        // The first tick moves the setpoint by a count; the command is set where the lag is then what it is to be.
        let mut command = START + (COUNT - limit - excess);
        assert_eq!(
            run.follower.step(run.count.wrapping_add(1), &mut command, UNLIMITED),
            expected,
            "{excess}"
        );
    }
}

/// v²/2a from the end of the travel, and not a unit less, in either direction; outwards beyond the end not at all, at rest always. The tick
/// itself takes its way and up to a unit, forwards as that is what is left of it, and backwards as the way is rounded away from the start.
#[test]
fn it_can_stop_within_what_remains_of_the_travel() {
    let run = Run::new(&SETTINGS);
    let deceleration = run.follower.config.deceleration;
    assert_eq!(deceleration % 65_536, 0);
    // (1000 a)²/2a, and the way of the tick, without fractions.
    let velocity = 1000 * deceleration;
    let (way, tick) = (500_000 * deceleration / 65_536, velocity / 65_536);
    for (margin, can) in [(1, true), (0, false)] {
        let travel = [Position(i64::MIN), Position(way + tick + margin)];
        assert_eq!(run.follower.can_stop(velocity, Position(0), travel), can, "{margin}");
    }
    for (margin, can) in [(0, true), (-1, false)] {
        let travel = [Position(-(way + tick + margin)), Position(i64::MAX)];
        assert_eq!(run.follower.can_stop(-velocity, Position(0), travel), can, "{margin}");
    }
    let beyond = [Position(-2_000_000), Position(-1_000_000)];
    assert!(run.follower.can_stop(0, Position(0), beyond));
    assert!(!run.follower.can_stop(1 << 16, Position(0), beyond));
}

/// The counter is that of its settings.
#[test]
fn it_has_the_input_of_its_settings() {
    for input in [0, 1] {
        assert_eq!(Run::new(&FollowSettings { input, ..SETTINGS }).follower.input(), input);
    }
}

#[test]
fn a_stop_is_final() {
    let mut run = Run::new(&SETTINGS);
    run.turn(16_000.0, 2000);
    let from = run.command;
    run.follower.stop();
    run.turn(16_000.0, 161);
    assert!(run.follower.has_stopped());
    let way_m = (run.command - from) as f64 / PER_M;
    assert!((way_m / 0.4e-3 - 1.0).abs() < 0.02, "{way_m} m");
    let at = run.command;
    run.turn(16_000.0, 100);
    assert_eq!((run.command, run.ending), (at, None));
}

/// A master that goes on beyond the travel: the axis stops before its end. In ticks, a stop from v takes v²/(2a) less the way of half a
/// tick, and it begins up to a tick before it has to: 2.5 to 7.5 µm at 20 mm/s.
#[test]
fn it_stops_before_the_end_of_the_travel() {
    let mut run = Run::new(&SETTINGS);
    let end = START + 5_000_000 * PER_NM;
    run.travel = [START, end];
    run.turn(16_000.0, 4000);
    assert_eq!(run.ending, Some(Ending::Travel));
    let left_m = (end - run.command) as f64 / PER_M;
    assert!((2.49e-6..7.51e-6).contains(&left_m), "{left_m} m");
    // The other end is where it starts: it does not leave it either, and creeps back by nothing.
    let mut run = Run::new(&SETTINGS);
    run.travel = [START, end];
    run.turn(-100.0, 4000);
    assert_eq!((run.ending, run.command), (Some(Ending::Travel), START));
}

#[test]
fn settings_out_of_range_are_refused() {
    let new = |settings: FollowSettings| Follower::new(&settings, 0, START, RATE_HZ, 1).map(|_| ());
    assert_eq!(new(SETTINGS), Ok(()));
    for distance_m in [0.0, 0.9e-12, f64::NAN, 100.1, 4.2] {
        assert_eq!(new(FollowSettings { distance_m, ..SETTINGS }), Err(FollowError::Ratio), "{distance_m}");
    }
    for counts in [0, 1 << 31] {
        assert_eq!(new(FollowSettings { counts, ..SETTINGS }), Err(FollowError::Ratio), "{counts}");
    }
    for speed_m_per_s in [0.0, -0.01, 10.1, f64::NAN, f64::INFINITY] {
        assert_eq!(new(FollowSettings { speed_m_per_s, ..SETTINGS }), Err(FollowError::Speed));
    }
    for acceleration_m_per_s2 in [0.0, -0.01, 1001.0, f64::NAN] {
        assert_eq!(new(FollowSettings { acceleration_m_per_s2, ..SETTINGS }), Err(FollowError::Acceleration));
    }
    for lag_m in [0.0, 0.9e-6, 0.11, f64::NAN, -1e-3] {
        assert_eq!(new(FollowSettings { lag_m, ..SETTINGS }), Err(FollowError::Lag));
    }
    let extreme = FollowSettings {
        distance_m: -4.0,
        speed_m_per_s: 10.0,
        acceleration_m_per_s2: 1e3,
        lag_m: 0.1,
        ..SETTINGS
    };
    assert_eq!(new(extreme), Ok(()));
    assert_eq!(new(FollowSettings { distance_m: 1e-12, lag_m: 1e-6, ..SETTINGS }), Ok(()));
}
