//! A converter input with a linear scale: a voltage behind a divider, a temperature sensor.
//!
//! ```text
//! value = offset + counts·slope        slope with 16 fraction bits, rounded to the nearest
//! ```
//!
//! # Example
//!
//! 60 V at 4095 counts, in mV.
//!
//! ```
//! use shared::drive::LinearInput;
//!
//! let bus = LinearInput::new(60_000.0 / 4095.0, 0.0).unwrap();
//! assert_eq!((bus.value(0), bus.value(2048), bus.value(4095)), (0, 30_007, 60_000));
//! ```

/// A converter input with a linear scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinearInput {
    /// Per count, 16 fraction bits.
    slope: i32,
    offset: i32,
}

impl LinearInput {
    /// An input of `per_count` per count, and `offset` at zero counts. `None` unless both magnitudes are at most 30,000 and
    /// 10⁹.
    #[must_use]
    pub fn new(per_count: f64, offset: f64) -> Option<Self> {
        let plausible = libm::fabs(per_count) <= 30_000.0 && libm::fabs(offset) <= 1e9;
        #[expect(clippy::cast_possible_truncation, reason = "checked; at most 2³¹")]
        let (slope, offset) = (libm::rint(per_count * 65_536.0) as i32, libm::rint(offset) as i32);
        plausible.then_some(Self { slope, offset })
    }

    /// The value for counts of the converter.
    #[must_use]
    pub fn value(&self, counts: u16) -> i32 {
        let product = i64::from(counts) * i64::from(self.slope);
        let value = ((product + (1 << 15)) >> 16).saturating_add(i64::from(self.offset));
        #[expect(clippy::cast_possible_truncation, reason = "clamped")]
        let value = value.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
        value
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Half a unit, and the rounding of the slope by 2⁻¹⁷ per count.
        #[test]
        fn the_value_is_the_nearest(per_count in -500.0..500.0f64, offset in -1e6..1e6f64, counts in 0u16..4096) {
            let exact = offset + per_count * f64::from(counts);
            let value = f64::from(LinearInput::new(per_count, offset).unwrap().value(counts));
            prop_assert!((value - exact).abs() <= 1.0 + f64::from(counts) / 131_072.0, "{value}, {exact}");
        }
    }

    #[test]
    fn implausible_scales_are_rejected() {
        for (per_count, offset) in [(f64::NAN, 0.0), (30_001.0, 0.0), (1.0, 1.1e9), (1.0, f64::NAN)] {
            assert_eq!(LinearInput::new(per_count, offset), None);
        }
    }
}
