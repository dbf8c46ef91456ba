//! Periods of waves over a position.

use std::f64::consts::TAU;

use super::samples::Samples;
use model::residual_law::{Term, WavePosition};
use numerics::min_max;

/// Shortest period, mm.
const MIN_PERIOD_MM: f64 = 1.0;

/// Longest period, as a fraction of the travel: a longer wave is a polynomial of low order.
const MAX_PERIOD: f64 = 0.7;

/// Steps of the frequency, as a fraction of the resolution of the travel.
const STEP: f64 = 0.25;

/// Most periods that are tried.
const MOST_PERIODS: usize = 600;

/// The wave over a position that explains most of the samples; `None` if they do not move along it.
#[must_use]
pub fn strongest(samples: &Samples<'_>, over: WavePosition) -> Option<Term> {
    let pairs = samples.pairs(over);
    let [min, max] = min_max(pairs.iter().map(|pair| pair.0));
    let travel_mm = max - min;
    if !(travel_mm * MAX_PERIOD > MIN_PERIOD_MM && travel_mm.is_finite()) {
        return None;
    }
    let (first, last) = (1.0 / (MAX_PERIOD * travel_mm), 1.0 / MIN_PERIOD_MM);
    let step = STEP / travel_mm;
    let grid = (0..MOST_PERIODS).map(|i| first + i as f64 * step).take_while(|per_mm| *per_mm <= last);
    let mean = numerics::mean(pairs.iter().map(|pair| pair.1));
    let power = |per_mm: f64| explained(&pairs, mean, per_mm);
    let best = grid.map(|per_mm| (per_mm, power(per_mm))).max_by(|a, b| a.1.total_cmp(&b.1))?.0;
    let per_mm = maximum(power, [best - step, best + step]);
    Some(Term::Wave { over, period_mm: 1.0 / per_mm, cosine: 1.0, sine: 0.0 })
}

/// Σr² that a wave explains.
fn explained(pairs: &[(f64, f64)], mean: f64, per_mm: f64) -> f64 {
    let (mut cc, mut cs, mut ss, mut cr, mut sr) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (at, residual) in pairs {
        let (sine, cosine) = libm::sincos(TAU * per_mm * at);
        let residual = residual - mean;
        cc += cosine * cosine;
        cs += cosine * sine;
        ss += sine * sine;
        cr += cosine * residual;
        sr += sine * residual;
    }
    let determinant = cc * ss - cs * cs;
    if determinant <= 1e-9 * cc * ss {
        0.0
    } else {
        (ss * cr * cr - 2.0 * cs * cr * sr + cc * sr * sr) / determinant
    }
}

/// Where a function with one maximum in an interval is largest (golden section).
pub fn maximum(of: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut of_a, mut of_b) = (of(a), of(b));
    for _ in 0..24 {
        if of_a < of_b {
            (low, a, of_a) = (a, b, of_b);
            b = low + ratio * (high - low);
            of_b = of(b);
        } else {
            (high, b, of_b) = (b, a, of_a);
            a = high - ratio * (high - low);
            of_a = of(a);
        }
    }
    0.5 * (low + high)
}
