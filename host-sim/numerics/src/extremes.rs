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

    #[test]
    fn empty_input_has_infinite_extremes_and_no_magnitude() {
        assert_eq!(min_max([]).map(f64::to_bits), [f64::INFINITY, f64::NEG_INFINITY].map(f64::to_bits));
        assert_eq!(max_abs([]).to_bits(), 0.0_f64.to_bits());
        assert!(peak_to_peak([]) < 0.0);
    }
}
