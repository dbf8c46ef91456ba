//! The correction that makes an arc end exactly at a given point.

use crate::integer::mul_q32;

/// The difference between a given end point and the end on the circle, distributed linearly over the arc length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct EndCorrection {
    /// Given end − end on the circle, in the axes of the plane, position units.
    difference: [i64; 2],
    /// 1/arc length, with `shift` + 32 fraction bits.
    fraction_per_unit: u64,
    shift: u32,
    /// Magnitude of the difference over the arc length, 32 fraction bits.
    per_length: u64,
}

impl EndCorrection {
    /// For an arc of `length` position units; `None` if there is no difference. `per_length` is at most 2²².
    pub(super) fn new(difference: [i64; 2], length: u128, per_length: u128) -> Option<Self> {
        // The reciprocal has 63 or 64 significant bits for any length.
        let shift = length.ilog2();
        #[expect(clippy::cast_possible_truncation, reason = "see above, and at most 2²²")]
        let (fraction_per_unit, per_length) = (((1u128 << (shift + 63)) / length) as u64, per_length as u64);
        (difference != [0; 2]).then_some(Self {
            difference,
            fraction_per_unit,
            shift: shift + 31,
            per_length,
        })
    }

    pub(super) const fn per_length(&self) -> u64 {
        self.per_length
    }

    /// The correction at a path length, position units.
    pub(super) fn at(&self, length: i64) -> [i64; 2] {
        let fraction = (u128::from(length.unsigned_abs()) * u128::from(self.fraction_per_unit)) >> self.shift;
        let fraction = u32::try_from(fraction).unwrap_or(u32::MAX);
        self.difference.map(|difference| mul_q32(difference, fraction))
    }

    /// Contribution to the direction of travel, 62 fraction bits.
    pub(super) fn direction(&self, length: i64) -> [i64; 2] {
        #[expect(clippy::cast_possible_truncation, reason = "at most 1/1024")]
        self.difference.map(|d| ((i128::from(d) << 62) / i128::from(length.max(1))) as i64)
    }
}
