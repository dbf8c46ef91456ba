//! The feed override on the emulated board: by the host, and by a second program.

use std::thread::sleep;
use std::time::{Duration, Instant};

use shared::link::Status;
use shared::link::message::{Jog, Reply, Request};
use shared::link::packet::Header;

use super::emulated_board::EmulatedBoard;
use super::ports::at_mm;
use super::raw_link::{RawLink, frame};

/// Statuses without a session are no sign of life: the jog is held 0.5 s after the last request of the session.
fn status(link: &mut RawLink, sequence: u32) -> Status {
    let found = link.exchange(&[frame(link.header(sequence), &Request::Status)], 1);
    let [Reply::Status(status)] = &found[..] else { panic!("{found:?}") };
    status.clone()
}

/// By ticks and commands of two statuses, the speed of a jog at 10 mm/s is that of its override, set with and without the session, 0.2 s
/// after it was set: 10 mm/s change within 5 ms. A command is up to 5 ticks old, of the 2,000 and more between the statuses.
#[test]
fn the_speed_of_a_jog_is_that_of_its_override() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let mut link = RawLink::open(&board);
    let jog = Jog { axis: 0, distance_m: Some(0.09), velocity_m_per_s: 0.01, acceleration_m_per_s2: 0.5 };
    for (number, request) in (1..).zip([Request::Enable, Request::Jog(jog)]) {
        assert_eq!(link.exchange(&[frame(link.header(number), &request)], 1), [Reply::Done]);
        sleep(Duration::from_millis(100));
    }
    let mut sequence = 2;
    for (percent, by_guest) in [(100, false), (150, true), (200, false), (50, true), (100, true)] {
        sequence += 1;
        let header = if by_guest { Header::without_session(percent.into()) } else { link.header(sequence) };
        sequence -= u32::from(by_guest);
        assert_eq!(link.exchange(&[frame(header, &Request::Override { percent })], 1), [Reply::Done]);
        let mut statuses = Vec::new();
        for _ in 0..2 {
            sleep(Duration::from_millis(200));
            sequence += 1;
            statuses.push(status(&mut link, sequence));
        }
        let [before, after] = &statuses[..] else { panic!("two") };
        let ticks = after.tick - before.tick;
        assert!(ticks >= 2000, "{ticks}");
        assert_eq!((after.feed_override.percent, after.rate_percent), (percent, percent));
        let moved_mm = 1e3 * (after.axes[0].command.to_m() - before.axes[0].command.to_m());
        let speed = moved_mm / ticks as f64 * link.welcome.rates.velocity_loop_hz;
        let expected = 0.1 * f64::from(percent);
        assert!((speed / expected - 1.0).abs() <= 10.0 / ticks as f64, "{percent} %: {speed} mm/s");
    }
}

/// A second program lets a jog of 6 s run at 200 %, holds it at 0 % and lets it go on. It reaches its target; a next jog runs as
/// planned. What is no override is refused by name.
#[test]
fn a_second_program_overrides_the_jog_of_the_first_one() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let refused = board.fails(1, "board override --port bench --percent 150");
    assert!(refused.contains("nothing moves or is held"), "{refused}");
    for percent in ["201", "-1", "99.5", "NaN"] {
        let refused = board.fails(2, &format!("board override --port bench --percent {percent}"));
        assert!(
            refused.contains("--percent") && refused.contains("a whole number from 0 to 200"),
            "{refused}"
        );
    }
    let jog = "board jog --port bench --axis x --by-mm 60 --speed-mm-per-min 600";
    let started = Instant::now();
    let first = board.start(jog);
    sleep(Duration::from_secs(1));
    let path = || {
        let status = board.succeeds("board status --port bench");
        (status.lines().find(|line| line.starts_with("path:")).unwrap().to_owned(), at_mm(&status, "x "))
    };
    let done = board.succeeds("board override --port bench --percent 0");
    assert_eq!(done.trim(), "The override is 0 %.");
    sleep(Duration::from_millis(200));
    let (shown, standing_mm) = path();
    assert_eq!(shown, "path: jog at 0 %");
    sleep(Duration::from_millis(700));
    let (_, later_mm) = path();
    assert!((later_mm - standing_mm).abs() < 1e-3 && later_mm < 50.0, "{standing_mm} {later_mm}");
    board.succeeds("board override --port bench --percent 200");
    assert_eq!(path().0, "path: jog at 200 %");
    assert!(first.wait_with_output().unwrap().status.success());
    println!("{:?}", started.elapsed());
    let (shown, mm) = path();
    assert_eq!(shown, "path: at rest");
    assert!((mm - 60.0).abs() < 1e-3, "{mm}");
    let first = board.start("board jog --port bench --axis x --by-mm -20 --speed-mm-per-min 600");
    sleep(Duration::from_secs(1));
    assert_eq!(path().0, "path: jog");
    assert!(first.wait_with_output().unwrap().status.success());
    // With 1.5 m/s² of the 2 m/s² of a stop: √(2/1.5).
    let first = board.start(
        "board jog --port bench --axis x --by-mm -60 --speed-mm-per-min 3000 --acceleration-m-per-s2 1.5",
    );
    sleep(Duration::from_millis(300));
    let limited = board.succeeds("board override --port bench --percent 200");
    let expected = "The override is 200 %. Speed or acceleration of the axes limit this motion to 115 %.";
    assert_eq!(limited.trim(), expected);
    assert!(first.wait_with_output().unwrap().status.success());
}
