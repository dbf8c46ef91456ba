//! Stops along the path.

use super::*;

/// A stop within an arc takes v²/2a along it, leaves nothing of it, and stands.
#[test]
fn a_brake_stops_along_the_path() {
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
    // 0.1 m/s at 2 m/s²: 50 ms, 2.5 mm; sums over ticks differ by half of one.
    assert!((198..=202).contains(&ticks), "{ticks} ticks");
    let way = (angle(path.command()) - from) * radius;
    assert!((way - 2.5e-3).abs() < 0.1 / rate, "{way} m");
    let stands = path.command();
    assert_eq!(path.advance(), stands);
}

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

/// Before a corner that is all but a stop, where the step extrapolated for the next tick would lead backwards, and
/// onto a block that is shorter than a tick: a stop never goes faster than the feed, and stays on the path.
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
    // A polygon whose sides are shorter than a tick: on its lines to 0.5 nm.
    let point =
        |k: u32| [5e-5 * (TAU * f64::from(k) / 400.0).cos(), 5e-5 * (TAU * f64::from(k) / 400.0).sin()];
    let sides: Vec<_> = (1..=16).map(|k| Block::line(point(k), 0.1, 1.0).within(1e-6)).collect();
    for after in 1..20 {
        for place in metres(&braked(point(0), 1000.0, &sides, after)) {
            let off = (0..16).map(|k| from_line(place, point(k), point(k + 1))).fold(f64::INFINITY, f64::min);
            assert!(off < 0.5e-9, "{off:e} m off after {after}");
        }
    }
}
