//! Values that repeat with a period, such as angles.

/// A value within half a period of zero: from −period/2 up to period/2.
#[must_use]
pub fn wrapped(value: f64, period: f64) -> f64 {
    (value + 0.5 * period).rem_euclid(period) - 0.5 * period
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 350° is −10°, and half a turn is −180°.
    #[test]
    fn a_value_is_within_half_a_period_of_zero() {
        for (value, expected) in [(350.0, -10.0), (-350.0, 10.0), (180.0, -180.0), (730.0, 10.0)] {
            assert!((wrapped(value, 360.0) - expected).abs() < 1e-12, "{value}");
        }
    }
}
