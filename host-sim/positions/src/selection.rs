//! Which form the runs support: each step takes the one that predicts runs that were left out of the fit best, as long as it does so
//! better than the form before and is more than chance. Then simpler forms are taken that predict as well.

use super::course::Course;
use super::drift;
use super::fit::{Fit, Samples};
use super::variant::{Drift, Gap, Grid, Mean, Variant};
use super::wave;

/// A step is taken if it reduces the mean square of runs left out by this fraction.
const MIN_REDUCTION: f64 = 0.01;

/// A simpler form is taken if it raises the mean square of runs left out by less than this fraction.
const MAX_RISE: f64 = 0.02;

/// Fewest runs of which a drift is told: two always lie on a line.
pub const MIN_DRIFT_RUNS: usize = 3;

/// Most waves.
const MAX_WAVES: usize = 2;

/// The form that the runs support.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// Its fit to all runs.
    pub fit: Fit,
    /// Rms error of runs that were left out, µm; `None` of a single run.
    pub left_out_um: Option<f64>,
    /// Whether the time constant of the drift is bounded on both sides: its 95 % interval.
    pub time_constant_ci95: Option<[f64; 2]>,
}

/// What is searched in.
pub struct Search<'a> {
    /// Readings.
    pub samples: &'a Samples,
    /// Knots and course.
    pub grid: &'a Grid,
    /// Whether there are readings in both directions.
    pub has_both_ways: bool,
    ridge: Option<f64>,
    pub(crate) runs: Vec<usize>,
}

impl<'a> Search<'a> {
    /// A search in these samples.
    #[must_use]
    pub fn new(samples: &'a Samples, grid: &'a Grid, has_both_ways: bool) -> Self {
        let runs = samples.distinct_runs();
        let ridge =
            (runs.len() >= MIN_DRIFT_RUNS).then(|| drift::ridge(samples, grid, has_both_ways)).flatten();
        Self { samples, grid, has_both_ways, ridge, runs }
    }

    /// The fit of a form; `None` if the samples do not determine it.
    #[must_use]
    pub fn fit(&self, variant: &Variant) -> Option<Fit> {
        self.fit_to(variant, self.samples)
    }

    fn fit_to(&self, variant: &Variant, samples: &Samples) -> Option<Fit> {
        let ridge = if variant.drift == Drift::Map { self.ridge? } else { 0.0 };
        Fit::of(variant, self.grid, samples, ridge)
    }

    /// Mean square of the errors of each run, predicted by the others, µm²; `None` of a single run.
    #[must_use]
    pub fn left_out(&self, variant: &Variant) -> Option<f64> {
        if self.runs.len() < 2 {
            return None;
        }
        let mut squares = 0.0;
        for run in &self.runs {
            let others = self.samples.of_runs(|other| other != *run);
            let fit = self.fit_to(variant, &others)?;
            let held = self.samples.of_runs(|other| other == *run);
            let errors =
                held.places.iter().zip(&held.deviations_um).map(|(place, um)| um - fit.at(self.grid, place));
            squares += errors.map(|error| error * error).sum::<f64>();
        }
        Some(squares / self.samples.runs.len() as f64)
    }

    /// The form that the runs support: from the least upwards, or from the fullest downwards where that predicts better. A step upwards may
    /// need another one with it.
    #[must_use]
    pub fn choose(&self) -> Option<Chosen> {
        let mut up = self.fit(&Variant::offset())?;
        while let Some(next) = self.step(&up) {
            up = next;
        }
        let up = self.simplified(up);
        let down = self.fullest().map(|fit| self.simplified(fit));
        let left_out = |fit: &Fit| self.left_out(&fit.variant);
        let is_better = |down: &Fit| {
            let both = left_out(down).zip(left_out(&up));
            both.is_some_and(|(down, up)| down < (1.0 - MAX_RISE) * up)
        };
        let fit = down.filter(is_better).unwrap_or(up);
        let left_out_um = left_out(&fit).map(f64::sqrt);
        Some(Chosen { fit, left_out_um, time_constant_ci95: None })
    }

    /// The form with a value at each knot of each part that the readings determine.
    fn fullest(&self) -> Option<Fit> {
        let gap = if self.has_both_ways { Gap::Map } else { Gap::None };
        let with = |drift: Drift| self.fit(&Variant { mean: Mean::Map, gap, drift });
        let drifts =
            if self.runs.len() < MIN_DRIFT_RUNS { &[Drift::None][..] } else { &[Drift::Map, Drift::Line] };
        let fit = drifts.iter().find_map(|drift| with(*drift))?;
        (fit.freedom >= 1.0).then_some(fit)
    }

