//! The mean residual over the range of a variable.

use numerics::bins::{Bin, binned};

use super::variable::{Variable, values};
use crate::fit::fit_data::{FitData, ResidualSeries};

/// Number of bins over the range of a variable.
const BINS: usize = 64;

/// Mean residual in bins over the range of a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct BinnedMean {
    /// Centre and mean residual of each bin with samples.
    pub points: Vec<(f64, f64)>,
    /// Fraction of Σr² that the means explain, corrected for their number.
    pub fraction: f64,
    /// Centre of the bin whose mean differs most from the median of all bins.
    pub centre: f64,
}

impl BinnedMean {
    /// The mean of a stage's residual over a variable; `None` if the variable was not measured or is constant.
    #[must_use]
    pub fn of(data: &FitData<'_>, residuals: &[&ResidualSeries], variable: Variable) -> Option<Self> {
        let mut pairs = Vec::new();
        for series in residuals {
            let values = values(data, series.log, variable)?;
            let settling = data.settling(series.log);
            pairs.extend(values.into_iter().zip(series.values.iter().copied()).skip(settling));
        }
        let mut bins = binned(&pairs, BINS)?;
        bins.retain(|bin| bin.count > 0);
        let total: f64 = pairs.iter().map(|(_, residual)| residual * residual).sum();
        let explained: f64 = bins.iter().map(|bin| bin.count as f64 * bin.mean() * bin.mean()).sum();
        let degrees_of_freedom = pairs.len() as f64 - bins.len() as f64;
        let variance_left = (total - explained) / degrees_of_freedom.max(1.0);
        let variance = (total / pairs.len().max(1) as f64).max(f64::MIN_POSITIVE);
        let means: Vec<f64> = bins.iter().map(Bin::mean).collect();
        let median = numerics::median(&means)?;
        let distance = |bin: &Bin| (bin.mean() - median).abs();
        let farthest = bins.iter().max_by(|a, b| distance(a).total_cmp(&distance(b)));
        Some(Self {
            points: bins.iter().map(|bin| (bin.centre, bin.mean())).collect(),
            fraction: 1.0 - variance_left / variance,
            centre: farthest.map_or(0.0, |bin| bin.centre),
        })
    }

    /// Ends of the contiguous region about [`Self::centre`] in which the difference of mean and median exceeds the fraction
    /// `edge` of its largest value, with the same sign; `None` if the region is wider than the fraction `max_width` of the
    /// range.
    #[must_use]
    pub fn local_defect(&self, edge: f64, max_width: f64) -> Option<[f64; 2]> {
        let means: Vec<f64> = self.points.iter().map(|point| point.1).collect();
        let median = numerics::median(&means)?;
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
