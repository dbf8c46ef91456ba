//! Presliding friction over the distance travelled: bristles that bend (Canudas de Wit, Olsson, Åström, Lischinsky 1995).
//!
//! ```text
//! dF = σ₀·dx − σ₀·|dx|·F/g(v)          F → g(v)·sign(v) over the distance g/σ₀
//! over a tick:  F' = F + (g·sign(dx) − F)·(1 − e^(−u))          u = σ₀·|dx|/g(v)
//! ```
//!
//! The second line is the exact solution for a motion in one direction with g held over the tick; without it, a fast motion
//! (u > 2) would be unstable. All in integers, as fractions of the greatest g: the same in every number format.

use super::octave_curve::OctaveCurve;
use crate::config::ConfigError;
use crate::config::check::ranged;
use crate::integer::mul_q32;
use crate::units::PER_M;

/// 1 in the fractions of the friction, 31 fraction bits.
pub const ONE: i64 = 1 << 31;

/// Greatest exponent u per tick: e^(−15) is 3e-7.
const MAX_EXPONENT: u64 = 15;

/// Least and greatest distance g/σ₀, m: 2²³ and 2⁴³ position units.
const DISTANCE_M: [f64; 2] = [8e-9, 8e-3];

/// Constants of the bristles.
#[derive(Clone, Copy, Debug)]
pub struct Presliding {
    /// Exponent per position unit at the least g, 60 fraction bits.
    per_unit_q60: u64,
    /// Distance of the greatest exponent, position units.
    max_distance: u64,
    /// The least g over g(v); `None`: g is constant.
    least_over_level: Option<OctaveCurve>,
}

impl Presliding {
    /// From σ₀ (N/m) and the least g (N), and how that compares with g over the speed.
    ///
    /// # Errors
    /// [`ConfigError`] with `presliding_stiffness_n_per_m` if g/σ₀ is not from 8 nm to 8 mm.
    pub fn new(
        stiffness_n_per_m: f64,
        least_n: f64,
        least_over_level: Option<OctaveCurve>,
    ) -> Result<Self, ConfigError> {
        let [near, far] = DISTANCE_M;
        let stiffness =
            ranged("presliding_stiffness_n_per_m", stiffness_n_per_m, least_n / far, least_n / near)?;
        let units = least_n / stiffness * PER_M;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "2¹⁷ to 2³⁷, 2²³ to 2⁴³")]
        let (per_unit_q60, max_distance) =
            (libm::rint(libm::exp2(60.0) / units) as u64, units as u64 * MAX_EXPONENT);
        Ok(Self { per_unit_q60, max_distance, least_over_level })
    }

    /// The least g over g at a speed (position units per tick), 32 fraction bits.
    #[must_use]
    pub fn least_over_level(&self, speed: u64) -> u32 {
        self.least_over_level.as_ref().map_or(u32::MAX, |curve| curve.at(speed))
    }

    /// The friction after a motion of `increment` position units, as a fraction of the greatest g with 31 fraction bits.
    /// `level` is g at its speed in the same unit, `least_over_level` is [`Presliding::least_over_level`] of its speed.
    #[must_use]
    pub fn step(&self, friction: i64, increment: i64, level: i64, least_over_level: u32) -> i64 {
        let distance = increment.unsigned_abs();
        // u/16 with 32 fraction bits.
        let exponent = (distance.min(self.max_distance) * self.per_unit_q60) >> 32;
        let exponent = mul_q32(exponent.cast_signed(), least_over_level);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2³²")]
        let settled = settled_fraction(exponent as u32);
        let target = if increment < 0 { -level } else { level };
        friction + mul_q32(target - friction, settled)
    }
}

