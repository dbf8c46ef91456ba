extern crate std;

use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::interpolate::ramp::reachable;

const ONE: f64 = 18_446_744_073_709_551_616.0;

fn started(profile: &Profile) -> Progress {
    let mut progress = Progress::NONE;
    profile.start(&mut progress);
    progress
}

/// The distance after each tick, with all its fraction bits, for a start that is late by a fraction of a tick.
fn run(profile: &Profile, late: u64) -> Vec<i128> {
    let mut progress = started(profile);
    let mut distances = Vec::new();
    let mut time = TICK - late;
    while let Step::Within(_) = profile.advance(&mut progress, time) {
        distances.push(progress.place.distance);
        time = TICK;
    }
    distances.push(i128::from(profile.length) << 64);
    distances
}

/// Blocks with feeds of 1 nm to 50 µm per tick (1 m/s at 20 kHz) and ramps of up to some thousand ticks.
fn plans() -> impl Strategy<Value = (i64, u64, u64, Limits)> {
    let times = (1.0..3000.0f64, 1.0..3000.0f64, any::<bool>());
    ((20.0..36.0f64), (20.0..52.0f64), times, 0.0..1.0f64, 0.0..1.0f64).prop_map(
        |(feed, length, (ramp, rise, jerky), entry, exit)| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁵²")]
            let q16 = |value: f64| (value * 65_536.0) as u64;
            let feed = feed.exp2();
            let jerk = jerky.then(|| q16(feed / ramp / rise).max(1));
            let limits = Limits::new(q16(feed), q16(feed / ramp).max(1), jerk);
            #[expect(clippy::cast_possible_truncation, reason = "below 2⁵²")]
            let length = length.exp2() as i64;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a fraction of the feed"
            )]
            let [entry, exit] =
                [entry, exit].map(|fraction| (limits.feed as f64 * (2.0 * fraction - 1.0).max(0.0)) as u64);
            // Reduced to speeds that are within reach of each other, as by look-ahead.
            let exit = reachable(length, 0, exit, &limits);
            let entry = reachable(length, exit, entry.max(exit), &limits).min(entry);
            let exit = reachable(length, entry, exit.max(entry), &limits).min(exit);
            (length, entry, exit, limits)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 4 } else { 512 }))]

    /// Feed, acceleration and jerk at every tick are within their limits to 1e-6 (from differences of the distance with
    /// all its fraction bits), the speed is never negative, and the segments end within 16 units of the length.
    #[test]
    #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
    fn keeps_its_limits_at_every_tick((length, entry, exit, limits) in plans(), late in 0..TICK) {
        prop_assume!(u128::from(length.unsigned_abs()) << 16 < u128::from(limits.feed) * 100_000);
        let profile = Profile::plan(length, entry, exit, &limits).unwrap();
        let distances = run(&profile, late);
        prop_assume!(distances.len() > 6);
        let inside = &distances[..distances.len() - 1];
        let values = |differences: &[i128]| -> Vec<i128> { differences.windows(2).map(|w| w[1] - w[0]).collect() };
        let velocity = values(inside);
        let limit = |q16: u64| q16 as f64 / 65_536.0;
        let max = velocity.iter().fold(0.0f64, |max, &v| max.max(v as f64 / ONE));
        prop_assert!(velocity.iter().all(|&v| v >= -(1 << 44)), "backwards");
        prop_assert!(max <= limit(limits.feed) * (1.0 + 1e-6), "feed {max}");
        let acceleration = values(&velocity);
        // Without a jerk limit the last bits of the speed jump at the start of the cruise.
        let max = acceleration.iter().fold(0.0f64, |max, &a| max.max(a as f64 / ONE).max(-a as f64 / ONE));
        prop_assert!(max <= limit(limits.acceleration) * (1.0 + 1e-6) + 1e-3, "acceleration {max}");
        if let Some(jerk) = limits.jerk {
            let max = values(&acceleration).iter().fold(0.0f64, |max, &j| max.max((j as f64 / ONE).abs()));
            prop_assert!(max <= limit(jerk) * (1.0 + 1e-6) + 1e-3, "jerk {max} of {}", limit(jerk));
        }
        let mut progress = started(&profile);
        while let Step::Within(_) = profile.advance(&mut progress, TICK) {}
        let off = (progress.place.distance - (i128::from(length) << 64)) as f64 / ONE;
        prop_assert!(off.abs() < 16.0, "{off} units from the end");
    }

    /// From rest to rest, a move that reaches the feed takes L/v + v/A + A/J if it reaches the acceleration, L/v + 2√(v/J) if it
    /// does not, and L/v + v/A without a jerk limit.
    #[test]
    fn the_duration_is_the_shortest_within_the_limits((_, _, _, limits) in plans(), cruise in 0.0..3.0f64) {
        let [feed, acceleration] = [limits.feed, limits.acceleration].map(|limit| limit as f64 / 65_536.0);
        let jerk = limits.jerk.map(|jerk| jerk as f64 / 65_536.0);
        let ramp = match jerk {
            None => feed / acceleration,
            Some(jerk) if feed * jerk >= acceleration * acceleration => feed / acceleration + acceleration / jerk,
            Some(jerk) => 2.0 * libm::sqrt(feed / jerk),
        };
        #[expect(clippy::cast_possible_truncation, reason = "below 2⁵²")]
        let length = (feed * ramp * (1.0 + cruise)) as i64;
        let profile = Profile::plan(length, 0, 0, &limits).unwrap();
        let ticks = profile.durations.iter().map(|&d| d as f64).sum::<f64>() / TICK as f64;
        let shortest = length as f64 / feed + ramp;
        // Limits have 16 fraction bits and are at least about 2⁻⁸.
        prop_assert!((ticks / shortest - 1.0).abs() < 1e-3, "{ticks} ticks, expected {shortest}");
    }
}

