//! The mean residual over the range of a variable.

use super::variable::{Variable, values};
use crate::fit::fit_data::{FitData, ResidualSeries};

/// Bins over the range of a variable.
const BINS: usize = 64;

/// Mean residual in bins over the range of a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct BinnedMean {
    /// Middle of each bin that has samples, and the mean residual there.
    pub points: Vec<(f64, f64)>,
    /// Fraction of Σr² that the means explain, corrected for their number.
    pub fraction: f64,
    /// Where the mean differs most from the median of all bins.
    pub centre: f64,
}

/// A bin with samples.
struct Bin {
    index: usize,
    count: usize,
    mean: f64,
}

impl BinnedMean {
    /// The mean of a stage's residual over a variable; `None` if that was not measured or is constant.
    #[must_use]
    pub fn of(data: &FitData<'_>, residuals: &[&ResidualSeries], variable: Variable) -> Option<Self> {
        let mut pairs = Vec::new();
        for series in residuals {
            let values = values(data, series.log, variable)?;
            let settling = data.settling(series.log);
            pairs.extend(values.into_iter().zip(series.values.iter().copied()).skip(settling));
        }
        let min = pairs.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
        let max = pairs.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
        let width = (max - min) / BINS as f64;
        if !width.is_finite() || width <= 0.0 {
            return None;
        }
        let total: f64 = pairs.iter().map(|(_, residual)| residual * residual).sum();
        let bins = binned(&pairs, min, width);
        let explained: f64 = bins.iter().map(|bin| bin.count as f64 * bin.mean * bin.mean).sum();
        let degrees_of_freedom = pairs.len() as f64 - bins.len() as f64;
        let variance_left = (total - explained) / degrees_of_freedom.max(1.0);
        let variance = (total / pairs.len().max(1) as f64).max(f64::MIN_POSITIVE);
        let median = median(bins.iter().map(|bin| bin.mean))?;
        let distance = |bin: &Bin| (bin.mean - median).abs();
        let farthest = bins.iter().max_by(|a, b| distance(a).total_cmp(&distance(b)));
        let middle = |bin: &Bin| min + (bin.index as f64 + 0.5) * width;
        Some(Self {
            points: bins.iter().map(|bin| (middle(bin), bin.mean)).collect(),
            fraction: 1.0 - variance_left / variance,
            centre: farthest.map_or(0.0, middle),
        })
    }

    /// Ends of the one region about [`Self::centre`] in which the mean differs from the median by more than `edge` of the
    /// greatest difference, in the same direction; `None` if it takes more than `max_width` of the range.
    #[must_use]
    pub fn local_defect(&self, edge: f64, max_width: f64) -> Option<[f64; 2]> {
        let median = median(self.points.iter().map(|point| point.1))?;
        let from_centre = |point: &(f64, f64)| (point.0 - self.centre).abs();
        let (centre, _) =
            self.points.iter().enumerate().min_by(|a, b| from_centre(a.1).total_cmp(&from_centre(b.1)))?;
        let height = self.points[centre].1 - median;
        let is_within = |i: &usize| (self.points[*i].1 - median) / height > edge;
        let first = (0..=centre).rev().take_while(is_within).last()?;
        let last = (centre..self.points.len()).take_while(is_within).last()?;
        let step = (self.points.last()?.0 - self.points[0].0) / BINS as f64;
        let [from, to] = [self.points[first].0 - step, self.points[last].0 + step];
        (to - from < max_width * step * BINS as f64).then_some([from, to])
    }
}

/// The bins with samples of pairs of variable and residual.
fn binned(pairs: &[(f64, f64)], min: f64, width: f64) -> Vec<Bin> {
    let mut sums = vec![(0usize, 0.0); BINS];
    for (value, residual) in pairs {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to BINS")]
        let bin = (((value - min) / width) as usize).min(BINS - 1);
        sums[bin].0 += 1;
        sums[bin].1 += residual;
    }
    let used = sums.iter().enumerate().filter(|(_, (count, _))| *count > 0);
    used.map(|(index, &(count, sum))| Bin { index, count, mean: sum / count as f64 }).collect()
}

/// The upper median.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