/// 1 − e^(−u) with 32 fraction bits, from u/16 with 32 fraction bits.
///
/// t − t²/2 for t = u/16 has an error of t³/6; squaring e^(−t) four times makes that u³/1536 of e^(−u).
fn settled_fraction(sixteenth_q32: u32) -> u32 {
    let square = |q32: u64| (q32 * q32) >> 32;
    let t = u64::from(sixteenth_q32);
    let mut settled = t - (square(t) >> 1);
    for _ in 0..4 {
        // 1 − (1 − d)² = 2d − d²
        settled = 2 * settled - square(settled);
    }
    u32::try_from(settled).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Position;

    #[test]
    fn the_settled_fraction_is_that_of_an_exponential() {
        for sixteenth in [0.0, 1e-6, 1e-3, 0.01, 0.05, 0.1, 0.3, 0.6, 0.93] {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 1")]
            let settled = f64::from(settled_fraction((sixteenth * 4_294_967_296.0) as u32)) / 4_294_967_296.0;
            let u: f64 = 16.0 * sixteenth;
            let (exact, off) = (-(-u).exp_m1(), u.powi(3) / 1536.0 * (-u).exp());
            // Beyond u = 4 the next terms count: at u = 4.8, (1 − 0.3 + 0.045)¹⁶ is 0.0090 where e^(−u) is 0.0082.
            let bound = if u > 4.0 { 1e-3 } else { 1.5 * off };
            assert!((settled - exact).abs() < bound + 1e-8, "u = {u}: {settled}, {exact}");
        }
    }

    /// From rest the friction is g(1 − e^(−x/s)) with s = g/σ₀; after a reversal, −g + 2g·e^(−x/s) over the distance from it.
    /// The result does not depend on the speed: the same at steps of 1 nm and of 700 nm.
    #[test]
    fn the_friction_follows_the_distance() {
        let (g, stiffness) = (120.0, 60e6);
        let presliding = Presliding::new(stiffness, g, None).unwrap();
        for step_m in [1e-9, 30e-9, 700e-9] {
            let step = Position::from_m(step_m).unwrap().0;
            #[expect(clippy::cast_possible_truncation, reason = "thousands")]
            let there = (4e-6 / step_m) as i32;
            let mut friction = 0;
            let mut worst = 0.0f64;
            for k in 1..=2 * there {
                friction = presliding.step(friction, if k > there { -step } else { step }, ONE, u32::MAX);
                let turn_n = g * (1.0 - (-f64::from(there) * step_m / 2e-6).exp());
                let exact = if k <= there {
                    g * (1.0 - (-f64::from(k) * step_m / 2e-6).exp())
                } else {
                    -g + (turn_n + g) * (-f64::from(k - there) * step_m / 2e-6).exp()
                };
                let newton = friction as f64 / ONE as f64 * g;
                worst = worst.max((newton - exact).abs());
            }
            // At 700 nm u is 0.35: u³/1536 = 2.8e-5 of 2g per tick, over 1/u ticks. At 1 nm each of 4000 ticks rounds by 2⁻³¹.
            assert!(worst < 0.02, "{step_m}: {worst} N");
            assert!(worst > 1e-9, "{step_m}: {worst} N, the rounding must show");
        }
    }

    /// A motion of many times the presliding distance in one tick is stable and ends at g.
    #[test]
    fn a_fast_motion_ends_at_the_level() {
        let presliding = Presliding::new(100e6, 100.0, None).unwrap();
        for increment in [1i64 << 36, 1 << 45, i64::MAX] {
            let friction = presliding.step(-ONE, increment, ONE / 2, u32::MAX);
            assert!((friction - ONE / 2).abs() < ONE / 10_000, "{increment}: {friction}");
        }
    }

    #[test]
    fn a_stiffness_that_is_not_resolved_is_refused() {
        let stiffness = |n_per_m| Presliding::new(n_per_m, 100.0, None).err();
        assert_eq!(stiffness(60e6), None);
        for n_per_m in [0.0, 1e4, 1e11] {
            assert!(
                matches!(
                    stiffness(n_per_m),
                    Some(ConfigError::OutOfRange { name: "presliding_stiffness_n_per_m", .. })
                ),
                "{n_per_m}"
            );
        }
    }
}