proptest! {
    /// d + v·t + a·t²/2 + j·t³/6, and its derivatives, within a tick: the products of the part are rounded to 2⁻³² of a value.
    #[test]
    fn a_motion_advances_by_a_part_of_a_tick(
        v in -1e9..1e9f64, a in -1e6..1e6f64, j in -1e6..1e6f64, part in 1u32..u32::MAX,
    ) {
        #[expect(clippy::cast_possible_truncation, reason = "below 2⁹⁴")]
        let [velocity, acceleration, jerk_sixth] = [v, a, j / 6.0].map(|value| (value * ONE) as i128);
        let mut whole = Motion { distance: 5, velocity, acceleration };
        whole.advance(jerk_sixth, TICK);
        prop_assert_eq!(whole.distance, 5 + velocity + (acceleration >> 1) + jerk_sixth);
        prop_assert_eq!((whole.velocity, whole.acceleration), (velocity + acceleration + 3 * jerk_sixth, acceleration + 6 * jerk_sixth));
        let mut motion = Motion { distance: 0, velocity, acceleration };
        motion.advance_by(jerk_sixth, part);
        let t = f64::from(part) / 4_294_967_296.0;
        for (found, exact, scale) in [
            (motion.distance, t * (v + t * (a / 2.0 + t * j / 6.0)), v.abs() + a.abs() + j.abs()),
            (motion.velocity, v + t * (a + t * j / 2.0), v.abs() + a.abs() + j.abs()),
            (motion.acceleration, a + t * j, a.abs() + j.abs()),
        ] {
            prop_assert!((found as f64 / ONE - exact).abs() <= 1e-9 * scale + 1e-6, "{}: {exact}", found as f64 / ONE);
        }
    }

    /// In parts of ticks, as with an override, a curve ends after its duration, whatever the parts.
    #[test]
    fn a_curve_ends_after_its_duration_in_parts_of_ticks(ticks in 1.0..20.0f64, part in TICK / 7..TICK) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁵²")]
        let limits = Limits::new(1 << 40, ((1u64 << 40) as f64 / ticks) as u64, Some(((1u64 << 40) as f64 / ticks / ticks) as u64));
        let profile = Profile::plan(1 << 30, 0, 0, &limits).unwrap();
        let duration = profile.durations.iter().sum::<u64>();
        let mut progress = started(&profile);
        let mut elapsed = 0;
        let beyond = loop {
            elapsed += part;
            match profile.advance(&mut progress, part) {
                Step::Within(_) => prop_assert!(elapsed < duration + TICK, "no end"),
                Step::Beyond(time) => break time,
            }
        };
        prop_assert_eq!(elapsed - beyond, duration);
    }
}

/// A ramp of the greatest duration is refused at either end, with the other one short.
#[test]
fn a_long_ramp_is_refused_at_either_end() {
    let long = Ramp { rise: 0, hold: crate::interpolate::ramp::MAX_RAMP_TICKS << 32 };
    let short = Ramp { rise: 0, hold: TICK };
    for (up, down) in [(long, short), (short, long)] {
        let durations = Durations { up, cruise: 0, down };
        assert_eq!(Profile::with_durations(1 << 40, 0, 0, &durations).err(), Some(PathError::TooLong));
    }
    let durations = Durations { up: short, cruise: 0, down: short };
    assert!(Profile::with_durations(1 << 40, 0, 0, &durations).is_ok());
}

/// If neither feed nor acceleration is reached, four segments of duration T cover 2JT³: 2·1000·100³ = 2·10⁹ units take 400
/// ticks.
#[test]
fn a_short_move_reaches_neither_feed_nor_acceleration() {
    let limits = Limits::new(1 << 60, 1 << 50, Some(1000 << 16));
    let profile = Profile::plan(2_000_000_000, 0, 0, &limits).unwrap();
    let ticks = profile.durations.iter().map(|&d| d as f64).sum::<f64>() / TICK as f64;
    assert!((ticks - 400.0).abs() < 1e-3, "{ticks}");
    assert_eq!(profile.durations[3] >> 32, 0);
}

#[test]
fn moves_of_too_many_ticks_are_rejected() {
    let slow = Limits::new(1 << 16, 1 << 30, None);
    assert_eq!(Profile::plan(1 << 40, 0, 0, &slow), Err(PathError::TooLong));
    let soft = Limits::new(1 << 55, 1, None);
    assert_eq!(Profile::plan(i64::MAX / 4, 0, 0, &soft), Err(PathError::TooLong));
}
