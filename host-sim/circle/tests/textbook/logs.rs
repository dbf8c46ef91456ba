//! Logs of command and tool.

use circle::measured::Measured;
use circle::{Analysis, analyse};
use files::log::{AxisLog, Log, Unit};

use super::generator::{Circle, Truth};
use super::judge::{Coverage, judge};

/// The log of a circle about (12, −7) mm.
pub fn log(circle: &Circle) -> Log {
    let samples = circle.samples();
    let noise = [0, 1].map(|sensor| circle.noise(sensor, samples.len()));
    let mut axes = ["x", "y"].map(|name| AxisLog::new(name, Unit::Millimetre));
    for (axis, log) in axes.iter_mut().enumerate() {
        let nominal = |theta: f64| {
            let unit = if axis == 0 { theta.cos() } else { theta.sin() };
            [12.0, -7.0][axis] + circle.radius_mm * unit
        };
        let command: Vec<f64> = samples.iter().map(|(_, theta, _)| nominal(*theta)).collect();
        let tool = samples.iter().zip(&noise[axis]).map(|((_, theta, at), noise)| {
            let um = at.map_or(0.0, |at| circle.displacement(at)[axis]);
            nominal(*theta) + 1e-3 * (um + noise)
        });
        log.tool = Some(tool.collect());
        log.command = Some(command);
    }
    Log {
        source: "log.csv".to_owned(),
        start_s: 0.0,
        sample_time_s: 1.0 / circle.rate_hz,
        axes: axes.to_vec(),
    }
}

/// What a log shows.
pub fn of_log(log: &Log) -> Analysis {
    analyse(Measured::of_log(log).unwrap()).unwrap()
}

fn truth(circle: &Circle) -> Vec<Truth> {
    circle.parts.iter().map(|part| circle.truth(part)).collect()
}

/// Judges circles with seeds from 100, and returns the coverage of the intervals.
fn sweep(seeds: u64, correlation_s: f64) -> Coverage {
    let mut coverage = Coverage::default();
    let mut all = Vec::new();
    for seed in 100..100 + seeds {
        let circle = Circle::random(seed, correlation_s);
        let (wrong, covered) = judge(&of_log(&log(&circle)), &truth(&circle), 0.05);
        if !wrong.is_empty() {
            all.push(format!("seed {seed}: {wrong:?} {:?}", circle.parts));
        }
        coverage.add(covered);
    }
    assert!(all.is_empty(), "{} of {seeds}: {}", all.len(), all.join("\n"));
    coverage
}

/// With 60 circles of three parts on average, the standard error of a coverage of 95 % is 1.6 %. Below 90 % intervals are too narrow; at
/// 100 % of them they would be too wide.
#[test]
fn parts_of_a_log_are_found_under_white_noise() {
    let coverage = sweep(60, 0.0);
    assert!(coverage.all > 150, "{coverage:?}");
    assert!((0.90..=0.999).contains(&coverage.fraction()), "{coverage:?}");
}

/// Noise with a time constant of 30 ms: of 15 samples, one is independent.
#[test]
fn parts_of_a_log_are_found_under_correlated_noise() {
    let coverage = sweep(60, 0.03);
    assert!((0.90..=0.999).contains(&coverage.fraction()), "{coverage:?}");
}
