//! Printed numbers, rounded to significant digits.

/// The minus sign U+2212, which has the width of a plus sign.
const MINUS: char = '−';

/// Most decimals of a value, and the smallest value of which they show a digit.
const MOST_DECIMALS: i32 = 9;
const SMALLEST: f64 = 0.5e-9;

/// Number of decimals for this number of significant digits.
fn decimals(value: f64, digits: i32) -> usize {
    let magnitude = libm::log10(value.abs()).floor().clamp(-12.0, 12.0);
    #[expect(clippy::cast_possible_truncation, reason = "between -12 and 12")]
    let exponent = if value == 0.0 { 0 } else { magnitude as i32 };
    usize::try_from((digits - 1 - exponent).min(MOST_DECIMALS)).unwrap_or(0)
}

/// A value with a fixed number of decimals; a dash for NaN.
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    if value.is_nan() {
        return "–".to_owned();
    }
    let text = format!("{:.decimals$}", value.abs());
    let is_zero = text.chars().all(|c| c == '0' || c == '.');
    if value < 0.0 && !is_zero { format!("{MINUS}{text}") } else { text }
}

/// A value with this number of significant digits; 0 where all decimals that are shown would be.
#[must_use]
pub fn significant(value: f64, digits: i32) -> String {
    let value = if value.abs() < SMALLEST { 0.0 } else { value };
    let unit = libm::pow(10_f64, libm::log10(value.abs()).floor() - f64::from(digits - 1));
    let rounded = if value != 0.0 && unit > 1.0 { (value / unit).round() * unit } else { value };
    fixed(rounded, decimals(value, digits))
}

/// A value with this number of significant digits and its sign, including a plus sign.
#[must_use]
pub fn signed(value: f64, digits: i32) -> String {
    let text = significant(value, digits);
    if value > 0.0 { format!("+{text}") } else { text }
}

/// A value and the half width of its interval, both rounded to the first digit of the half width, with at most four
/// significant digits of the value. Without a half width, the value with four significant digits.
#[must_use]
pub fn with_spread(value: f64, half_width: f64) -> String {
    if !half_width.is_finite() || half_width <= 0.0 {
        return significant(value, 4);
    }
    let decimals = decimals(half_width, 1).min(decimals(value, 4));
    let unit = 0.1_f64.powi(i32::try_from(decimals).unwrap_or(0));
    // A half width that would round to 0 is shown as one unit of the last decimal.
    let half_width = if half_width < 0.5 * unit { unit } else { half_width };
    format!("{} ± {}", fixed(value, decimals), fixed(half_width, decimals))
}

/// A percentage rounded to a whole number; `less than 1 %` and `more than 99 %` instead of 0 and 100 by rounding.
#[must_use]
pub fn percent(value: f64) -> String {
    match value {
        v if v > 99.5 && v < 100.0 => "more than 99 %".to_owned(),
        v if v > 0.0 && v < 0.5 => "less than 1 %".to_owned(),
        v => format!("{} %", fixed(v, 0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_spread() {
        assert_eq!(with_spread(9.8123, 0.0213), "9.81 ± 0.02");
        assert_eq!(with_spread(-229.26, 2.45), "−229 ± 2");
        assert_eq!(with_spread(10.364_6, 1e-6), "10.36 ± 0.01");
        assert_eq!(with_spread(3.333_333, 0.0), "3.333");
        assert_eq!(with_spread(4.0, f64::NAN), "4.000");
        assert_eq!(with_spread(20.4, 36.0), "20 ± 36");
    }

    #[test]
    fn zero_has_no_minus_sign() {
        assert_eq!(fixed(-0.0001, 2), "0.00");
        assert_eq!(significant(0.0, 3), "0.00");
        assert_eq!(significant(-3.2e-12, 3), "0.00");
        assert_eq!(signed(-1.25, 2), "−1.2");
        assert_eq!(signed(0.123, 2), "+0.12");
        assert_eq!(significant(5973.0, 2), "6000");
    }

    #[test]
    fn a_percentage_is_not_rounded_to_0_or_100() {
        assert_eq!(percent(99.97), "more than 99 %");
        assert_eq!(percent(0.2), "less than 1 %");
        assert_eq!(percent(90.6), "91 %");
        assert_eq!(percent(0.0), "0 %");
    }
}
