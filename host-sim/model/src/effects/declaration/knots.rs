//! Common part of effects that are given at knots over the position.

use crate::position_curve::PositionCurve;

/// Evenly spaced positions of knots from end to end of a travel, mm, to 0.01 mm.
#[must_use]
pub fn positions_mm([from, to]: [f64; 2], count: u32) -> Vec<f64> {
    let step = (to - from) / f64::from(count.max(2) - 1);
    (0..count).map(|i| (100.0 * (from + step * f64::from(i))).round() / 100.0).collect()
}

/// Largest number of knots of a refined map.
const FINEST: usize = 40;

/// Number of knots of a refined map: those that the residual asks for, and at least half as many again as there are. The number of a map
/// follows from the residual at the time when it is added, which other effects still disturb. `None` if the residual asks for none, or the map is
/// fine enough.
#[must_use]
pub fn refined(knots: usize, asked: impl FnOnce() -> Option<u32>) -> Option<u32> {
    let more = knots + knots / 2;
    let more = u32::try_from(more).ok().filter(|_| more <= FINEST)?;
    asked().map(|asked| asked.max(more))
}

/// The values of a natural cubic spline through knots at other positions.
#[must_use]
pub fn resampled(positions_mm: &[f64], values: &[f64], at_mm: &[f64]) -> Vec<f64> {
    let curve = PositionCurve::new(positions_mm, values);
    at_mm.iter().map(|&mm| curve.value(mm)).collect()
}

/// The part of the values at knots that another parameter of a model describes, so that a fit of both would not be
/// unique. The fit keeps this part as it is, zero in an initial guess, and changes the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptPart {
    /// The mean of the values. The fit changes all values but the last, which follows.
    Mean,
    /// The mean of the values but the first and the last, which a motion that hardly reaches them does not determine. The fit changes all
    /// values but the one in the middle, which follows.
    InnerMean,
    /// Mean and slope: the sum of the values, and the sum of values times positions. The fit changes all values but the
    /// first and the last, which follow.
    Line,
}

impl KeptPart {
    /// Of a kept mean, the index of the value that follows from the others, and the indices over which the mean is.
    fn of_mean(self, count: usize) -> (usize, std::ops::Range<usize>) {
        match self {
            Self::InnerMean if count > 2 => (count / 2, 1..count - 1),
            _ => (count - 1, 0..count),
        }
    }

    /// The values that a fit changes.
    #[must_use]
    pub fn free(self, values: &[f64]) -> Vec<f64> {
        let end = values.len().saturating_sub(1);
        if values.is_empty() || self == Self::Line {
            return values.get(1..end).unwrap_or_default().to_vec();
        }
        let (dependent, _) = self.of_mean(values.len());
        [&values[..dependent], &values[dependent + 1..]].concat()
    }

    /// All values, for other values of those that a fit changes; `old` has the part that is kept.
    #[must_use]
    pub fn with(self, positions: &[f64], old: &[f64], free: &[f64]) -> Vec<f64> {
        if self != Self::Line {
            let (dependent, range) = self.of_mean(positions.len());
            let Some((before, behind)) = free.split_at_checked(dependent) else { return old.to_vec() };
            let mut values = [before, &[0.0], behind].concat();
            let sum = |values: &[f64]| values[range.clone()].iter().sum::<f64>();
            values[dependent] = sum(old) - sum(&values);
            return values;
        }
        let last = positions.len() - 1;
        // What the dependent values have to add to the sum of the values, and to that of values times positions.
        let change = |weight: fn(f64) -> f64| -> f64 {
            let before = old.iter().zip(positions).map(|(value, x)| value * weight(*x)).sum::<f64>();
            before - free.iter().zip(&positions[1..]).map(|(value, x)| value * weight(*x)).sum::<f64>()
        };
        let (sum, moment) = (change(|_| 1.0), change(|x| x));
        let end = (moment - sum * positions[0]) / (positions[last] - positions[0]);
        [sum - end].into_iter().chain(free.iter().copied()).chain([end]).collect()
    }
}

/// Why positions with their values are refused in a file, if so: the name of the list and what was expected.
#[must_use]
pub fn refused(positions: &[f64], lists: &[(&'static str, &[f64])]) -> Option<(&'static str, String)> {
    if positions.len() < 2 {
        return Some(("positions_mm", "at least two positions".to_owned()));
    }
    if positions.windows(2).any(|two| two[0] >= two[1]) {
        return Some(("positions_mm", "positions that increase".to_owned()));
    }
    let unequal = lists.iter().find(|(_, values)| values.len() != positions.len());
    unequal.map(|(key, _)| (*key, format!("as many numbers as positions_mm, {}", positions.len())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_lie_from_end_to_end() {
        assert_eq!(positions_mm([-10.0, 20.004], 4), [-10.0, 0.0, 10.0, 20.0]);
    }

    /// Sum and first moment by hand: 1 + 2 − 4 + 3 = 2 and 0 + 2 − 12 + 12 = 2.
    #[test]
    fn the_kept_part_remains_and_the_free_values_are_set() {
        let (positions, old) = ([0.0, 1.0, 3.0, 4.0], [1.0, 2.0, -4.0, 3.0]);
        for kept in [KeptPart::Mean, KeptPart::Line] {
            assert_eq!(kept.with(&positions, &old, &kept.free(&old)), old);
            let free: Vec<f64> = kept.free(&old).iter().map(|value| value + 0.5).collect();
            let moved = kept.with(&positions, &old, &free);
            assert_eq!(kept.free(&moved), free);
            assert!((moved.iter().sum::<f64>() - 2.0).abs() < 1e-12);
            let moment: f64 = moved.iter().zip(positions).map(|(value, x)| value * x).sum();
            assert_eq!((moment - 2.0).abs() < 1e-12, kept == KeptPart::Line);
        }
    }

    /// 2 − 4 = −2 stays the sum of the inner values, whatever the others become.
    #[test]
    fn the_ends_are_free_of_an_inner_mean() {
        let (positions, old) = ([0.0, 1.0, 3.0, 4.0], [1.0, 2.0, -4.0, 3.0]);
        let kept = KeptPart::InnerMean;
        assert_eq!(kept.free(&old), [1.0, 2.0, 3.0]);
        assert_eq!(kept.with(&positions, &old, &kept.free(&old)), old);
        assert_eq!(kept.with(&positions, &old, &[7.0, 5.0, -9.0]), [7.0, 5.0, -7.0, -9.0]);
        // With two positions there is no inner one, and the first stays free.
        assert_eq!(kept.free(&[1.0, 2.0]), [1.0]);
        assert_eq!(kept.with(&[0.0, 1.0], &[1.0, 2.0], &[5.0]), [5.0, -2.0]);
    }

    #[test]
    fn refused_lists_are_named() {
        assert_eq!(refused(&[1.0], &[]).unwrap().0, "positions_mm");
        assert_eq!(refused(&[1.0, 1.0], &[]).unwrap().1, "positions that increase");
        let lists: [(&str, &[f64]); 2] = [("error_um", &[1.0, 2.0]), ("error_negative_um", &[1.0])];
        assert_eq!(refused(&[1.0, 2.0], &lists).unwrap().0, "error_negative_um");
        assert_eq!(refused(&[1.0, 2.0], &lists[..1]), None);
    }
}
