//! Sine and cosine in integer arithmetic: a table of 2049 values and a short series between them.
//!
//! The angle is an unsigned phase, 2⁶⁴ per turn. The nearest of 8192 tabulated angles leaves |δ| ≤ π/8192, less than 2⁻¹¹,
//! for which sin δ = δ − δ³/6 and 1 − cos δ = δ²/2 − δ⁴/24 have errors below 1e-19. With the rounding of the products the
//! error is at most [`ERROR`] (verified by a test), a quarter of a position unit on a radius of 1 m. It has to be that
//! small because noise of the command appears in its second difference: 1 unit is 0.4 µm/s² at 20 kHz.
//!
//! # Example
//!
//! ```
//! use shared::interpolate::sincos::{ERROR, ONE, sin_cos};
//!
//! let (sine, cosine) = sin_cos(1 << 61); // an eighth of a turn
//! let exact = 0.5f64.sqrt();
//! assert!((sine as f64 / ONE as f64 - exact).abs() < ERROR && (cosine as f64 / ONE as f64 - exact).abs() < ERROR);
//! ```

use crate::integer::mul_high;

/// The number 1 as a result of [`sin_cos`]: 62 fraction bits.
pub const ONE: i64 = 1 << 62;

/// Greatest error of [`sin_cos`].
pub const ERROR: f64 = 2.5e-16;

/// 2π with 60 fraction bits.
const TAU_Q60: i64 = 7_244_019_458_077_122_842;

/// Table steps per quarter turn.
const STEPS: usize = 2048;

/// Bits of the phase within a table step.
const STEP_BITS: u32 = 51;

/// sin(2π·k/8192) for k = 0 … 2048, with 62 fraction bits: 16 kB.
static QUARTER: [i64; STEPS + 1] = quarter();

/// The table by the Taylor series of the sine, with 62 fraction bits, at compile time.
#[expect(clippy::large_stack_arrays, reason = "evaluated at compile time")]
const fn quarter() -> [i64; STEPS + 1] {
    let mut table = [0i64; STEPS + 1];
    let mut k = 0;
    while k <= STEPS {
        let angle = (k as i128 * TAU_Q60 as i128) >> 11;
        let square = (angle * angle) >> 62;
        let mut term = angle;
        let mut sum = angle;
        let mut n = 1;
        // (π/2)²⁷/27! < 2⁻⁶²
        while n <= 12 {
            term = -((term * square) >> 62) / ((2 * n) * (2 * n + 1));
            sum += term;
            n += 1;
        }
        #[expect(clippy::cast_possible_truncation, reason = "|sine| ≤ 1")]
        {
            table[k] = if sum > ONE as i128 { ONE } else { sum as i64 };
        }
        k += 1;
    }
    table
}

/// Sine and cosine of a tabulated angle, k/8192 of a turn.
fn tabulated(k: usize) -> (i64, i64) {
    let step = k & (STEPS - 1);
    // The index is at most 2048; `get` compiles to no panic.
    let at = |i: usize| QUARTER.get(i).copied().unwrap_or(ONE);
    let (rising, falling) = (at(step), at(STEPS - step));
    match (k / STEPS) & 3 {
        0 => (rising, falling),
        1 => (falling, -rising),
        2 => (-rising, -falling),
        _ => (-falling, rising),
    }
}

/// Number of the angles of [`sine_q14`] in a turn.
#[expect(clippy::cast_possible_truncation, reason = "8192")]
pub const SINE_STEPS: u16 = 4 * STEPS as u16;

/// Sine of the angle step/[`SINE_STEPS`] of a turn, modulo whole turns, with 14 fraction bits: rounded to 2⁻¹⁵.
#[must_use]
pub fn sine_q14(step: u16) -> i32 {
    /// Bits below the 14 that remain.
    const DROPPED: u32 = 62 - 14;
    let (sine, _) = tabulated(usize::from(step));
    // Within ± 2¹⁴.
    ((sine + (1 << (DROPPED - 1))) >> DROPPED) as i32
}