    /// The best form with more of one part; `None` if none is better.
    fn step(&self, before: &Fit) -> Option<Fit> {
        let left_out = self.left_out(&before.variant);
        let mut best: Option<(f64, Fit)> = None;
        for variant in self.larger(&before.variant) {
            let Some(fit) = self.fit(&variant) else { continue };
            if !self.is_supported(before, &fit) || !self.is_trend(before, &fit) {
                continue;
            }
            // A single run has nothing to be left out: chance alone decides, with the scatter that is left.
            let (score, limit) = match (self.left_out(&variant), left_out) {
                (Some(after), Some(before)) => (after, (1.0 - MIN_REDUCTION) * before),
                _ => (fit.scatter_um().unwrap_or(f64::INFINITY), f64::INFINITY),
            };
            if score < limit && best.as_ref().is_none_or(|(least, _)| score < *least) {
                best = Some((score, fit));
            }
        }
        best.map(|(_, fit)| fit)
    }

    /// Forms with more of one part.
    fn larger(&self, variant: &Variant) -> Vec<Variant> {
        let mut larger: Vec<Variant> = Vec::new();
        let mut with_mean = |mean: Mean| larger.push(Variant { mean, ..variant.clone() });
        let periods = match &variant.mean {
            Mean::Waves(periods) => periods.clone(),
            _ => Vec::new(),
        };
        if variant.mean == Mean::Offset {
            with_mean(Mean::Line);
        }
        if variant.mean != Mean::Map {
            let gap = if self.has_both_ways { Gap::Constant } else { Gap::None };
            let wave =
                (periods.len() < MAX_WAVES).then(|| wave::with_wave(self.grid, self.samples, gap, &periods));
            if let Some(wave) = wave.flatten() {
                with_mean(wave.mean);
            }
            with_mean(Mean::Map);
        }
        let gaps: Vec<Gap> = [Gap::Constant, Gap::Map]
            .into_iter()
            .filter(|gap| self.has_both_ways && *gap > variant.gap)
            .collect();
        // A gap may stand out only with the curve over position taken off, and the curve only with the gap.
        let both = larger.clone().into_iter().chain([variant.clone()]);
        let with_gap =
            both.flat_map(|with| gaps.iter().map(move |gap| Variant { gap: *gap, ..with.clone() }));
        larger.extend(with_gap.collect::<Vec<_>>());
        if self.runs.len() >= MIN_DRIFT_RUNS {
            let drifts =
                [Drift::Offset, Drift::Line, Drift::Map].into_iter().filter(|drift| *drift > variant.drift);
            larger.extend(drifts.map(|drift| Variant { drift, ..variant.clone() }));
        }
        larger
    }

    /// Simpler forms of each part in turn, as long as runs left out are predicted as well, or what is more in the larger form is not more
    /// than chance.
    fn simplified(&self, mut best: Fit) -> Fit {
        let limit = self.left_out(&best.variant).map(|left_out| (1.0 + MAX_RISE) * left_out);
        while let Some(smaller) = self.smaller(&best.variant).into_iter().find_map(|variant| {
            let fit = self.fit(&variant)?;
            let is_as_good =
                || limit.zip(self.left_out(&variant)).is_some_and(|(limit, left_out)| left_out < limit);
            (!self.is_supported(&fit, &best) || is_as_good()).then_some(fit)
        }) {
            best = smaller;
        }
        best
    }

    /// Forms with less of one part, the least first.
    fn smaller(&self, variant: &Variant) -> Vec<Variant> {
        let mut smaller = Vec::new();
        let below =
            [Drift::None, Drift::Offset, Drift::Line].into_iter().filter(|drift| *drift < variant.drift);
        smaller.extend(below.map(|drift| Variant { drift, ..variant.clone() }));
        let below = [Gap::None, Gap::Constant].into_iter().filter(|gap| *gap < variant.gap);
        smaller.extend(below.map(|gap| Variant { gap, ..variant.clone() }));
        let mut means = match &variant.mean {
            Mean::Offset => Vec::new(),
            Mean::Line => vec![Mean::Offset],
            Mean::Waves(_) | Mean::Map => vec![Mean::Offset, Mean::Line],
        };
        if variant.mean == Mean::Map {
            let gap = if self.has_both_ways { Gap::Constant } else { Gap::None };
            let mut periods = Vec::new();
            for _ in 0..MAX_WAVES {
                let wave = wave::with_wave(self.grid, self.samples, gap, &periods);
                let Some(Variant { mean: Mean::Waves(found), .. }) = wave else { break };
                means.push(Mean::Waves(found.clone()));
                periods = found;
            }
        }
        smaller.extend(means.into_iter().map(|mean| Variant { mean, ..variant.clone() }));
        smaller
    }
}

/// The course of the drift in the samples, and the 95 % interval of its time constant if both ends are known.
#[must_use]
pub fn course(
    samples: &Samples,
    knots_mm: &[f64],
    has_both_ways: bool,
    span: [f64; 2],
) -> (Course, Option<[f64; 2]>) {
    let runs = samples.distinct_runs().len();
    if runs < MIN_DRIFT_RUNS || span[0] >= span[1] {
        return (Course { time_constant: None, span: [span[0], span[1].max(span[0] + 1.0)] }, None);
    }
    drift::course(samples, knots_mm, has_both_ways, (span, runs))
}
