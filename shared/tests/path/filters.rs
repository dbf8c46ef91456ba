//! Filters of the axes behind the path.

use super::*;

/// After the interpolation, a circle of radius R at ω shrinks to R·|H(ω)|: the means by sin(nω/2)/(n·sin(ω/2)) each, the
/// lag by α/√(1 + (1 − α)² − 2(1 − α)cos ω), ω per tick. Rounding of means and places is below 3 units.
#[test]
fn a_circle_shrinks_as_its_filter_says() {
    let (rate, radius, feed) = (4000.0, 0.02, 0.1);
    let omega = feed / radius / rate;
    let mean = |seconds: f64| (seconds * rate * omega / 2.0).sin() / (seconds * rate * (omega / 2.0).sin());
    let share = 1.0 - (-1.0 / (0.02 * rate)).exp();
    let lag = share / (1.0 + (1.0 - share).powi(2) - 2.0 * (1.0 - share) * omega.cos()).sqrt();
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
            let off = x.hypot(y) - radius * gain;
            assert!(off.abs() < 0.01e-9, "{smoothing:?}: {off:e} m from {:e}", radius * gain);
        }
        // The textbook's ΔR = R(ωT)²/24, of the lag R(ωτ)²/2, to a tenth.
        let textbook = match smoothing {
            Smoothing::Exponential { .. } => angle * angle / 2.0,
            Smoothing::SCurve { .. } => angle * angle / 24.0 * (1.0 + 0.36),
            _ => angle * angle / 24.0,
        };
        assert!(((1.0 - gain) / textbook - 1.0).abs() < 0.1, "{gain}");
    }
}

/// The filters turn the step of speed into the block's acceleration: lowered feed where they are too short.
#[test]
fn filters_that_are_short_lower_the_feed() {
    let line = Block::line([0.1, 0.0], 0.5, 2.0).with_ramps(Ramps::AfterInterpolation);
    let commands = travel([0.0, 0.0], 1000.0, Smoothing::Trapezoid { time_s: 0.1 }, &[line]);
    assert!((greatest(&commands, 1000.0, 1) - 0.2).abs() < 1e-6, "{}", greatest(&commands, 1000.0, 1));
    assert!((greatest(&commands, 1000.0, 2) - 2.0).abs() < 1e-4, "{}", greatest(&commands, 1000.0, 2));
}
