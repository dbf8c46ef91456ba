//! The figures of a picture: a page has tens of thousands of points, and its script makes files of them and reads them under the pointer.
//!
//! Values are whole numbers in units of their last decimal, and each point is the step from the last one, of both coordinates. The heading
//! of the abscissa, that of the value, and the decimals of both stand in an attribute of the SVG element, a line each. The curves of a line
//! chart are its paths, which are drawn in these units; those of a circle follow in the attribute, a line each, with their class in the
//! stylesheet.

use std::fmt::Write;

/// Digits of the largest value that are kept, and of the range of the values; of the range of the abscissa, one more.
const VALUE_DIGITS: i32 = 4;
const RANGE_DIGITS: i32 = 5;

/// A curve: its class, and its points.
pub(super) type Curve<'a> = (&'a str, &'a [(f64, f64)]);

/// The decimals in which the points of a picture are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decimals {
    x: i32,
    y: i32,
}

impl Decimals {
    /// Decimals that these curves need.
    pub fn of(curves: &[Curve<'_>]) -> Self {
        let points = || curves.iter().flat_map(|(_, points)| points.iter());
        let [left, right] = numerics::min_max(points().map(|point| point.0));
        let [low, high] = numerics::min_max(points().map(|point| point.1));
        let of_values = decimals(numerics::max_abs(points().map(|point| point.1)), VALUE_DIGITS);
        // Values that differ by a small part of themselves are drawn, too.
        let of_range = if low < high { decimals(high - low, VALUE_DIGITS) } else { of_values };
        Self { x: decimals(right - left, RANGE_DIGITS), y: of_values.max(of_range) }
    }

    /// The lines before the curves.
    pub fn heading(self, [abscissa, value]: [&str; 2]) -> String {
        format!("{abscissa}\n{value}\n{} {}", self.x, self.y)
    }

    /// A length of either coordinate, in units of its last decimal.
    pub fn units(self, (x, y): (f64, f64)) -> (f64, f64) {
        (x * 10_f64.powi(self.x), y * 10_f64.powi(self.y))
    }

    /// The steps from point to point, each after the separator.
    pub fn steps(self, points: &[(f64, f64)], separator: &str) -> String {
        let mut text = String::new();
        let mut last = (0, 0);
        for (x, y) in points {
            let at = (whole(*x, self.x), whole(*y, self.y));
            // Writing into a text does not fail.
            let _ = write!(text, "{separator}{},{}", at.0 - last.0, at.1 - last.1);
            last = at;
        }
        text
    }
}

/// The figures of curves; the headings are those of abscissa and value, with their units.
#[must_use]
pub(super) fn packed(headings: [&str; 2], curves: &[Curve<'_>]) -> String {
    let decimals = Decimals::of(curves);
    let mut text = decimals.heading(headings);
    for (class, points) in curves {
        let _ = write!(text, "\n{class}{}", decimals.steps(points, " "));
    }
    text
}

/// Decimals with which a number of this size has so many digits; below zero, its last digits are zeros.
fn decimals(size: f64, digits: i32) -> i32 {
    if !(size.is_finite() && size > 0.0) {
        return 0;
    }
    #[expect(clippy::cast_possible_truncation, reason = "the exponent of a finite number")]
    let exponent = libm::log10(size).floor() as i32;
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
            "time, s\nresidual, N\n3 3\nbefore 12346,-12 154,512 9846,500\nafter"
        );
        assert_eq!(packed(["a", "b"], &[]), "a\nb\n0 0");
        assert_eq!(packed(["a", "b"], &[("c", &[(0.0, 123_456.0)])]), "a\nb\n0 -2\nc 0,1235");
        // Values of 1000 that differ by 0.02: a thousandth of their range stands in the last decimal.
        assert_eq!(
            packed(["a", "b"], &[("c", &[(0.0, 1000.0), (1.0, 1000.02)])]),
            "a\nb\n4 5\nc 0,100000000 10000,2000"
        );
    }
}
