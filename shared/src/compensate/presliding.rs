//! Presliding friction over the distance travelled: bristles that bend (Canudas de Wit, Olsson, Åström, Lischinsky 1995).
//!
//! ```text
//! dF = σ₀·dx − σ₀·|dx|·F/g(v)          F → g(v)·sign(v) over the distance g/σ₀
//! over a tick:  F' = F + (g·sign(dx) − F)·(1 − e^(−u))          u = σ₀·|dx|/g(v)
//! ```
//!
//! The second line is the exact solution for a motion in one direction with g held over the tick; without it, a fast motion
//! (u > 2) would be unstable. All in integers, as fractions of the greatest g: the same in every number format.

use crate::config::ConfigError;
use crate::config::check::ranged;
use crate::integer::{mul_high_u32, shifted};
use crate::units::PER_M;

/// Fraction bits of the friction as a fraction of the greatest g.
pub const FRICTION_BITS: u32 = 60;

/// Greatest exponent u per tick: e^(−15) is 3e-7.
const MAX_EXPONENT: f64 = 15.0;

/// Least and greatest distance g/σ₀, m: 2²³ and 2⁴³ position units.
const DISTANCE_M: [f64; 2] = [8e-9, 8e-3];

/// Constants of the bristles.
#[derive(Clone, Copy, Debug)]
pub struct Presliding {
    /// Distances are shifted right by this, so that the greatest has at most 32 bits.
    distance_shift: u32,
    /// Distance of the greatest exponent, shifted.
    max_distance: u32,
    /// Exponent u/16 at the least g per shifted unit of distance, 64 − `exponent_shift` fraction bits.
    per_unit: u32,
    exponent_shift: u32,
}

impl Presliding {
    /// From σ₀ (N/m) and the least g (N).
    ///
    /// # Errors
    /// [`ConfigError`] with `force.friction.presliding_stiffness_n_per_m` if g/σ₀ is not from 8 nm to 8 mm.
    pub fn new(stiffness_n_per_m: f64, least_n: f64) -> Result<Self, ConfigError> {
        let [near, far] = DISTANCE_M;
        let stiffness = ranged(
            "force.friction.presliding_stiffness_n_per_m",
            stiffness_n_per_m,
            least_n / far,
            least_n / near,
        )?;
        let units = least_n / stiffness * PER_M;
        let max_distance = units * MAX_EXPONENT;
        let excess_bits = libm::ceil(libm::log2(max_distance)) - 32.0;
        let (distance_shift, exponent_shift) = (excess_bits.max(0.0), 1.0 - excess_bits.min(0.0));
        // max_distance·per_unit = 15/16·2⁶⁴/2^exponent_shift: with 31 to 32 bits of the distance, per_unit has 31 to 32.
        let per_unit = libm::exp2(60.0 + distance_shift - exponent_shift) / units;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to 15, 1 to 7, 32 bits"
        )]
        Ok(Self {
            distance_shift: distance_shift as u32,
            max_distance: (max_distance / libm::exp2(distance_shift)) as u32,
            per_unit: per_unit as u32,
            exponent_shift: exponent_shift as u32,
        })
    }

    /// The friction after a motion of `increment` position units, as a fraction of the greatest g with [`FRICTION_BITS`]
    /// fraction bits. `level_q31` is g at its speed in the same unit with 31 fraction bits, `least_over_level_q31` the least g
    /// over g at its speed.
    #[must_use]
    pub fn step(&self, friction: i64, increment: i64, level_q31: i32, least_over_level_q31: i32) -> i64 {
        let distance = shifted(increment.unsigned_abs(), self.distance_shift).min(self.max_distance);
        // u/16 with 32 fraction bits.
        let exponent = mul_high_u32(distance, self.per_unit) << (self.exponent_shift & 31);
        let exponent = mul_high_u32(exponent, least_over_level_q31.cast_unsigned() << 1);
        let settled_q31 = (settled_fraction(exponent) >> 1).cast_signed();
        // 28 fraction bits.
        let level = level_q31 >> 3;
        let target = if increment < 0 { -level } else { level };
        // 29 fraction bits: those of the friction without the 31 of the settled fraction.
        let difference = target.wrapping_sub(upper(friction)) << 1;
        friction.wrapping_add(i64::from(difference).wrapping_mul(i64::from(settled_q31)))
    }
}

