//! A 32-bit quadrature counter: a position without accumulation.
//!
//! ```text
//! position = (count − zero)·position units per count        with 32 fraction bits, rounded down
//! ```
//!
//! The counter holds 2³¹ counts in each direction, 1 km at 0.5 µm: it does not wrap on a machine, so that no reading is needed in
//! time for the next one, unlike with 16 bits ([`super::encoder`]).
//!
//! # Example
//!
//! ```
//! use shared::feedback::counter::Counter;
//!
//! let scale = Counter::new(0.5e-6, 1000).unwrap();
//! assert!((scale.position(998).to_m() + 1e-6).abs() < 1e-15);
//! ```

use crate::units::{PER_M, Position};

/// A linear scale or encoder on a 32-bit counter.
#[derive(Clone, Copy, Debug)]
pub struct Counter {
    /// Position units per count, 32 fraction bits.
    units: i64,
    zero: u32,
}

impl Counter {
    /// At position zero when the counter reads `zero`. `metres_per_count` is negative if the counter decreases in the positive
    /// direction of the axis.
    ///
    /// `None` unless the magnitude of a count is 1 pm to 1 µm. It is rounded to 2⁻³² position units: over the 2³¹ counts of the
    /// range an error below a quarter of a unit.
    #[must_use]
    pub fn new(metres_per_count: f64, zero: u32) -> Option<Self> {
        let plausible = (1e-12..=1e-6).contains(&libm::fabs(metres_per_count));
        #[expect(clippy::cast_possible_truncation, reason = "1.05e9 units per µm, times 2³²")]
        let units = libm::rint(metres_per_count * PER_M * 4_294_967_296.0) as i64;
        plausible.then_some(Self { units, zero })
    }

    /// The position for a counter value.
    #[must_use]
    pub fn position(&self, raw: u32) -> Position {
        let counts = raw.wrapping_sub(self.zero).cast_signed();
        #[expect(clippy::cast_possible_truncation, reason = "2³¹ counts of 2³⁰ units")]
        let position = ((i128::from(counts) * i128::from(self.units)) >> 32) as i64;
        Position(position)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Within a unit and the rounding of the double-precision comparison, for the whole range of the counter and both signs.
        #[test]
        fn the_position_is_proportional_to_the_count(zero: u32, counts: i32, metres in 1e-9..1e-6f64, negative: bool) {
            let metres = if negative { -metres } else { metres };
            let counter = Counter::new(metres, zero).unwrap();
            let position = counter.position(zero.wrapping_add_signed(counts));
            let exact = f64::from(counts) * metres * PER_M;
            prop_assert!((position.0 as f64 - exact).abs() <= 1.0 + exact.abs() * 1e-15 + 0.25);
        }
    }

    #[test]
    fn implausible_counts_are_rejected() {
        for metres in [f64::NAN, f64::INFINITY, 0.0, 0.9e-12, 1.1e-6, -1.1e-6] {
            assert!(Counter::new(metres, 0).is_none(), "{metres}");
        }
        assert!(Counter::new(1e-12, 0).is_some() && Counter::new(-1e-6, 0).is_some());
    }
}
