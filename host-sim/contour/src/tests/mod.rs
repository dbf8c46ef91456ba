//! Closed forms of circles, lines and corners; simulated machines; pairs of logs.

mod circles;
mod lines;
mod simulated;
mod verified;

use super::LoggedMotion;
use files::log::Channel;

/// Time from one sample to the next, s.
const SAMPLE_S: f64 = 1e-3;

/// A standstill at a point that is longer than the settling, then a motion through points at 1 kHz, each with the
/// displacement of the tool from the command, m.
fn motion(points: &[([f64; 2], [f64; 2])]) -> LoggedMotion {
    let still = std::iter::repeat_n(points[0], 400);
    let all: Vec<_> = still.chain(points.iter().copied()).collect();
    let command = |i: usize| all.iter().map(|(command, _)| command[i]).collect();
    let measured = |i: usize| all.iter().map(|(command, error)| command[i] + error[i]).collect();
    LoggedMotion {
        axes: vec!["x".to_owned(), "y".to_owned()],
        channel: Channel::Tool,
        sample_s: SAMPLE_S,
        command_m: vec![command(0), command(1)],
        measured_m: vec![measured(0), measured(1)],
    }
}

/// Asserts that a value lies within a distance of another one.
#[track_caller]
fn assert_near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "found {found}, expected {expected} ± {within}");
}
