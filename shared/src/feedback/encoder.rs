//! A 16-bit quadrature counter that wraps: a [`Transducer`] whose cycle is the range of the counter.
//!
//! # Example
//!
//! With 50 nm per count, the counter wraps forward by 10 counts: 500 nm.
//!
//! ```
//! use shared::feedback::encoder::Encoder;
//!
//! let mut encoder = Encoder::new(50e-9, 65_530).unwrap();
//! assert!((encoder.read(4).to_m() - 500e-9).abs() < 1e-15);
//! ```

use super::phase::Phase;
use super::transducer::Transducer;
use crate::units::Position;

/// Counts per range of the counter.
const RANGE: f64 = 65_536.0;

/// An incremental encoder on a hardware counter.
#[derive(Clone, Copy, Debug)]
pub struct Encoder(Transducer);

impl Encoder {
    /// An encoder that is at position zero when the counter reads `raw`. `metres_per_count` is negative if the counter
    /// decreases in the positive direction of the axis.
    ///
    /// `None` unless the magnitude of a count is 1 pm to 1 mm. The length of the range is rounded to a position unit, an
    /// error of at most 2⁻¹⁷ units per count; for a lead that is not a whole number of such counts use [`Transducer::new`]
    /// with [`Phase::from_counter`].
    #[must_use]
    pub fn new(metres_per_count: f64, raw: u16) -> Option<Self> {
        let plausible = (1e-12..=1e-3).contains(&libm::fabs(metres_per_count));
        let range_m = plausible.then_some(metres_per_count * RANGE)?;
        Transducer::new(range_m, 1, Phase::from_counter(raw)).map(Self)
    }

    /// The position for a counter value. The counter must have moved by less than half its range since the last call.
    pub fn read(&mut self, raw: u16) -> Position {
        self.0.read(Phase::from_counter(raw))
    }

    /// The position at which the counter had a value, such as at an index pulse, less than half its range from the last reading.
    #[must_use]
    pub fn position_at(&self, raw: u16) -> Position {
        let mut at = *self;
        at.read(raw)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_through_the_wrap_both_ways() {
        // A count of 50 nm is 52,428,800 units.
        let mut encoder = Encoder::new(50e-9, 65_530).unwrap();
        assert_eq!(encoder.read(65_535).0, 5 * 52_428_800);
        assert_eq!(encoder.read(4).0, 10 * 52_428_800);
        assert_eq!(encoder.read(65_526).0, -4 * 52_428_800);
    }

    /// An earlier value of the counter, also before a wrap; the reading continues as if it had not been asked for.
    #[test]
    fn the_position_of_an_earlier_count_changes_nothing() {
        let mut encoder = Encoder::new(50e-9, 65_530).unwrap();
        assert_eq!(encoder.read(4).0, 10 * 52_428_800);
        assert_eq!(encoder.position_at(65_533).0, 3 * 52_428_800);
        assert_eq!(encoder.read(5).0, 11 * 52_428_800);
    }

    #[test]
    fn a_negative_count_reverses_the_direction() {
        let mut encoder = Encoder::new(-50e-9, 10).unwrap();
        assert_eq!(encoder.read(15).0, -5 * 52_428_800);
        assert_eq!(encoder.read(65_535).0, 11 * 52_428_800);
    }

    #[test]
    fn does_not_drift_over_a_long_travel() {
        // 1,000,000 counts of 0.1 µm/3 are 33.333 mm; the error is at most 2⁻¹⁷ units per count.
        let mut encoder = Encoder::new(1e-7 / 3.0, 0).unwrap();
        let mut raw = 0u16;
        let mut last = Position(0);
        for _ in 0..1000 {
            raw = raw.wrapping_add(1000);
            last = encoder.read(raw);
        }
        assert!((last.to_m() - 0.1 / 3.0).abs() < 1e-14, "{}", last.to_m());
    }

    #[test]
    fn implausible_counts_are_rejected() {
        for metres in [f64::NAN, f64::INFINITY, 0.0, 0.9e-12, 1.1e-3, -0.9e-12, -1.1e-3] {
            assert!(Encoder::new(metres, 0).is_none());
        }
        assert!(Encoder::new(1e-12, 0).is_some() && Encoder::new(1e-3, 0).is_some());
    }

    #[test]
    #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
    fn a_count_that_is_no_whole_number_of_units_does_not_drift() {
        // A count of 1/7 µm: seven million counts are 1 m, 1.05·10¹⁵ units.
        let mut counter = Transducer::new(65_536e-6, 7, Phase::from_counter(0)).unwrap();
        let mut position = Position(0);
        for leads in 1..=1_000_000u64 {
            let raw = ((7 * leads) & 0xffff) as u16;
            position = counter.read(Phase::from_counter(raw));
        }
        assert!((position.0 - 1_048_576_000_000_000).abs() <= 1, "{position:?}");
    }
}