/// A friction with 28 fraction bits.
#[must_use]
pub const fn upper(friction: i64) -> i32 {
    (friction >> 32) as i32
}

/// 1 − e^(−u) with 32 fraction bits, from u/16 with 32 fraction bits, at most 15/16.
///
/// t − t²/2 for t = u/16 has an error of t³/6; squaring e^(−t) four times makes that u³/1536 of e^(−u).
const fn settled_fraction(sixteenth_q32: u32) -> u32 {
    // 1 − (1 − d)² = 2d − d², below 1: the difference of two numbers modulo 2³² is it.
    const fn doubled(d: u32) -> u32 {
        (d << 1).wrapping_sub(mul_high_u32(d, d))
    }
    let t = sixteenth_q32;
    let settled = t - (mul_high_u32(t, t) >> 1);
    doubled(doubled(doubled(doubled(settled))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Position;

    /// 1 as a friction.
    const ONE: i64 = 1 << FRICTION_BITS;

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
    /// The result does not depend on the speed: the same at steps of 1 nm and of 700 nm for s = 2 µm, and of a fiftieth of that for 40 nm.
    #[test]
    fn the_friction_follows_the_distance() {
        let cases = [(60e6, [1e-9, 30e-9, 700e-9]), (3e9, [2e-11, 6e-10, 14e-9])];
        for (stiffness, step_m) in cases.into_iter().flat_map(|(n_per_m, steps)| steps.map(|m| (n_per_m, m)))
        {
            let g = 120.0;
            let presliding = Presliding::new(stiffness, g).unwrap();
            let step = Position::from_m(step_m).unwrap().0;
            // As rounded to a whole number of position units.
            let (step_m, distance_m) = (step as f64 / PER_M, g / stiffness);
            #[expect(clippy::cast_possible_truncation, reason = "thousands")]
            let there = (2.0 * distance_m / step_m) as i32;
            let mut friction = 0;
            let mut worst = 0.0f64;
            for k in 1..=2 * there {
                friction =
                    presliding.step(friction, if k > there { -step } else { step }, i32::MAX, i32::MAX);
                let turn_n = g * (1.0 - (-f64::from(there) * step_m / distance_m).exp());
                let exact = if k <= there {
                    g * (1.0 - (-f64::from(k) * step_m / distance_m).exp())
                } else {
                    -g + (turn_n + g) * (-f64::from(k - there) * step_m / distance_m).exp()
                };
                let newton = friction as f64 / ONE as f64 * g;
                worst = worst.max((newton - exact).abs());
            }
            // At 700 nm u is 0.35: u³/1536 = 2.8e-5 of 2g per tick, over 1/u ticks. At 1 nm each of 4000 ticks rounds u by 2⁻²⁸.
            assert!(worst < 0.02, "{step_m}: {worst} N");
            assert!(worst > 1e-9, "{step_m}: {worst} N, the rounding must show");
        }
    }

    /// A motion of many times the presliding distance in one tick is stable and ends at g.
    #[test]
    fn a_fast_motion_ends_at_the_level() {
        let presliding = Presliding::new(100e6, 100.0).unwrap();
        for increment in [1i64 << 36, 1 << 45, i64::MAX] {
            let friction = presliding.step(-ONE, increment, 1 << 30, i32::MAX);
            assert!((friction - ONE / 2).abs() < ONE / 10_000, "{increment}: {friction}");
        }
    }

    #[test]
    fn a_stiffness_that_is_not_resolved_is_refused() {
        let stiffness = |n_per_m| Presliding::new(n_per_m, 100.0).err();
        for n_per_m in [60e6, 12_600.0, 1.24e10] {
            assert_eq!(stiffness(n_per_m), None);
        }
        // 100 N over 8 mm and 8 nm.
        let name = "force.friction.presliding_stiffness_n_per_m";
        let error = ConfigError::OutOfRange { name, min: 100.0 / 8e-3, max: 100.0 / 8e-9 };
        for n_per_m in [0.0, 1e4, 1.26e10, 1e11] {
            assert_eq!(stiffness(n_per_m), Some(error), "{n_per_m}");
        }
    }
}
