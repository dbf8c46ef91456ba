//! A quadrature counter of 16 bits that wraps, made into a position.

use crate::units::{PER_M, Position};

/// Greatest count that is converted; 2³⁸ counts of 1 nm are 275 m.
const FRACTION_BITS: u32 = 16;

/// An incremental encoder on a hardware counter.
#[derive(Clone, Copy, Debug)]
pub struct Encoder {
    /// Position units per count, 16 fraction bits.
    units_per_count: i64,
    last: u16,
    counts: i64,
}

impl Encoder {
    /// An encoder that stands at position zero while the counter shows `raw`.
    ///
    /// `None` unless one count is between 1 pm and 1 mm.
    #[must_use]
    pub fn new(metres_per_count: f64, raw: u16) -> Option<Self> {
        let plausible = (1e-12..=1e-3).contains(&metres_per_count);
        #[expect(clippy::cast_possible_truncation, reason = "at most 1 mm: 2⁵⁶")]
        plausible.then(|| Self {
            units_per_count: libm::rint(metres_per_count * PER_M * f64::from(1 << FRACTION_BITS)) as i64,
            last: raw,
            counts: 0,
        })
    }

    /// The position for what the counter shows now, at most half its range after the last call.
    pub fn read(&mut self, raw: u16) -> Position {
        let step = raw.wrapping_sub(self.last).cast_signed();
        self.last = raw;
        self.counts = self.counts.wrapping_add(i64::from(step));
        let units = i128::from(self.counts) * i128::from(self.units_per_count);
        #[expect(clippy::cast_possible_truncation, reason = "wraps with the counts, after 10⁸ m of 1 mm")]
        Position((units >> FRACTION_BITS) as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_through_the_wrap_both_ways() {
        // 50 nm a count = 52,428,800 units.
        let mut encoder = Encoder::new(50e-9, 65_530).unwrap();
        assert_eq!(encoder.read(65_535).0, 5 * 52_428_800);
        assert_eq!(encoder.read(4).0, 10 * 52_428_800);
        assert_eq!(encoder.read(65_526).0, -4 * 52_428_800);
    }

    #[test]
    fn does_not_drift_over_a_long_travel() {
        // 1,000,000 counts of 0.1 µm/3 are 33.333 mm; the rate is rounded to 2⁻¹⁷ unit a count.
        let mut encoder = Encoder::new(1e-7 / 3.0, 0).unwrap();
        let mut raw = 0u16;
        let mut last = Position(0);
        for _ in 0..1000 {
            raw = raw.wrapping_add(1000);
            last = encoder.read(raw);
        }
        assert!((last.to_m() - 0.1 / 3.0).abs() < 1e-14, "{}", last.to_m());
    }
}
