//! The figures of a picture, in an attribute of its SVG element: the script of the page makes a CSV file of them.
//!
//! They take less than half of the characters of a CSV, for a page has ten thousands of points: the heading of the abscissa, that of the
//! value, and the decimals of both, a line each; then a line for each curve, with its class in the stylesheet and a pair of whole numbers
//! for each point, of which the first is the step from the last abscissa. The script replaces the class by the words of the legend.

use std::fmt::Write;

/// Digits of the largest value that are kept, and of the range of the abscissa.
const VALUE_DIGITS: i32 = 4;
const ABSCISSA_DIGITS: i32 = 5;

/// A curve: its class, and its points.
pub(super) type Curve<'a> = (&'a str, &'a [(f64, f64)]);

/// The figures of curves; the headings are those of abscissa and value, with their units.
#[must_use]
pub(super) fn packed([abscissa, value]: [&str; 2], curves: &[Curve<'_>]) -> String {
    let all = || curves.iter().flat_map(|(_, points)| points.iter());
    let [low, high] = numerics::min_max(all().map(|point| point.0));
    let x_decimals = decimals(high - low, ABSCISSA_DIGITS);
    let y_decimals = decimals(numerics::max_abs(all().map(|point| point.1)), VALUE_DIGITS);
    let mut text = format!("{abscissa}\n{value}\n{x_decimals} {y_decimals}");
    for (class, points) in curves {
        // Writing into a text does not fail.
        let _ = write!(text, "\n{class}");
        let mut last = 0;
        for (x, y) in *points {
            let (at, value) = (whole(*x, x_decimals), whole(*y, y_decimals));
            let _ = write!(text, " {},{value}", at - last);
            last = at;
        }
    }
    text
}

/// Decimals with which a number of this size has so many digits; below zero, its last digits are zeros.
fn decimals(size: f64, digits: i32) -> i32 {
    if !(size.is_finite() && size > 0.0) {
        return 0;
    }
    #[expect(clippy::cast_possible_truncation, reason = "the exponent of a finite number")]
    let exponent = size.log10().floor() as i32;
    digits - 1 - exponent
}

/// A value in units of its last decimal; 0 if it is no number.
#[expect(clippy::cast_possible_truncation, reason = "at most some ten digits")]
fn whole(value: f64, decimals: i32) -> i64 {
    (value * 10_f64.powi(decimals)).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_has_the_digits_that_matter() {
        let before = [(12.345_678, -0.012_345_67), (12.5, 0.5), (22.345_678, 1.0)];
        let curves: [Curve<'_>; 2] = [("before", &before), ("after", &[])];
        // Range 10: five digits of it are 0.001; four of the largest value, 1, too.
        assert_eq!(
            packed(["time, s", "residual, N"], &curves),
            "time, s\nresidual, N\n3 3\nbefore 12346,-12 154,500 9846,1000\nafter"
        );
        assert_eq!(packed(["a", "b"], &[]), "a\nb\n0 0");
        assert_eq!(packed(["a", "b"], &[("c", &[(0.0, 123_456.0)])]), "a\nb\n0 -2\nc 0,1235");
    }
}
