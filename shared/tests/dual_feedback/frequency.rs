//! Frequency response of the table position to lost motion.

use super::*;

/// Real and imaginary part of Qo/ΔQ at n ticks per period, with ΔQ = 100 µm·sin ωt.
fn response<S: Scalar, R: Resolver>(times: (f64, f64), n: u32) -> (f64, f64) {
    const NM: f64 = 100_000.0;
    let omega = TAU / (f64::from(n) * TICK_S);
    let longest = times.0.max(times.1);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some 10⁴")]
    let settling = (14.0 * longest / TICK_S) as u32;
    let periods = (20_000 / n).max(1);
    let (skip, rows) = (settling.div_ceil(n) * n, periods * n);
    let samples = run::<S, R>(times, TICK_S, skip + rows, zero, |t| NM * (omega * t).sin());
    let (mut re, mut im) = (0.0, 0.0);
    for (k, row) in (0u32..).zip(&samples[skip as usize..]) {
        let (sin, cos) = (omega * f64::from(k) * TICK_S).sin_cos();
        re += row.table * sin;
        im += row.table * cos;
    }
    let scale = 2.0 / f64::from(rows) / NM;
    (re * scale, im * scale)
}

/// |Qo/ΔQ| by the formula.
fn magnitude((t, shift_t): (f64, f64), omega: f64) -> f64 {
    let (x, y) = (omega * t, omega * shift_t);
    (x + y).hypot(x * y) / (1f64.hypot(x) * 1f64.hypot(y))
}

/// Ticks per period of ω, rounded.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some 10⁵")]
fn period(omega: f64) -> u32 {
    (TAU / (omega * TICK_S)).round() as u32
}

/// Tolerance of a measured magnitude. Qo = motor − ΔQ, so only the response of the motor, 1/((1 + Ts)(1 + T's)), has a
/// discretisation error. The motor lags by a tick; half of it is assigned to each factor (the shift is half a tick early,
/// the reading half a tick late). In discrete time a factor is (1 − p)/(z^½ − p·z^−½), p = e^(−h/T), or
/// 1/(cos ωh/2 + j·coth(h/2T)·sin ωh/2): a relative error of at most (ωh)²/6 + (h/T)²/12.
fn tolerance<S: Scalar>((t, shift_t): (f64, f64), omega: f64) -> f64 {
    let motor = 1.0 / (1f64.hypot(omega * t) * 1f64.hypot(omega * shift_t));
    let square = |x: f64| (x * TICK_S).powi(2);
    let held = square(omega) / 3.0 + (square(1.0 / t) + square(1.0 / shift_t)) / 12.0;
    // Fixed point: a gain h/T is rounded by 2⁻²⁵, which is 5e-5 of T, and the relative change of the response is at most
    // half of that of either time. Floating point: a position unit per tick, summed over T'/h ticks, relative to 100 µm.
    let format = if S::NAME == "fixed" { 5e-5 } else { 1e-7 };
    1.02 * held * motor + format
}

fn bode<S: Scalar, R: Resolver>(times: (f64, f64)) {
    let (mut highest, mut worst) = (0.0f64, 0.0f64);
    // 0.045/T to 45/T, four per decade, with √2/T in the middle.
    for quarter in -6..=6 {
        let n = period(SQRT_2 / times.0 * 10f64.powf(f64::from(quarter) / 4.0));
        let omega = TAU / (f64::from(n) * TICK_S);
        let (re, im) = response::<S, R>(times, n);
        let (found, exact) = (re.hypot(im), magnitude(times, omega));
        let tolerance = tolerance::<S>(times, omega);
        let context = format!("{} {times:?} ω {omega}", S::NAME);
        assert!((found - exact).abs() < tolerance, "{context}: {found}, expected {exact}");
        highest = highest.max(found);
        worst = worst.max((found - exact).abs());
    }
    println!("{} {times:?}: magnitude within {worst:.6}, at most {highest:.4}", S::NAME);
    // 2/√3 for T = T', less otherwise.
    let peak = 2.0 / 3f64.sqrt();
    assert!(highest < peak + 1e-4, "{highest}");
    assert!((highest > peak - 1e-4) == (times.0 == times.1), "{highest}");
}

