//! A function of a magnitude (a speed, a time) from 0 to 1, with points that are evenly spaced within each octave: dense
//! towards zero, where friction changes.
//!
//! All in integers: the same in every number format. Below the lowest octave and between points it is linear; beyond its
//! end it keeps the last value.
//!
//! # Example
//!
//! ```
//! use shared::compensate::octave_curve::OctaveCurve;
//!
//! // tanh(x/10⁹) for x up to 4·10⁹ and beyond
//! let curve = OctaveCurve::new(4e9, |x| libm::tanh(x / 1e9));
//! let value = f64::from(curve.at(700_000_000)) / 4_294_967_296.0;
//! assert!((value - 0.7f64.tanh()).abs() < 2e-3);
//! ```

use crate::integer::mul_q32;

/// Octaves between the linear part at zero and the end.
const OCTAVES: u32 = 8;

/// Points per octave, as a power of two: 8.
pub(super) const POINTS_LOG2: u32 = 3;

/// Bits of a magnitude within the curve.
const BITS: u32 = 26;

/// Bits of the end of the linear part at zero.
const LOWEST: u32 = BITS - OCTAVES;

/// The point at zero, those of the octaves, and that at the end.
const COUNT: usize = 2 + (OCTAVES << POINTS_LOG2) as usize;

/// Where a point is, in units of the lowest bit. Point 0 is at zero, and point 1 at the end of the linear part, 2^`lowest`; from
/// there on, each octave has 2^[`POINTS_LOG2`] equal steps.
pub(super) fn point(index: usize, lowest: u32) -> f64 {
    let Some(index) = index.checked_sub(1) else { return 0.0 };
    let (octave, step) = (index >> POINTS_LOG2, index & ((1 << POINTS_LOG2) - 1));
    let steps = libm::exp2(-f64::from(POINTS_LOG2)) * step as f64;
    libm::exp2(f64::from(lowest) + octave as f64) * (1.0 + steps)
}

/// Values from 0 to 1 with 32 fraction bits.
#[derive(Clone, Copy, Debug)]
pub struct OctaveCurve {
    values: [u32; COUNT],
    /// Magnitudes below 2 to this power are within the curve.
    end_bits: u32,
}

impl OctaveCurve {
    /// A function of a magnitude in whole units, up to `end` units or the next power of two. Its values are limited to 0 to 1.
    #[must_use]
    pub fn new(end: f64, value: impl Fn(f64) -> f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "8 to 62")]
        let end_bits = libm::ceil(libm::log2(end)).clamp(f64::from(OCTAVES), 62.0) as u32;
        let unit = libm::exp2(f64::from(end_bits) - f64::from(BITS));
        let values = core::array::from_fn(|index| {
            let fraction = value(point(index, LOWEST) * unit).clamp(0.0, 1.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates below 1")]
            let fraction_q32 = (fraction * 4_294_967_296.0) as u32;
            fraction_q32
        });
        Self { values, end_bits }
    }

    /// The value at a magnitude, with 32 fraction bits.
    #[must_use]
    pub fn at(&self, magnitude: u64) -> u32 {
        if magnitude >> self.end_bits != 0 {
            return self.value(COUNT - 1);
        }
        // One of the shifts is by zero.
        #[expect(clippy::cast_possible_truncation, reason = "26 bits")]
        let x =
            ((magnitude << BITS.saturating_sub(self.end_bits)) >> self.end_bits.saturating_sub(BITS)) as u32;
        let (index, fraction_q32) = if x >> LOWEST == 0 {
            (0, x << (32 - LOWEST))
        } else {
            let leading = x.checked_ilog2().unwrap_or(LOWEST);
            let rest_bits = leading - POINTS_LOG2;
            // The leading bit itself adds 2³, one octave.
            let index = ((leading - LOWEST) << POINTS_LOG2) + (x >> rest_bits) - (1 << POINTS_LOG2) + 1;
            (index as usize, x << (32 - rest_bits))
        };
        let (from, to) = (i64::from(self.value(index)), i64::from(self.value(index + 1)));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two values")]
        let between = (from + mul_q32(to - from, fraction_q32)) as u32;
        between
    }

    fn value(&self, index: usize) -> u32 {
        self.values.get(index).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn fraction(curve: &OctaveCurve, magnitude: f64) -> f64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive, below 2⁵⁰")]
        let units = magnitude as u64;
        f64::from(curve.at(units)) / 4_294_967_296.0
    }

    proptest! {
        /// Linear interpolation over a width h is off by at most h²/8·|f''|; h is an eighth of the octave's start, x/8.
        /// For tanh x, x²·|tanh'' x| is at most 1.02 (at x = 1.5): 1.02/512 = 2.0e-3. For exp(−x²), x²·|4x² − 2|·exp(−x²) is at
        /// most 2.4 (at x = 1.8): 4.7e-3. Below the lowest point, at most 8/256 of the width, x² itself: 1e-3.
        #[test]
        fn a_curve_is_its_function(x in 0.0..8.0f64, width_log2 in 16.0..45.0f64) {
            let width = width_log2.exp2();
            let tanh = OctaveCurve::new(4.0 * width, |magnitude| libm::tanh(magnitude / width));
            let gauss = OctaveCurve::new(4.0 * width, |magnitude| libm::exp(-(magnitude / width) * (magnitude / width)));
            let [at_tanh, at_gauss] = [&tanh, &gauss].map(|curve| fraction(curve, x * width));
            prop_assert!((at_tanh - x.tanh()).abs() < 2.1e-3, "{at_tanh}");
            prop_assert!((at_gauss - (-x * x).exp()).abs() < 4.8e-3, "{at_gauss}");
        }

        /// A straight line is reproduced to the rounding of magnitude (2⁻²⁶ of the end) and value.
        #[test]
        fn a_straight_line_stays_straight(x in 0.0..1.0f64, end_log2 in 26.0..60.0f64) {
            let end = end_log2.ceil().exp2();
            let line = OctaveCurve::new(end, |magnitude| magnitude / end);
            prop_assert!((fraction(&line, x * end) - x).abs() < 2e-8);
        }
    }

    /// A magnitude of few bits, such as a number of ticks: every whole value is on the curve.
    #[test]
    fn a_short_curve_is_exact_to_its_interpolation() {
        let curve = OctaveCurve::new(16_000.0, |ticks| libm::exp(-ticks / 2000.0));
        for ticks in 0..20_000 {
            let exact = (-f64::from(ticks.min(16_384)) / 2000.0).exp();
            // h²/8·f'' with h = x/8: (x/τ)²·e^(−x/τ)/512, at most 0.54/512.
            assert!((fraction(&curve, f64::from(ticks)) - exact).abs() < 1.1e-3, "{ticks}");
        }
    }

    #[test]
    fn beyond_its_end_a_curve_keeps_the_last_value() {
        let curve = OctaveCurve::new(1e12, |magnitude| magnitude / 4e12);
        // The end is the next power of two, 2⁴⁰ = 1.0995e12.
        let last = curve.at(1 << 40);
        assert_eq!(curve.at(u64::MAX), last);
        assert!((f64::from(last) / 4_294_967_296.0 - 0.274_878).abs() < 1e-6);
    }
}
