//! The feed-forward of least circle shrinkage.
//!
//! A linear loop turns a circle of radius R into one of |1 + j·Kf·ω/Kp|·|G(jω)|·R: its square is linear in Kf²,
//! so that two circles, without feed-forward and with all of it, tell which Kf keeps the radius.

use std::f64::consts::TAU;

use super::contour::radius_m;
use super::machine::{self, FEED_M_PER_S, Motion, RADIUS_M, Track, Tuning};
use crate::reproduce::ReproduceError;
use model::axis::Law;

/// When the loop has forgotten the start of the circle, s: dwell, and half a turn.
const BEGIN_S: f64 = 0.2 + 0.5 * TAU * RADIUS_M / FEED_M_PER_S;

/// Kf that keeps the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept {
    /// At the motors, %.
    pub motor_percent: f64,
    /// At the tool, %.
    pub tool_percent: f64,
    /// What the tool's circle loses without feed-forward, m.
    pub shrinkage_m: f64,
}

/// The feed-forward that keeps a circle's radius on the plant.
///
/// # Errors
/// When a loop does not hold.
pub fn kept(law: Law, gain_per_s: f64) -> Result<Kept, ReproduceError> {
    let run = |feedforward_percent| machine::circle(Tuning { law, gain_per_s, feedforward_percent });
    let (without, full) = (run(0.0)?, run(100.0)?);
    let percent = |track: fn(&Motion) -> &Track| {
        feedforward_percent(RADIUS_M, radius(&without, track), radius(&full, track))
    };
    Ok(Kept {
        motor_percent: percent(|motion| &motion.motor),
        tool_percent: percent(|motion| &motion.tool),
        shrinkage_m: RADIUS_M - radius(&without, |motion| &motion.tool),
    })
}

/// Kf (%) of the radius `asked`, of the radii without feed-forward and with 100 %. NaN where none gives it.
fn feedforward_percent(asked: f64, without: f64, full: f64) -> f64 {
    let square = (asked.powi(2) - without.powi(2)) / (full.powi(2) - without.powi(2));
    1e2 * square.sqrt()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand samples")]
fn radius(motion: &Motion, track: fn(&Motion) -> &Track) -> f64 {
    let begin = (BEGIN_S / motion.sample_s).round() as usize;
    let turn = (TAU * RADIUS_M / FEED_M_PER_S / motion.sample_s).round() as usize;
    radius_m(track(motion), &motion.command, machine::centre_m(), &(begin..begin + turn))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// |1 + jKf·w|²·256/(256 + 64w² + 4w⁴ + w⁶) = 1 of HPC gives Kf² = 1/4 + w²/64 + w⁴/256, w = ω/Kp.
    #[test]
    fn two_radii_tell_the_feedforward_of_hpc() {
        let w = 0.3_f64;
        let radius = |kf: f64| {
            let loss = 256.0 + 64.0 * w.powi(2) + 4.0 * w.powi(4) + w.powi(6);
            ((1.0 + (kf * w).powi(2)) * 256.0 / loss).sqrt()
        };
        let exact = 1e2 * (0.25 + w.powi(2) / 64.0 + w.powi(4) / 256.0).sqrt();
        assert!((feedforward_percent(1.0, radius(0.0), radius(1.0)) - exact).abs() < 1e-9);
        assert!(feedforward_percent(1.0, 1.001, 1.002).is_nan());
    }

    /// On the plant at the lowest gain, where the machine's swing adds least: HPC keeps the radius with 50 %, P
    /// with 100 %. A swing of ω adds 2·(1 − 2ζ²)·(Kp/ω)² to what Kf² need not give: 0.007 at 83 Hz.
    #[test]
    fn hpc_needs_half_of_the_feedforward_of_p() {
        let hpc = kept(Law::Hpc, 33.0).unwrap();
        assert!((49.0..51.0).contains(&hpc.motor_percent), "{hpc:?}");
        assert!((48.0..50.5).contains(&hpc.tool_percent), "{hpc:?}");
        // Without feed-forward a circle loses R·w²/8 under HPC and R·w²/2 under P, w = ω/Kp, less what the swing adds
        // (0.02 of the first).
        let square = (FEED_M_PER_S / RADIUS_M / 33.0).powi(2);
        let lost = |share: f64| share * RADIUS_M * square;
        assert!((0.95..1.01).contains(&(hpc.shrinkage_m / lost(0.125))), "{hpc:?}");
        let p = kept(Law::P, 33.0).unwrap();
        assert!((99.0..101.0).contains(&p.motor_percent), "{p:?}");
        assert!((0.95..1.01).contains(&(p.shrinkage_m / lost(0.5))), "{p:?}");
    }
}
