//! Minimum and maximum. NaN is skipped.

/// The smallest value; +∞ if there is none.
#[must_use]
pub fn min(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::INFINITY, f64::min)
}

/// The largest value; −∞ if there is none.
#[must_use]
pub fn max(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

/// The smallest and the largest value; `[+∞, −∞]` if there is none.
#[must_use]
pub fn min_max(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let empty = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(empty, |[min, max], value| [min.min(value), max.max(value)])
}

/// Maximum minus minimum; −∞ if there is no value.
#[must_use]
pub fn peak_to_peak(values: impl IntoIterator<Item = f64>) -> f64 {
    let [min, max] = min_max(values);
    max - min
}

/// The largest absolute value; 0 if there is no value.
#[must_use]
pub fn max_abs(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |max, value| value.abs().max(max))
}

/// The higher one of the two minima beside a value, each searched as far as no value is higher than it: a maximum stands out by its
/// distance from there. `None`: a side has no such value.
#[must_use]
pub fn saddle(values: &[f64], at: usize) -> Option<f64> {
    let (before, rest) = values.split_at_checked(at)?;
    let (value, after) = rest.split_first()?;
    let is_below = |other: &&f64| *other <= value;
    let left = before.iter().rev().take_while(is_below).copied().reduce(f64::min)?;
    let right = after.iter().take_while(is_below).copied().reduce(f64::min)?;
    Some(left.max(right))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_skip_nan() {
        let values = [2.0, f64::NAN, -5.0, 3.0];
        assert_eq!(min_max(values).map(f64::to_bits), [-5.0_f64, 3.0].map(f64::to_bits));
        assert_eq!([min(values), max(values)].map(f64::to_bits), [-5.0_f64, 3.0].map(f64::to_bits));
        assert_eq!(peak_to_peak(values).to_bits(), 8.0_f64.to_bits());
        assert_eq!(max_abs(values).to_bits(), 5.0_f64.to_bits());
    }

    /// The minima beside the 5 are 1 and 2: the 0 lies behind the 6.
    #[test]
    fn a_maximum_stands_out_from_the_higher_minimum_beside_it() {
        let values = [3.0, 1.0, 5.0, 2.0, 4.0, 6.0, 0.0];
        assert_eq!(saddle(&values, 2).map(f64::to_bits), Some(2.0_f64.to_bits()));
        // Its right side begins with the 6; the first and the last value have one side alone.
        for at in [0, 4, 6, 7] {
            assert_eq!(saddle(&values, at), None, "{at}");
        }
    }

    #[test]
    fn empty_input_has_infinite_extremes_and_no_magnitude() {
        assert_eq!(min_max([]).map(f64::to_bits), [f64::INFINITY, f64::NEG_INFINITY].map(f64::to_bits));
        assert_eq!(max_abs([]).to_bits(), 0.0_f64.to_bits());
        assert!(peak_to_peak([]) < 0.0);
    }
}
