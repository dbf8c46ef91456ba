//! Logs of command and tool.

use circle::measured::Measured;
use circle::{Analysis, analyse};
use files::log::{AxisLog, Log, Unit};

use super::generator::Circle;
use super::judge::sweep;

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
    Log::new("log.csv", 0.0, 1.0 / circle.rate_hz, axes.to_vec())
}

/// What a log shows.
pub fn of_log(log: &Log) -> Analysis {
    analyse(Measured::of_logs(std::slice::from_ref(log)).unwrap()).unwrap()
}

fn of_circle(circle: &Circle) -> Analysis {
    of_log(&log(circle))
}

/// With 60 circles of three parts on average, the standard error of a coverage of 95 % is 1.6 %. Below 90 % intervals are too narrow; at
/// 100 % of them they would be too wide.
#[test]
fn parts_of_a_log_are_found_under_white_noise() {
    let coverage = sweep(60, 0.0, of_circle);
    assert!(coverage.all > 150, "{coverage:?}");
    assert!((0.90..=0.999).contains(&coverage.fraction()), "{coverage:?}");
}

/// Noise with a time constant of 30 ms: of 15 samples, one is independent.
#[test]
fn parts_of_a_log_are_found_under_correlated_noise() {
    let coverage = sweep(60, 0.03, of_circle);
    assert!((0.90..=0.999).contains(&coverage.fraction()), "{coverage:?}");
}