#[test]
fn the_magnitude_matches_the_formula_over_three_decades() {
    for times in TIMES {
        for_all!(bode(times));
    }
}

/// At ω = 1/√(2TT').
#[test]
fn the_magnitude_is_one_at_the_frequency_of_the_formula() {
    for times in TIMES {
        let n = period(1.0 / (2.0 * times.0 * times.1).sqrt());
        let (re, im) = response::<Fixed, Phases<Fixed>>(times, n);
        let omega = TAU / (f64::from(n) * TICK_S);
        // Rounding the period to whole ticks changes ω by at most 1/(2n), and |G| by no more than ω.
        let tolerance = tolerance::<Fixed>(times, omega) + 0.5 / f64::from(n);
        assert!((re.hypot(im) - 1.0).abs() < tolerance, "{times:?}");
    }
}

/// Solves four linear equations by Gauss-Jordan elimination with partial pivoting.
fn solve(mut rows: [[f64; 5]; 4]) -> [f64; 4] {
    for i in 0..4 {
        let pivot = (i..4).max_by(|&a, &b| rows[a][i].abs().total_cmp(&rows[b][i].abs())).unwrap();
        rows.swap(i, pivot);
        let above = rows[i];
        for (_, row) in rows.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            let factor = row[i] / above[i];
            row.iter_mut().zip(above).for_each(|(cell, above)| *cell -= factor * above);
        }
    }
    std::array::from_fn(|i| rows[i][4] / rows[i][i])
}

/// The corner frequencies from measured responses, without the use of T and T': G = −s(b1 + b2·s)/(1 + a1·s + a2·s²) is
/// fitted to the responses by least squares. Its corners are 1/b1, the roots of the denominator and b1/b2.
fn corners<S: Scalar, R: Resolver>(times: (f64, f64)) {
    // Unit of ω, rad/s: the middle of the measured range, so that the powers of s stay near 1.
    let unit = 20.0;
    let mut normal = [[0.0; 5]; 4];
    for quarter in -4..=4 {
        let n = period(unit * 10f64.powf(f64::from(quarter) / 4.0));
        let w = TAU / (f64::from(n) * TICK_S) / unit;
        let (re, im) = response::<S, R>(times, n);
        let weight = 1.0 / re.hypot(im);
        // Real and imaginary part of G = −b1·s − b2·s² − a1·s·G − a2·s²·G, s = jw.
        let real = [0.0, w * w, w * im, w * w * re, re];
        let imaginary = [-w, 0.0, -w * re, w * w * im, im];
        for row in [real, imaginary] {
            for i in 0..4 {
                for j in 0..5 {
                    normal[i][j] += row[i] * row[j] * weight * weight;
                }
            }
        }
    }
    let [b1, b2, a1, a2] = solve(normal);
    let root = (a1 * a1 - 4.0 * a2).sqrt();
    let found = [1.0 / b1, (a1 - root) / (2.0 * a2), (a1 + root) / (2.0 * a2), b1 / b2].map(|w| w * unit);
    let (t, shift_t) = times;
    let (longer, shorter) = (t.max(shift_t), t.min(shift_t));
    let exact = [1.0 / (t + shift_t), 1.0 / longer, 1.0 / shorter, (t + shift_t) / (t * shift_t)];
    println!("{} {times:?}: corners {found:.3?}, expected {exact:.3?} rad/s", S::NAME);
    for (found, exact) in found.into_iter().zip(exact) {
        // The responses have errors of 3e-5 (hold, at 200 rad/s and T' = 0.01 s) and 5e-5 (format). Corners that are only a
        // factor of 1.3 apart, as 1/T' and (T + T')/(TT') are, amplify them several times.
        let tolerance = if S::NAME == "fixed" { 5e-4 } else { 2e-4 };
        assert!((found / exact - 1.0).abs() < tolerance, "{} {times:?}: {found}, not {exact}", S::NAME);
    }
}

#[test]
fn the_four_corner_frequencies() {
    // With T = T' two corners coincide and a fit cannot separate them.
    for times in [(0.03, 0.08), (0.03, 0.01)] {
        for_all!(corners(times));
    }
}
