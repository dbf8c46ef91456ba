//! Sine and cosine of a turn by integers: 513 tabled values and a short series between them.
//!
//! The angle is an unsigned phase, 2⁶⁴ a turn. The nearest of 2048 tabled angles leaves |δ| ≤ π/2048,
//! where sin δ = δ − δ³/6 and 1 − cos δ = δ²/2 − δ⁴/24 leave out less than 7.1e-17. With the rounding of
//! the products the result is within [`ERROR`] (measured: see the test): a third of a position unit on a
//! radius of 1 m. It has to be so small because noise in the command is noise in its second difference:
//! 1 unit is 0.4 µm/s² at 20 kHz.

/// One as a result of [`sin_cos`].
pub const ONE: i64 = 1 << 62;

/// Greatest error of [`sin_cos`], of one.
pub const ERROR: f64 = 3e-16;

/// 2π with 60 fraction bits.
const TAU_Q60: i64 = 7_244_019_458_077_122_842;

/// Steps of a quarter turn.
const STEPS: usize = 512;

/// sin(2π·k/2048) for k = 0 … 512, with 62 fraction bits.
static QUARTER: [i64; STEPS + 1] = quarter();

/// Taylor series of the sine with 62 fraction bits, evaluated by the compiler.
const fn quarter() -> [i64; STEPS + 1] {
    let mut table = [0i64; STEPS + 1];
    let mut k = 0;
    while k <= STEPS {
        let angle = (k as i128 * TAU_Q60 as i128) >> 9;
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

/// Sine and cosine of a tabled angle, k of 2048.
fn tabled(k: usize) -> (i64, i64) {
    let step = k & (STEPS - 1);
    // `get` leaves no panic behind; the index is at most 512.
    let at = |i: usize| QUARTER.get(i).copied().unwrap_or(ONE);
    let (rising, falling) = (at(step), at(STEPS - step));
    match (k / STEPS) & 3 {
        0 => (rising, falling),
        1 => (falling, -rising),
        2 => (-rising, -falling),
        _ => (-falling, rising),
    }
}

/// Sine and cosine of `phase`/2⁶⁴ of a turn, in units of 1/[`ONE`], each within [`ERROR`].
#[must_use]
pub fn sin_cos(phase: u64) -> (i64, i64) {
    let nearest = phase.wrapping_add(1 << 52) >> 53;
    let (sine, cosine) = tabled(nearest as usize);

    // The rest, |rest| ≤ 2⁵², is δ = 2π·rest/2⁶⁴: with 70 fraction bits, |δ| < 2⁶¹.
    let rest = phase.wrapping_sub(nearest << 53).cast_signed();
    let delta = high(rest << 10, TAU_Q60);
    // With 76 fraction bits, below 2⁵⁸.
    let square = high(delta, delta);
    // δ³ and δ⁴ are below 2⁻²⁸ and 2⁻³⁷: 32 bits of δ (40 fraction bits) and of δ² (50) are enough.
    let (short, short_square) = (delta >> 30, square >> 26);
    let cube_sixth = (((short * short_square) >> 31) * SIXTH) >> 21;
    let fourth_24th = (((short_square * short_square) >> 36) * TWENTY_FOURTH) >> 20;
    let sin_delta = delta - cube_sixth;
    let versine = (square >> 1) - fourth_24th;
    (
        sine - (high(sine, versine) >> 12) + (high(cosine, sin_delta) >> 6),
        cosine - (high(cosine, versine) >> 12) - (high(sine, sin_delta) >> 6),
    )
}

/// 1/6 and 1/24 with 32 fraction bits.
const SIXTH: i64 = 715_827_883;
const TWENTY_FOURTH: i64 = 178_956_971;

/// a·b/2⁶⁴, rounded down.
fn high(a: i64, b: i64) -> i64 {
    ((i128::from(a) * i128::from(b)) >> 64) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The angle to 1e-30 as the sum of two doubles, and its sine and cosine by the addition theorem: the
    /// host's sine of a double is good to 1e-16, so an error of 3e-16 is seen.
    fn exact(phase: u64) -> (f64, f64) {
        // 2π to 106 bits.
        const TAU: [f64; 2] = [core::f64::consts::TAU, 2.449_293_598_294_706_4e-16];
        let upper = (phase >> 32) as f64 / 4_294_967_296.0;
        let lower = (phase & 0xffff_ffff) as f64 / 18_446_744_073_709_551_616.0;
        // upper has 32 bits and TAU[0] 53: the product's error is found by a fused multiplication.
        let product = upper * TAU[0];
        let rest = f64::mul_add(upper, TAU[0], -product) + upper * TAU[1] + lower * TAU[0];
        let (s, c) = (product.sin(), product.cos());
        (s + c * rest, c - s * rest)
    }

    #[test]
    fn is_within_the_stated_error_everywhere() {
        let mut worst = 0.0f64;
        let count = if cfg!(miri) { 1_000 } else { 200_000 };
        // A prime stride visits the whole turn and every offset from the tabled angles.
        let mut phase = 0u64;
        for _ in 0..count {
            let (s, c) = sin_cos(phase);
            let (sine, cosine) = exact(phase);
            // In two parts, for a double has 53 bits and the result 62.
            let off = |q62: i64, exact: f64| {
                let upper = (exact * 4_294_967_296.0).floor();
                let rest = exact - upper / 4_294_967_296.0;
                #[expect(clippy::cast_possible_truncation, reason = "33 bits")]
                let left = q62 - ((upper as i64) << 30);
                (left as f64 / ONE as f64 - rest).abs()
            };
            worst = worst.max(off(s, sine)).max(off(c, cosine));
            phase = phase.wrapping_add(92_233_720_368_547_759);
        }
        assert!(worst < ERROR, "{worst:e}");
        assert!(worst > 2e-17, "an error this small would mean that nothing was tested: {worst:e}");
    }

    #[test]
    fn quarter_turns_are_exact() {
        assert_eq!(sin_cos(0), (0, ONE));
        assert_eq!(sin_cos(1 << 62), (ONE, 0));
        assert_eq!(sin_cos(1 << 63), (0, -ONE));
        assert_eq!(sin_cos(3 << 62), (-ONE, 0));
    }
}