/// Sine and cosine of `phase`/2⁶⁴ of a turn, in units of 1/[`ONE`], each within [`ERROR`].
#[must_use]
#[inline(never)]
#[expect(clippy::cast_possible_truncation, reason = "the upper 32 bits of each number are used")]
pub fn sin_cos(phase: u64) -> (i64, i64) {
    let nearest = phase.wrapping_add(1 << (STEP_BITS - 1)) >> STEP_BITS;
    let (sine, cosine) = tabulated(nearest as usize);

    // δ = 2π·residual/2⁶⁴, |residual| ≤ 2⁵⁰: |δ| < 2⁶¹ with 72 fraction bits.
    let residual = phase.wrapping_sub(nearest << STEP_BITS).cast_signed();
    let delta = mul_high(residual << 12, TAU_Q60);
    // δ² and δ³ are below 2⁻²² and 2⁻³³: 32 bits of δ suffice, with 42 fraction bits.
    let short = i64::from((delta >> 30) as i32);
    // δ²/2 with 54 fraction bits, below 2³¹, and δ⁴/24 = (δ²/2)²/6, below 16 in the same units.
    let half_square = i64::from(((short * short) >> 31) as i32);
    let fourth = (i64::from(((half_square * half_square) >> 48) as i32) * 683) >> 18;
    let versine = i64::from((half_square - fourth) as i32);
    // δ³/6 = δ·(δ²/2)/3 with 72 fraction bits.
    let cube_sixth = (i64::from(((short * half_square) >> 32) as i32) * THIRD_Q31) >> 23;
    let sin_delta = delta - cube_sixth;

    let times_versine = |value: i64| (i64::from((value >> 32) as i32) * versine) >> 22;
    (
        sine - times_versine(sine) + (mul_high(cosine, sin_delta) >> 8),
        cosine - times_versine(cosine) - (mul_high(sine, sin_delta) >> 8),
    )
}

/// 1/3 with 31 fraction bits.
const THIRD_Q31: i64 = 715_827_883;

#[cfg(test)]
mod tests {
    use super::*;

    /// The angle to 1e-30 as the sum of two doubles, and its sine and cosine by the addition theorem. The sine of `libm` is
    /// accurate to 1e-16, so an error of 3e-16 is detected. (Miri deliberately degrades that of the host.)
    fn exact(phase: u64) -> (f64, f64) {
        // 2π to 106 bits.
        const TAU: [f64; 2] = [core::f64::consts::TAU, 2.449_293_598_294_706_4e-16];
        let upper = (phase >> 32) as f64 / 4_294_967_296.0;
        let lower = (phase & 0xffff_ffff) as f64 / 18_446_744_073_709_551_616.0;
        // The rounding error of the product, by a fused multiply-add.
        let product = upper * TAU[0];
        let residual = f64::mul_add(upper, TAU[0], -product) + upper * TAU[1] + lower * TAU[0];
        let (s, c) = (libm::sin(product), libm::cos(product));
        (s + c * residual, c - s * residual)
    }

    #[test]
    fn is_within_the_stated_error_everywhere() {
        let mut worst = 0.0f64;
        let count = if cfg!(miri) { 1_000 } else { 200_000 };
        // A prime stride covers the whole turn and every offset from the tabulated angles.
        let mut phase = 0u64;
        for _ in 0..count {
            let (s, c) = sin_cos(phase);
            let (sine, cosine) = exact(phase);
            // In two parts: a double has 53 bits and the result 62.
            let off = |q62: i64, exact: f64| {
                let upper = (exact * 4_294_967_296.0).floor();
                let lower = exact - upper / 4_294_967_296.0;
                #[expect(clippy::cast_possible_truncation, reason = "33 bits")]
                let difference = q62 - ((upper as i64) << 30);
                (difference as f64 / ONE as f64 - lower).abs()
            };
            worst = worst.max(off(s, sine)).max(off(c, cosine));
            phase = phase.wrapping_add(92_233_720_368_547_759);
        }
        assert!(worst < ERROR, "{worst:e}");
        assert!(worst > 2e-17, "an error this small would mean that nothing was tested: {worst:e}");
    }

    /// To nearest, by half a step and what the 62 bits of the table have left.
    #[test]
    fn the_sine_of_a_table_is_rounded_to_nearest() {
        for step in 0..SINE_STEPS {
            let exact =
                16_384.0 * libm::sin(core::f64::consts::TAU * f64::from(step) / f64::from(SINE_STEPS));
            let off = f64::from(sine_q14(step)) - exact;
            assert!(off.abs() <= 0.5 + 1e-9, "{step}: {off}");
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        assert_eq!(sin_cos(0), (0, ONE));
        assert_eq!(sin_cos(1 << 62), (ONE, 0));
        assert_eq!(sin_cos(1 << 63), (0, -ONE));
        assert_eq!(sin_cos(3 << 62), (-ONE, 0));
    }
}
