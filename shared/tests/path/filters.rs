//! Axis filters.

use super::*;

/// With acceleration after interpolation, a circle of radius R at ω (per tick) shrinks to R·|H(ω)|, with |H| =
/// sin(nω/2)/(n·sin(ω/2)) for each mean and α/√(1 + (1 − α)² − 2(1 − α)·cos ω) for the lag. Rounding is below 3 position units.
#[test]
fn a_circle_shrinks_by_the_gain_of_its_filter() {
    let (rate, radius, feed) = (4000.0, 0.02, 0.1);
    let omega = feed / radius / rate;
    let mean = |seconds: f64| (seconds * rate * omega / 2.0).sin() / (seconds * rate * (omega / 2.0).sin());
    let alpha = 1.0 - (-1.0 / (0.02 * rate)).exp();
    let lag = alpha / (1.0 + (1.0 - alpha).powi(2) - 2.0 * (1.0 - alpha) * omega.cos()).sqrt();
    let cases = [
        (Smoothing::Trapezoid { time_s: 0.05 }, mean(0.05), omega * 0.05 * rate),
        (Smoothing::SCurve { time_s: 0.05, jerk_time_s: 0.03 }, mean(0.05) * mean(0.03), omega * 0.05 * rate),
        (Smoothing::Exponential { time_constant_s: 0.02 }, lag, omega * 0.02 * rate),
    ];
    for (smoothing, gain, angle) in cases {
        let block = Block::arc([0, 1], [0.0, 0.0], 3.0, feed, 10.0).with_ramps(Ramps::AfterInterpolation);
        let commands = travel([radius, 0.0], rate, smoothing, &[block]);
        assert_eq!(commands.last(), commands.first());
        let middle = &commands[commands.len() / 3..commands.len() / 2];
        for [x, y] in metres(middle) {
            let error = x.hypot(y) - radius * gain;
            assert!(error.abs() < 0.01e-9, "{smoothing:?}: {error:e} m from {:e}", radius * gain);
        }
        // The textbook approximations, ΔR = R(ωT)²/24 and R(ωτ)²/2 for the lag, agree to 10 %.
        let textbook = match smoothing {
            Smoothing::Exponential { .. } => angle * angle / 2.0,
            Smoothing::SCurve { .. } => angle * angle / 24.0 * (1.0 + 0.36),
            _ => angle * angle / 24.0,
        };
        assert!(((1.0 - gain) / textbook - 1.0).abs() < 0.1, "{gain}");
    }
}

/// A filter of length T turns the step of speed v into an acceleration v/T. To keep A = 2 m/s² with T = 0.1 s the feed is
/// reduced to A·T = 0.2 m/s.
#[test]
fn a_short_filter_reduces_the_feed() {
    let line = Block::line([0.1, 0.0], 0.5, 2.0).with_ramps(Ramps::AfterInterpolation);
    let commands = travel([0.0, 0.0], 1000.0, Smoothing::Trapezoid { time_s: 0.1 }, &[line]);
    assert!((greatest(&commands, 1000.0, 1) - 0.2).abs() < 1e-6, "{}", greatest(&commands, 1000.0, 1));
    assert!((greatest(&commands, 1000.0, 2) - 2.0).abs() < 1e-4, "{}", greatest(&commands, 1000.0, 2));
}
