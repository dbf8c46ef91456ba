//! The feed-forward at which a circle keeps its radius.
//!
//! A linear loop reproduces a circle of radius R with the radius |1 + j·Kf·ω/Kp|·|G(jω)|·R. Its square is linear in Kf²,
//! so that two circles, with Kf = 0 and Kf = 100 %, determine the Kf that keeps the radius.

use std::f64::consts::TAU;

use super::contour::radius_m;
use super::machine::{self, FEED_M_PER_S, Motion, RADIUS_M, Track, Tuning};
use crate::reproduce::study::ReproduceError;
use model::axis::Law;

/// Time after which the transient has decayed, s: the dwell and half a turn.
const STEADY_FROM_S: f64 = 0.2 + 0.5 * TAU * RADIUS_M / FEED_M_PER_S;

/// Feed-forward Kf at which a circle keeps its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadiusFeedforward {
    /// At the motors, %.
    pub motor_percent: f64,
    /// At the tool, %.
    pub tool_percent: f64,
    /// Loss of radius of the tool's circle without feed-forward, m.
    pub shrinkage_m: f64,
}

/// Determines the feed-forward that keeps a circle's radius on the plant.
///
/// # Errors
/// If a simulation fails.
pub fn radius_feedforward(law: Law, gain_per_s: f64) -> Result<RadiusFeedforward, ReproduceError> {
    let run = |feedforward_percent| machine::circle(Tuning { law, gain_per_s, feedforward_percent });
    let (without, full) = (run(0.0)?, run(100.0)?);
    let percent = |track: fn(&Motion) -> &Track| {
        feedforward_percent(RADIUS_M, radius(&without, track), radius(&full, track))
    };
    Ok(RadiusFeedforward {
        motor_percent: percent(|motion| &motion.motor),
        tool_percent: percent(|motion| &motion.tool),
        shrinkage_m: RADIUS_M - radius(&without, |motion| &motion.tool),
    })
}

/// Kf, %, that gives the radius `target`, from the radii without feed-forward and with 100 %. NaN if there is none.
fn feedforward_percent(target: f64, without: f64, full: f64) -> f64 {
    let square = (target.powi(2) - without.powi(2)) / (full.powi(2) - without.powi(2));
    1e2 * square.sqrt()
}

/// Radius of the second turn, m.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand samples")]
fn radius(motion: &Motion, track: fn(&Motion) -> &Track) -> f64 {
    let from = (STEADY_FROM_S / motion.sample_s).round() as usize;
    let turn = (TAU * RADIUS_M / FEED_M_PER_S / motion.sample_s).round() as usize;
    radius_m(track(motion), &motion.command, machine::centre_m(), &(from..from + turn))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// HPC: |1 + jKf·w|²·256/(256 + 64w² + 4w⁴ + w⁶) = 1 gives Kf² = 1/4 + w²/64 + w⁴/256, w = ω/Kp.
    #[test]
    fn two_radii_determine_the_feedforward_of_hpc() {
        let w = 0.3_f64;
        let radius = |kf: f64| {
            let denominator = 256.0 + 64.0 * w.powi(2) + 4.0 * w.powi(4) + w.powi(6);
            ((1.0 + (kf * w).powi(2)) * 256.0 / denominator).sqrt()
        };
        let exact = 1e2 * (0.25 + w.powi(2) / 64.0 + w.powi(4) / 256.0).sqrt();
        assert!((feedforward_percent(1.0, radius(0.0), radius(1.0)) - exact).abs() < 1e-9);
        assert!(feedforward_percent(1.0, 1.001, 1.002).is_nan());
    }

    /// On the plant at the lowest gain, where the structure contributes least, HPC keeps the radius with 50 % and P with
    /// 100 %. A structural mode at ω reduces the required Kf² by 2·(1 − 2ζ²)·(Kp/ω)²: 0.007 at 83 Hz.
    #[test]
    fn hpc_needs_half_of_the_feedforward_of_p() {
        let hpc = radius_feedforward(Law::Hpc, 33.0).unwrap();
        assert!((49.0..51.0).contains(&hpc.motor_percent), "{hpc:?}");
        assert!((48.0..50.5).contains(&hpc.tool_percent), "{hpc:?}");
        // Without feed-forward a circle loses R·w²/8 under HPC and R·w²/2 under P, with w = ω/Kp, less the contribution
        // of the structure (0.02 of the former).
        let square = (FEED_M_PER_S / RADIUS_M / 33.0).powi(2);
        let lost = |factor: f64| factor * RADIUS_M * square;
        assert!((0.95..1.01).contains(&(hpc.shrinkage_m / lost(0.125))), "{hpc:?}");
        let p = radius_feedforward(Law::P, 33.0).unwrap();
        assert!((99.0..101.0).contains(&p.motor_percent), "{p:?}");
        assert!((0.95..1.01).contains(&(p.shrinkage_m / lost(0.5))), "{p:?}");
    }
}
