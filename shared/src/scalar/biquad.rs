//! A second-order section in integers: direct form I with error feedback.
//!
//! ```text
//! y + e' = b₀x + b₁x₁ + b₂x₂ − a₁y₁ − a₂y₂ + e
//! ```
//!
//! The products are exact in 64 bits. The part e' below the resolution of y enters the next sum, so that no error accumulates:
//! for a constant input the output settles at it exactly, since b₀ + b₁ + b₂ = 1 + a₁ + a₂ also holds for the rounded
//! coefficients. The core has one instruction for each product with its addition (`SMLAL`).

/// Fraction bits of the coefficients, whose magnitudes are below 2: the sum of |b| and |a| is at most 7, so that the sum of
/// products does not exceed 64 bits.
const BITS: u32 = 29;

/// 1 as a coefficient.
const ONE: i32 = 1 << BITS;

/// Coefficients b₀, b₁, b₂ and −a₁, −a₂.
#[derive(Clone, Copy, Debug)]
pub struct Biquad {
    b: [i32; 3],
    minus_a: [i32; 2],
}

/// The last inputs and outputs, and e with [`BITS`] fraction bits.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    inputs: [i32; 2],
    outputs: [i32; 2],
    error: u32,
}

impl State {
    /// Settled at zero.
    pub const AT_REST: Self = Self::settled(0);

    /// Settled at a constant input.
    #[must_use]
    pub const fn settled(value: i32) -> Self {
        Self { inputs: [value; 2], outputs: [value; 2], error: 0 }
    }
}

impl Biquad {
    /// The bilinear transform with g = tan(πf/rate) of a low-pass filter, ω₀²/(s² + kω₀s + ω₀²), or of a notch filter of a
    /// depth d, (s² + (1 − d)·kω₀s + ω₀²)/(s² + kω₀s + ω₀²).
    #[must_use]
    pub fn new(g: f64, k: f64, notch_depth: Option<f64>) -> Self {
        let denominator = 1.0 + g * (g + k);
        #[expect(clippy::cast_possible_truncation, reason = "magnitudes below 2")]
        let rounded = |value: f64| libm::rint(value / denominator * f64::from(ONE)) as i32;
        let (a1, a2) = (rounded(2.0 * (g * g - 1.0)), rounded(1.0 - g * k + g * g));
        let [b0, b2] = match notch_depth {
            None => [rounded(g * g); 2],
            Some(depth) => [1.0, -1.0].map(|sign| rounded(1.0 + sign * (1.0 - depth) * g * k + g * g)),
        };
        let b1 = ONE.wrapping_add(a1).wrapping_add(a2).wrapping_sub(b0).wrapping_sub(b2);
        Self { b: [b0, b1, b2], minus_a: [-a1, -a2] }
    }

    /// The output for one input, saturated to within 7 steps of the range of 32 bits.
    pub fn step(&self, state: &mut State, input: i32) -> i32 {
        let product = |a: i32, b: i32| i64::from(a).wrapping_mul(i64::from(b));
        let ([b0, b1, b2], [a1, a2]) = (self.b, self.minus_a);
        let ([x1, x2], [y1, y2]) = (state.inputs, state.outputs);
        let sum = i64::from(state.error)
            .wrapping_add(product(b0, input))
            .wrapping_add(product(b1, x1))
            .wrapping_add(product(b2, x2))
            .wrapping_add(product(a1, y1))
            .wrapping_add(product(a2, y2));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the two words")]
        let (low, high) = (sum as u32, (sum >> 32) as i32);
        // `SSAT`
        let high = high.clamp(-(1 << (BITS - 1)), (1 << (BITS - 1)) - 1);
        let output = (high << (32 - BITS)) | (low >> BITS).cast_signed();
        *state = State { inputs: [input, x1], outputs: [output, y1], error: low & (ONE.cast_unsigned() - 1) };
        output
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Against the same recursion with 128 bits, which cannot overflow: at the ends of the range of 32 bits too.
        #[test]
        fn the_sum_does_not_overflow(
            inputs in prop::collection::vec(prop_oneof![any::<i32>(), Just(i32::MAX), Just(i32::MIN)], 1..100),
            g in 3e-3..6.0f64, k in 0.01..20.0f64, depth in prop::option::of(0.0..=1.0f64),
        ) {
            let biquad = Biquad::new(g, k, depth);
            let mut state = State::AT_REST;
            for input in inputs {
                let ([b0, b1, b2], [a1, a2]) = (biquad.b, biquad.minus_a);
                let terms = [
                    (b0, input), (b1, state.inputs[0]), (b2, state.inputs[1]), (a1, state.outputs[0]), (a2, state.outputs[1]),
                ];
                let exact = terms.into_iter().fold(i128::from(state.error), |sum, (a, b)| sum + i128::from(a) * i128::from(b));
                let output = biquad.step(&mut state, input);
                let clamped = (exact >> BITS).clamp(-(1 << 31), (1 << 31) - 1);
                prop_assert!((i128::from(output) - clamped).abs() <= 7, "{output}, {clamped}");
                prop_assert_eq!(i128::from(state.error), exact & (i128::from(ONE) - 1));
            }
        }

        /// The gain at zero frequency is one for the rounded coefficients.
        #[test]
        fn a_constant_passes_unchanged(value: i32, g in 3e-3..6.0f64, k in 0.01..20.0f64, depth in prop::option::of(0.0..=1.0f64)) {
            let biquad = Biquad::new(g, k, depth);
            let mut state = State::settled(value);
            for _ in 0..10 {
                prop_assert_eq!(biquad.step(&mut state, value), value);
            }
        }
    }
}
