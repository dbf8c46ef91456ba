//! The response of the table to lost motion over frequency.

use super::*;

/// Re and Im of Qo/ΔQ at n ticks a period, with ΔQ = 100 µm·sin ωt.
fn response<S: Scalar, R: Resolver>(times: (f64, f64), n: u32) -> (f64, f64) {
    const NM: f64 = 100_000.0;
    let omega = TAU / (f64::from(n) * TICK_S);
    let longest = times.0.max(times.1);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some 10⁴")]
    let settling = (14.0 * longest / TICK_S) as u32;
    let periods = (20_000 / n).max(1);
    let (skip, rows) = (settling.div_ceil(n) * n, periods * n);
    let shown = run::<S, R>(times, TICK_S, skip + rows, still, |t| NM * (omega * t).sin());
    let (mut re, mut im) = (0.0, 0.0);
    for (k, row) in (0u32..).zip(&shown[skip as usize..]) {
        let (sin, cos) = (omega * f64::from(k) * TICK_S).sin_cos();
        re += row.table * sin;
        im += row.table * cos;
    }
    let scale = 2.0 / f64::from(rows) / NM;
    (re * scale, im * scale)
}

fn magnitude((t, shift_t): (f64, f64), omega: f64) -> f64 {
    let (x, y) = (omega * t, omega * shift_t);
    (x + y).hypot(x * y) / (1f64.hypot(x) * 1f64.hypot(y))
}

/// Ticks a period for about this ω.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some 10⁵")]
fn period(omega: f64) -> u32 {
    (TAU / (omega * TICK_S)).round() as u32
}

/// How far a measured magnitude may be from the formula. Qo = motor − ΔQ, so only the motor's share,
/// 1/((1 + Ts)(1 + T's)), is at stake. Stepped, a factor is (1 − p)/(z^½ − p·z^−½), p = e^(−h/T), with one
/// half of the tick that the motor is late for each (the shift is early by one half, the reading late):
/// 1/(cos ωh/2 + j·coth(h/2T)·sin ωh/2), which is off by (ωh)²/6 + (h/T)²/12 of itself at most.
fn tolerance<S: Scalar>((t, shift_t): (f64, f64), omega: f64) -> f64 {
    let motor = 1.0 / (1f64.hypot(omega * t) * 1f64.hypot(omega * shift_t));
    let square = |x: f64| (x * TICK_S).powi(2);
    let held = square(omega) / 3.0 + (square(1.0 / t) + square(1.0 / shift_t)) / 12.0;
    // In fixed point gains of h/T right to 2⁻²⁵, 5e-5 of T, and an answer that goes with at most half of
    // either; elsewhere a position unit a tick, adding up over T'/h ticks, beside 100 µm.
    let format = if S::NAME == "fixed" { 5e-5 } else { 1e-7 };
    1.02 * held * motor + format
}

fn bode<S: Scalar, R: Resolver>(times: (f64, f64)) {
    let (mut highest, mut worst) = (0.0f64, 0.0f64);
    // 0.03/T to 30/T, four a decade, √2/T among them.
    for quarter in -6..=6 {
        let n = period(SQRT_2 / times.0 * 10f64.powf(f64::from(quarter) / 4.0));
        let omega = TAU / (f64::from(n) * TICK_S);
        let (re, im) = response::<S, R>(times, n);
        let (found, exact) = (re.hypot(im), magnitude(times, omega));
        let tolerance = tolerance::<S>(times, omega);
        assert!((found - exact).abs() < tolerance, "{} {times:?} ω {omega}: {found} for {exact}", S::NAME);
        highest = highest.max(found);
        worst = worst.max((found - exact).abs());
    }
    println!("{} {times:?}: within {worst:.6} of the magnitude, at most {highest:.4}", S::NAME);
    // 2/√3 where the two times are equal, below it elsewhere.
    let peak = 2.0 / 3f64.sqrt();
    assert!(highest < peak + 1e-4, "{highest}");
    assert!((highest > peak - 1e-4) == (times.0 == times.1), "{highest}");
}

#[test]
fn the_magnitude_over_three_decades() {
    for times in TIMES {
        for_all!(bode(times));
    }
}

#[test]
fn the_magnitude_passes_one_where_it_should() {
    for times in TIMES {
        let n = period(1.0 / (2.0 * times.0 * times.1).sqrt());
        let (re, im) = response::<Fixed, Phases<Fixed>>(times, n);
        let omega = TAU / (f64::from(n) * TICK_S);
        // A whole number of ticks a period is off by half a tick at most, and |G| goes with ω or less.
        let tolerance = tolerance::<Fixed>(times, omega) + 0.5 / f64::from(n);
        assert!((re.hypot(im) - 1.0).abs() < tolerance, "{times:?}");
    }
}

/// Solves a system of four equations by Gauss's elimination with pivots.
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

/// The break frequencies from measured responses, without T and T': the rational function
/// G = −s(b1 + b2·s)/(1 + a1·s + a2·s²) is fitted to them by least squares; it breaks at 1/b1, at the
/// roots of the denominator and at b1/b2.
fn breaks<S: Scalar, R: Resolver>(times: (f64, f64)) {
    // Powers of s grow: in units of the middle of the measured range they stay near 1.
    let unit = 20.0;
    let mut normal = [[0.0; 5]; 4];
    for quarter in -4..=4 {
        let n = period(unit * 10f64.powf(f64::from(quarter) / 4.0));
        let w = TAU / (f64::from(n) * TICK_S) / unit;
        let (re, im) = response::<S, R>(times, n);
        let weight = 1.0 / re.hypot(im);
        // G = −b1·s − b2·s² − a1·s·G − a2·s²·G, s = jw: its real and its imaginary part.
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
    println!("{} {times:?}: breaks at {found:.3?} for {exact:.3?} rad/s", S::NAME);
    for (found, exact) in found.into_iter().zip(exact) {
        // The responses are right to 3e-5 (held, at 200 rad/s and T' = 0.01 s) and 5e-5 (format). Two
        // breaks that lie close, 1/T and (T + T')/(TT') at a factor of 1.3, make some times that of it.
        let tolerance = if S::NAME == "fixed" { 5e-4 } else { 2e-4 };
        assert!((found / exact - 1.0).abs() < tolerance, "{} {times:?}: {found} for {exact}", S::NAME);
    }
}

#[test]
fn the_four_break_frequencies() {
    // With T = T' two of them are one and a fit cannot tell them apart.
    for times in [(0.03, 0.08), (0.03, 0.01)] {
        for_all!(breaks(times));
    }
}
