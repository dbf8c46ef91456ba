//! Distances up to a limit in either direction, compared by one instruction less than their magnitude.

/// Distances from −limit to +limit, position units.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    limit: i64,
    width: u64,
}

impl Band {
    /// Every distance of positions, which are less than 2⁵⁷ from zero.
    pub const UNLIMITED: Self = Self::new(1 << 62);

    /// For a limit of at most 2⁶², 4400 m.
    #[must_use]
    pub const fn new(limit: u64) -> Self {
        Self { limit: limit.cast_signed(), width: 2 * limit }
    }

    /// Whether a distance is within the limit, itself included.
    #[inline]
    #[must_use]
    pub const fn contains(&self, distance: i64) -> bool {
        distance.wrapping_add(self.limit).cast_unsigned() <= self.width
    }
}
