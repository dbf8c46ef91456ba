//! A rational ratio of position units to counts, without drift and without a division in a tick.
//!
//! With D position units for C counts, D = w·C + r and 0 ≤ r < C. In a tick in which the counter moves by Δ, the setpoint moves by
//! w·Δ + ⌊(r·Δ + remainder)/C⌋, and what remains of the division is the next remainder: the sum of all ticks is ⌊D·n/C⌋ for n counts, to the
//! unit, in whatever parts they come and however often the counter wraps.
//!
//! ```
//! use shared::interpolate::following::gear::{Gear, GearState};
//!
//! // 10 units for 3 counts.
//! let gear = Gear::new(10, 3).unwrap();
//! let mut state = GearState::at(u32::MAX);
//! // The counter wraps. 3.3 and 6.7 units, then back to 0.
//! assert_eq!([0, 1, u32::MAX].map(|count| gear.step(&mut state, count)), [3, 3, -6]);
//! ```

/// Greatest distance of a count, position units: 1.05 mm.
const GREATEST_UNITS: u64 = 1 << 40;

/// A ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gear {
    /// w, position units per count, rounded down.
    whole: i64,
    /// r, 0 to C − 1.
    rest: u32,
    /// C, up to 2³¹ − 1.
    counts: u32,
    /// ⌊(2⁶⁴ − 1)/C⌋.
    reciprocal: u64,
}

/// The counter at the last tick, and what the setpoint is behind D·n/C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GearState {
    count: u32,
    /// 0 to C − 1, in 1/C of a position unit.
    remainder: u32,
}

impl GearState {
    /// At a count, with nothing left of it.
    #[must_use]
    pub const fn at(count: u32) -> Self {
        Self { count, remainder: 0 }
    }
}

impl Gear {
    /// `distance` position units for `counts`. `None` for a distance of 0 or beyond 2⁴⁰ units a count, or a number of counts outside 1 to 2³¹ − 1.
    #[must_use]
    pub fn new(distance: i64, counts: u32) -> Option<Self> {
        let is_valid = distance != 0
            && (1..=u32::MAX >> 1).contains(&counts)
            && distance.unsigned_abs().div_ceil(u64::from(counts)) <= GREATEST_UNITS;
        if !is_valid {
            return None;
        }
        let divisor = i64::from(counts);
        let rest = u32::try_from(distance.rem_euclid(divisor)).ok()?;
        let reciprocal = u64::MAX / u64::from(counts);
        Some(Self { whole: distance.div_euclid(divisor), rest, counts, reciprocal })
    }

    /// How far the setpoint moves with the counter, position units. The counter must have moved by less than half its range since the last call.
    #[inline]
    pub fn step(&self, state: &mut GearState, count: u32) -> i64 {
        let moved = i64::from(count.wrapping_sub(state.count).cast_signed());
        state.count = count;
        let (carry, remainder) = self.divided(moved * i64::from(self.rest) + i64::from(state.remainder));
        state.remainder = remainder;
        // Up to 2³¹ counts of 2⁴⁰ units.
        moved.saturating_mul(self.whole).saturating_add(carry)
    }

    /// Quotient, rounded down, and remainder of a division by C, for −2³¹·C ≤ value < 2³¹·C.
    fn divided(&self, value: i64) -> (i64, u32) {
        let counts = u64::from(self.counts);
        // Not negative with 2³¹·C more, below 2⁶³.
        let value = value.wrapping_add(i64::from(self.counts) << 31).cast_unsigned();
        let mut quotient = ((u128::from(value) * u128::from(self.reciprocal)) >> 64) as u64;
        let mut remainder = value.wrapping_sub(quotient.wrapping_mul(counts));
        // The reciprocal is less than 1 + 1/C too small, and value below 2⁶³: the quotient is at most 1 too small.
        if remainder >= counts {
            (quotient, remainder) = (quotient + 1, remainder - counts);
        }
        #[expect(clippy::cast_possible_truncation, reason = "below C")]
        let remainder = remainder as u32;
        (quotient.cast_signed() - (1 << 31), remainder)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// The sum of the steps is ⌊D·n/C⌋ after each of them, to the unit.
        #[test]
        fn the_setpoint_does_not_drift(
            distance in -(1i64 << 45)..1 << 45, counts in 1u32..1 << 31, start: u32,
            moves in proptest::collection::vec(prop_oneof![-3i32..=3, any::<i32>()], 1..60),
        ) {
            // At most 2⁴⁰ units a count.
            let distance = if distance.unsigned_abs() / u64::from(counts) >= GREATEST_UNITS { distance >> 32 } else { distance };
            prop_assume!(distance != 0);
            let gear = Gear::new(distance, counts).unwrap();
            let (mut state, mut count) = (GearState::at(start), start);
            let (mut n, mut sum) = (0i128, 0i128);
            for moved in moves {
                count = count.wrapping_add_signed(moved);
                n += i128::from(moved);
                sum += i128::from(gear.step(&mut state, count));
                prop_assert_eq!(sum, (n * i128::from(distance)).div_euclid(i128::from(counts)));
            }
        }
    }

    #[test]
    fn ratios_out_of_range_are_rejected() {
        for (distance, counts) in
            [(0, 5), (5, 0), (5, 1 << 31), ((1 << 40) + 1, 1), (-(1 << 40) - 1, 1), (i64::MIN, 1)]
        {
            assert_eq!(Gear::new(distance, counts), None, "{distance}/{counts}");
        }
        for (distance, counts) in [(1 << 40, 1), (-(1 << 40), 1), (1, (1 << 31) - 1), (-1, 1)] {
            assert!(Gear::new(distance, counts).is_some(), "{distance}/{counts}");
        }
    }
}
