//! Mean of one variable over equal bins of another.

use super::extremes::min_max;

/// One of several bins of equal width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Centre of the bin, in the unit of x.
    pub centre: f64,
    /// Number of samples in the bin.
    pub count: usize,
    /// Sum of y over these samples.
    pub sum: f64,
}

impl Bin {
    /// Mean of y; NaN in an empty bin.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }
}

/// Sorts samples (x, y) into bins of equal width from the smallest to the largest x. Empty bins are included. `None` if x
/// does not vary or is not finite.
#[must_use]
pub fn binned(samples: &[(f64, f64)], bins: usize) -> Option<Vec<Bin>> {
    let [min, max] = min_max(samples.iter().map(|sample| sample.0));
    let width = (max - min) / bins as f64;
    if !width.is_finite() || width <= 0.0 {
        return None;
    }
    let empty = |i: usize| Bin { centre: min + (i as f64 + 0.5) * width, count: 0, sum: 0.0 };
    let mut all: Vec<Bin> = (0..bins).map(empty).collect();
    for (x, y) in samples {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index, 0 to bins")]
        let bin = &mut all[(((x - min) / width) as usize).min(bins - 1)];
        bin.count += 1;
        bin.sum += y;
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_fall_into_equal_bins() {
        // Bins of width 2 from 0 to 6; the maximum belongs to the last.
        let bins = binned(&[(0.0, 1.0), (1.9, 2.0), (4.0, 5.0), (6.0, 7.0)], 3).unwrap();
        let found: Vec<(f64, usize, f64)> = bins.iter().map(|bin| (bin.centre, bin.count, bin.sum)).collect();
        assert_eq!(found, [(1.0, 2, 3.0), (3.0, 0, 0.0), (5.0, 2, 12.0)]);
        assert!((bins[0].mean() - 1.5).abs() < 1e-15 && bins[1].mean().is_nan());
    }

    #[test]
    fn a_constant_x_has_no_bins() {
        assert_eq!(binned(&[(2.0, 1.0), (2.0, 3.0)], 4), None);
        assert_eq!(binned(&[], 4), None);
    }
}
