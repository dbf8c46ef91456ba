//! The dual feedback system of the appendix, run: [`shared::feedback::dual`] behind an ideal motor.
//!
//! The motor's velocity is K = 1/T times what phase detector 1 sees; held over a tick of h that is
//! motor += (1 − e^(−h/T))·(command − feedback). The table lags the motor by the lost motion ΔQ. The controller's
//! part is its own, in the number format of the chip.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use shared::feedback::dual::{Feedback, State};
use shared::feedback::fade::Fade;
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_NM, Position};

/// Of the loop, s.
pub const TICK_S: f64 = 1.0 / 20_000.0;

/// Ticks in which a lost scale would fade in; none is lost here.
const FADE_TICKS: f64 = 2000.0;

/// T of the position loop and T' of the second detector, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// 1/K.
    pub position_s: f64,
    /// 1/K'.
    pub shift_s: f64,
}

/// What a tick shows, nm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shown {
    /// Qo, the table, from the command.
    pub table_nm: f64,
    /// Qc = Qo − Qf, what phase detector 2 sees.
    pub second_nm: f64,
}

fn share(time_s: f64) -> f64 {
    -(-TICK_S / time_s).exp_m1()
}

fn units(nm: f64) -> i64 {
    Position::from_m(1e-9 * nm).unwrap_or_default().0
}

/// A row a tick from t = 0 on, under a lost motion (nm) over time (s).
pub fn run(times: Times, ticks: u32, lost_motion_nm: impl Fn(f64) -> f64) -> Vec<Shown> {
    let gain = Fixed::gain(share(times.position_s));
    let feedback =
        Feedback::<Fixed>::Dual { fraction: Fixed::gain(share(times.shift_s)), fade: Fade::new(FADE_TICKS) };
    let (mut state, mut motor, mut shift) = (State::default(), Position(0), 0);
    let nm = |distance: i64| distance as f64 / PER_NM as f64;
    (0..ticks)
        .map(|tick| {
            let table = motor - units(lost_motion_nm(f64::from(tick) * TICK_S));
            // Before the shift of this tick: at the tick both detectors are compared.
            let second_nm = nm(table - (motor + shift));
            let seen = feedback.position(&mut state, motor, Some(table));
            shift = seen - motor;
            motor += Fixed::to_distance(Fixed::from_distance(-seen.0) * gain);
            Shown { table_nm: nm(table.0), second_nm }
        })
        .collect()
}

/// Qo/ΔQ at an angular frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Angular frequency, rad/s: a whole number of ticks a period.
    pub omega: f64,
    /// In phase.
    pub re: f64,
    /// A quarter ahead.
    pub im: f64,
}

/// Measured with ΔQ = 100 µm·sin ωt, once what the beginning leaves has gone.
pub fn at(times: Times, omega: f64) -> Response {
    const AMPLITUDE_NM: f64 = 1e5;
    /// e⁻¹⁴ is 1e-6.
    const SETTLING: f64 = 14.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some 10⁵")]
    let ticks = |time_s: f64| (time_s / TICK_S).round() as u32;
    let period = ticks(TAU / omega);
    let omega = TAU / (f64::from(period) * TICK_S);
    let rest = ticks(SETTLING * times.position_s.max(times.shift_s)).div_ceil(period) * period;
    let rows = (ticks(1.0) / period).max(1) * period;
    let shown = run(times, rest + rows, |time_s| AMPLITUDE_NM * (omega * time_s).sin());
    let (mut re, mut im) = (0.0, 0.0);
    for (tick, row) in (0u32..).zip(&shown[rest as usize..]) {
        let (sine, cosine) = (omega * f64::from(tick) * TICK_S).sin_cos();
        re += row.table_nm * sine;
        im += row.table_nm * cosine;
    }
    let scale = 2.0 / f64::from(rows) / AMPLITUDE_NM;
    Response { omega, re: re * scale, im: im * scale }
}

impl Response {
    /// |Qo/ΔQ|.
    pub fn magnitude(&self) -> f64 {
        self.re.hypot(self.im)
    }
}

/// The break frequencies that measured responses have, rad/s, without knowing T or T': the function
/// −s(b1 + b2 s)/(1 + a1 s + a2 s²) is fitted to them by least squares; it breaks at 1/b1, at the roots of the
/// denominator and at b1/b2. `None` where the fit finds no such function.
pub fn breaks(responses: &[Response]) -> Option<[f64; 4]> {
    // Powers of s grow: in units of the middle of the measured range they stay near 1.
    let unit = responses.get(responses.len() / 2)?.omega;
    let mut rows = Vec::new();
    for response in responses {
        let (w, Response { re, im, .. }, weight) =
            (response.omega / unit, *response, response.magnitude().recip());
        // G = −b1·s − b2·s² − a1·s·G − a2·s²·G at s = jw: its real and its imaginary part.
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

    /// Responses made from b and a are given back.
    #[test]
    fn a_fit_finds_the_function() {
        let times = Times { position_s: 0.03, shift_s: 0.08 };
        let exact = |omega: f64| {
            use nalgebra::Complex;
            let s = Complex::new(0.0, omega);
            let g = (Complex::from(1.0) / ((s * times.position_s + 1.0) * (s * times.shift_s + 1.0))) - 1.0;
            Response { omega, re: g.re, im: g.im }
        };
        let found = breaks(&[2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0].map(exact)).unwrap();
        for (found, exact) in found.into_iter().zip([1.0 / 0.11, 1.0 / 0.08, 1.0 / 0.03, 0.11 / 0.0024]) {
            assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
        }
    }
}
