//! Functions of a speed, with values from 0 to 1, on one grid: the place of a speed in the grid is found once for all of them.
//!
//! The points are evenly spaced within each octave, eight of them, so that they are dense towards standstill, where friction
//! changes. Below the lowest octave and between points the functions are linear; beyond the end they keep their last value.
//! All in integers: the same in every number format.
//!
//! # Example
//!
//! ```
//! use shared::compensate::speed_curves::SpeedCurves;
//!
//! // tanh(x/10⁹) and exp(−x/10⁹) for x up to 4·10⁹
//! let curves = SpeedCurves::new(4e9, |x| [libm::tanh(x / 1e9), libm::exp(-x / 1e9)]);
//! let [tanh, exp] = curves.at(700_000_000).map(|q31| f64::from(q31) / 2_147_483_648.0);
//! assert!((tanh - 0.7f64.tanh()).abs() < 2e-3 && (exp - (-0.7f64).exp()).abs() < 2e-3);
//! ```

use super::octave_curve::{POINTS_LOG2, point};
use crate::integer::{interpolated_q31, shifted};

/// Octaves between the linear part at zero and the end.
const OCTAVES: u32 = 24;

/// Bits of a speed within the grid.
const BITS: u32 = 32;

/// Bits of the end of the linear part at zero.
const LOWEST: u32 = BITS - OCTAVES;

/// The point at zero, those of the octaves, and that at the end.
const COUNT: usize = 2 + (OCTAVES << POINTS_LOG2) as usize;

/// K functions, 31 fraction bits.
#[derive(Clone, Copy, Debug)]
pub struct SpeedCurves<const K: usize> {
    values: [[i32; K]; COUNT],
    /// Speeds are shifted right by this, so that the end of the grid is 2³².
    shift: u32,
}

impl<const K: usize> SpeedCurves<K> {
    /// Functions of a speed in position units per tick, up to `end` or the next power of two, at least 2³². Their values are
    /// limited to 0 to 1.
    #[must_use]
    pub fn new(end: f64, values: impl Fn(f64) -> [f64; K]) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 30")]
        let shift = (libm::ceil(libm::log2(end)) - f64::from(BITS)).clamp(0.0, 30.0) as u32;
        let unit = libm::exp2(f64::from(shift));
        let values = core::array::from_fn(|index| {
            values(point(index, LOWEST) * unit).map(|value| {
                #[expect(clippy::cast_possible_truncation, reason = "saturates at 1")]
                let q31 = libm::rint(value.clamp(0.0, 1.0) * 2_147_483_648.0) as i32;
                q31
            })
        });
        Self { values, shift }
    }

    /// The values at a speed, 31 fraction bits.
    #[must_use]
    pub fn at(&self, speed: u64) -> [i32; K] {
        let x = shifted(speed, self.shift);
        let (index, fraction_q32) = if x >> LOWEST == 0 {
            (0, x << (32 - LOWEST))
        } else {
            let zeros = x.leading_zeros();
            let mantissa = x << zeros;
            // The leading bit itself adds 2³, one octave; the first octave begins at point 1.
            let octave = (OCTAVES - 1).wrapping_sub(zeros) << POINTS_LOG2;
            let step = (mantissa >> (31 - POINTS_LOG2)).wrapping_sub((1 << POINTS_LOG2) - 1);
            (octave.wrapping_add(step) as usize, mantissa << (1 + POINTS_LOG2))
        };
        let Some(&[from, to]) = self.values.get(index..).and_then(<[_]>::first_chunk) else {
            return [0; K];
        };
        let mut values = from;
        for (value, to) in values.iter_mut().zip(to) {
            *value = interpolated_q31(*value, to, fraction_q32);
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn fractions(curves: &SpeedCurves<2>, speed: f64) -> [f64; 2] {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive, below 2⁶⁰")]
        let units = speed as u64;
        curves.at(units).map(|q31| f64::from(q31) / 2_147_483_648.0)
    }

    proptest! {
        /// Linear interpolation over a width h is off by at most h²/8·|f''|; h is an eighth of the octave's start, x/8.
        /// For tanh x, x²·|tanh'' x| is at most 1.02 (at x = 1.5): 1.02/512 = 2.0e-3. For exp(−x²), x²·|4x² − 2|·exp(−x²) is at
        /// most 2.4 (at x = 1.8): 4.7e-3.
        #[test]
        fn the_curves_are_their_functions(x in 0.0..8.0f64, width_log2 in 16.0..55.0f64) {
            let width = width_log2.exp2();
            let curves = SpeedCurves::new(4.0 * width, |speed| {
                [libm::tanh(speed / width), libm::exp(-(speed / width) * (speed / width))]
            });
            let [tanh, gauss] = fractions(&curves, x * width);
            // A speed is rounded to a unit, which matters for the narrowest.
            let unit = 1.0 / width;
            prop_assert!((tanh - x.tanh()).abs() < 2.1e-3 + unit, "{tanh}");
            prop_assert!((gauss - (-x * x).exp()).abs() < 4.8e-3 + unit, "{gauss}");
        }

        /// Straight lines are reproduced to the rounding of speed (2⁻³² of the end) and value (two units of 2⁻³¹).
        #[test]
        fn straight_lines_stay_straight(x in 0.0..1.0f64, end_log2 in 32.0..62.0f64) {
            let end = end_log2.ceil().exp2();
            let lines = SpeedCurves::new(end, |speed| [speed / end, 1.0 - speed / end]);
            let [rising, falling] = fractions(&lines, x * end);
            prop_assert!((rising - x).abs() < 2e-9, "{rising}");
            prop_assert!((falling - (1.0 - x)).abs() < 2e-9, "{falling}");
        }
    }

    /// Below the lowest octave, 2⁸ units, a curve is straight, from its value at zero to that at 256.
    #[test]
    fn towards_standstill_the_curves_are_straight() {
        let curves = SpeedCurves::new(1e9, |speed| [f64::from(speed < 1.0), speed / 512.0]);
        for speed in [0u32, 1, 64, 255, 256] {
            let part = f64::from(speed) / 256.0;
            let [falling, rising] = fractions(&curves, f64::from(speed));
            assert!((falling - (1.0 - part)).abs() < 2e-9 && (rising - part / 2.0).abs() < 2e-9, "{speed}");
        }
    }

    #[test]
    fn beyond_their_end_the_curves_keep_the_last_value() {
        let curves = SpeedCurves::new(1e12, |speed| [speed / 4e12, 1.0]);
        // The end is the next power of two, 2⁴⁰ = 1.0995e12.
        let last = curves.at(1 << 40);
        assert_eq!(curves.at(u64::MAX), last);
        assert!((f64::from(last[0]) / 2_147_483_648.0 - 0.274_878).abs() < 1e-6);
        assert_eq!(last[1], i32::MAX);
    }
}
