//! Waves over position: which period explains most, and which other periods explain as much at these targets.

use std::f64::consts::TAU;

use super::fit::{Fit, Samples};
use super::variant::{Drift, Gap, Grid, Mean, Variant};

/// Targets for each wave, which has three values, beside the two of a straight line.
const TARGETS_PER_WAVE: usize = 6;

/// Frequencies that are tried in the width of a line of the spectrum.
const PER_LINE: f64 = 10.0;

/// Most frequencies that are tried.
const MAX_FREQUENCIES: u32 = 1000;

/// Least period, as a multiple of the least distance of two targets: more than two targets a wave.
const LEAST: f64 = 2.1;

/// The frequencies that targets resolve, 1/mm: from two thirds of a wave on the travel to nearly half a wave between two targets.
fn frequencies(grid: &Grid) -> Vec<f64> {
    let knots = &grid.knots_mm;
    let travel_mm = numerics::peak_to_peak(knots.iter().copied());
    let distances: Vec<f64> = knots.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if knots.len() < 2 + TARGETS_PER_WAVE || travel_mm <= 0.0 {
        return Vec::new();
    }
    // A few targets that are close together do not make the others so.
    let least_mm = numerics::quantile(&distances, 0.1);
    let step = 1.0 / (PER_LINE * travel_mm);
    let highest = 1.0 / (LEAST * least_mm);
    let all = (0..MAX_FREQUENCIES).map(|count| 2.0 / 3.0 / travel_mm + f64::from(count) * step);
    all.take_while(|f| *f <= highest).collect()
}

/// How many waves of different periods the targets can tell: as many lines has the spectrum.
#[must_use]
pub fn lines(grid: &Grid) -> f64 {
    frequencies(grid).len() as f64 / PER_LINE
}

/// The form with one more wave that leaves least; `None` if the targets resolve none.
#[must_use]
pub fn with_wave(grid: &Grid, samples: &Samples, gap: Gap, before: &[f64]) -> Option<Variant> {
    let with = |frequency: f64| {
        let periods = before.iter().copied().chain([1.0 / frequency]).collect();
        Variant { mean: Mean::Waves(periods), gap, drift: Drift::None }
    };
    let squares = |frequency: f64| {
        Fit::of(&with(frequency), grid, samples, 0.0).map_or(f64::INFINITY, |fit| fit.squares())
    };
    let all = frequencies(grid);
    if grid.knots_mm.len() < 2 + TARGETS_PER_WAVE * (before.len() + 1) {
        return None;
    }
    // A wave that is there already is not another one.
    let travel_mm = numerics::peak_to_peak(grid.knots_mm.iter().copied());
    let is_new =
        |frequency: &&f64| before.iter().all(|period| (1.0 / period - *frequency).abs() * travel_mm > 0.7);
    let best = all.iter().filter(is_new).map(|&f| (squares(f), f)).min_by(|a, b| a.0.total_cmp(&b.0))?.1;
    Some(with(refined(best, 1.0 / (PER_LINE * travel_mm), squares)))
}

/// The frequency of the least squares within a step, by golden section.
fn refined(frequency: f64, step: f64, squares: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (mut low, mut high) = (frequency - step, frequency + step);
    for _ in 0..40 {
        let (left, right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if squares(left) < squares(right) { high = right } else { low = left }
    }
    0.5 * (low + high)
}

/// The common distance of the targets, mm, if they are evenly spaced.
#[must_use]
pub fn even_spacing_mm(knots_mm: &[f64]) -> Option<f64> {
    const TOLERANCE: f64 = 1e-3;
    let steps: Vec<f64> = knots_mm.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mean_mm = numerics::mean(steps.iter().copied());
    let is_even = steps.len() > 1 && steps.iter().all(|step| (step - mean_mm).abs() < TOLERANCE * mean_mm);
    is_even.then_some(mean_mm)
}

/// Periods shorter than twice the least distance of the targets that look like this one at them, mm: each whole number of waves more in
/// a distance. Only even spacing has exact ones; of uneven spacing those are told whose phase differs by less than a tenth of a wave.
#[must_use]
pub fn aliases_mm(knots_mm: &[f64], period_mm: f64) -> Vec<f64> {
    const MOST: u32 = 3;
    const MAX_PHASE: f64 = 0.1 * TAU;
    let Some(first) = knots_mm.first() else { return Vec::new() };
    let least_mm = numerics::min(knots_mm.windows(2).map(|pair| pair[1] - pair[0]));
    let looks_alike = |other: f64| {
        let phase = |sign: f64| {
            let difference =
                |mm: &f64| numerics::wrapped(TAU * (mm - first) * (1.0 / other - sign / period_mm), TAU);
            numerics::max_abs(knots_mm.iter().map(difference))
        };
        phase(1.0).min(phase(-1.0)) < MAX_PHASE
    };
    let candidates = (1..=MOST)
        .flat_map(|count| [-1.0, 1.0].map(|sign| 1.0 / (f64::from(count) / least_mm + sign / period_mm)));
    candidates.filter(|other| *other > 0.0 && looks_alike(*other)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: at targets every 5 mm, 20 mm looks like 1/(1/5 − 1/20) = 6.667 mm and 1/(1/5 + 1/20) = 4 mm.
    #[test]
    fn even_targets_have_aliases_and_uneven_ones_have_none() {
        let even: Vec<f64> = (0..9).map(|i| 5.0 * f64::from(i)).collect();
        assert_eq!(even_spacing_mm(&even), Some(5.0));
        let aliases = aliases_mm(&even, 20.0);
        assert!((aliases[0] - 20.0 / 3.0).abs() < 1e-9 && (aliases[1] - 4.0).abs() < 1e-9, "{aliases:?}");
        let uneven: Vec<f64> = (0..9).map(|i| 5.0 * f64::from(i) + 0.31 * f64::from(i * i % 7)).collect();
        assert_eq!(even_spacing_mm(&uneven), None);
        assert_eq!(aliases_mm(&uneven, 20.0), [0.0; 0]);
    }
}
