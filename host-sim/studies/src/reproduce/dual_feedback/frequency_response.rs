//! Frequency response of the system in [`super::ideal_loop`], and the break frequencies fitted to it.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::ideal_loop::{TICK_S, TimeConstants, run};

/// Response Qo/ΔQ at one angular frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Angular frequency, rad/s, with a whole number of ticks per period.
    pub omega: f64,
    /// Real part (in phase).
    pub re: f64,
    /// Imaginary part (leading by 90°).
    pub im: f64,
}

/// Measures the response with ΔQ = 100 µm·sin ωt after the transient.
pub fn measure(times: TimeConstants, omega: f64) -> Response {
    const AMPLITUDE_NM: f64 = 1e5;
    /// Settling time in time constants: e⁻¹⁴ = 1e-6.
    const SETTLING: f64 = 14.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some 10⁵")]
    let ticks = |time_s: f64| (time_s / TICK_S).round() as u32;
    let period = ticks(TAU / omega);
    let omega = TAU / (f64::from(period) * TICK_S);
    let settling = ticks(SETTLING * times.position_s.max(times.dual_s)).div_ceil(period) * period;
    let rows = (ticks(1.0) / period).max(1) * period;
    let outputs = run(times, settling + rows, |time_s| AMPLITUDE_NM * libm::sin(omega * time_s));
    let (mut re, mut im) = (0.0, 0.0);
    for (tick, row) in (0u32..).zip(&outputs[settling as usize..]) {
        let (sine, cosine) = libm::sincos(omega * f64::from(tick) * TICK_S);
        re += row.table_nm * sine;
        im += row.table_nm * cosine;
    }
    let scale = 2.0 / f64::from(rows) / AMPLITUDE_NM;
    Response { omega, re: re * scale, im: im * scale }
}

impl Response {
    /// |Qo/ΔQ|.
    pub fn magnitude(&self) -> f64 {
        libm::hypot(self.re, self.im)
    }
}

/// Break frequencies of measured responses, rad/s, without using T and T': least-squares fit of −s(b1 + b2 s)/(1 + a1 s
/// + a2 s²), which has breaks at 1/b1, at the roots of the denominator and at b1/b2. `None` if the fit fails.
pub fn fit_breaks(responses: &[Response]) -> Option<[f64; 4]> {
    // In units of the middle frequency, so that powers of s stay near 1.
    let unit = responses.get(responses.len() / 2)?.omega;
    let mut rows = Vec::new();
    for response in responses {
        let (w, Response { re, im, .. }, weight) =
            (response.omega / unit, *response, response.magnitude().recip());
        // G = −b1·s − b2·s² − a1·s·G − a2·s²·G at s = jw: one row for the real part, one for the imaginary part.
        rows.push([0.0, w * w, w * im, w * w * re, re].map(|cell| cell * weight));
        rows.push([-w, 0.0, -w * re, w * w * im, im].map(|cell| cell * weight));
    }
    let matrix = DMatrix::from_fn(rows.len(), 4, |row, column| rows[row][column]);
    let right = DVector::from_fn(rows.len(), |row, _| rows[row][4]);
    let fit = matrix.svd(true, true).solve(&right, 1e-12).ok()?;
    let [b1, b2, a1, a2] = [fit[0], fit[1], fit[2], fit[3]];
    let root = (a1 * a1 - 4.0 * a2).sqrt();
    let found =
        [1.0 / b1, (a1 - root) / (2.0 * a2), (a1 + root) / (2.0 * a2), b1 / b2].map(|omega| omega * unit);
    found.iter().all(|omega| omega.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact responses give back their own break frequencies.
    #[test]
    fn the_fit_recovers_the_breaks() {
        let times = TimeConstants { position_s: 0.03, dual_s: 0.08 };
        let exact = |omega: f64| {
            use nalgebra::Complex;
            let s = Complex::new(0.0, omega);
            let g = (Complex::from(1.0) / ((s * times.position_s + 1.0) * (s * times.dual_s + 1.0))) - 1.0;
            Response { omega, re: g.re, im: g.im }
        };
        let found = fit_breaks(&[2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0].map(exact)).unwrap();
        for (found, exact) in found.into_iter().zip([1.0 / 0.11, 1.0 / 0.08, 1.0 / 0.03, 0.11 / 0.0024]) {
            assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
        }
    }
}
