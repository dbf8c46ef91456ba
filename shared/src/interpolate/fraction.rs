//! Path lengths and speeds with fraction bits.

/// Fraction bits of lengths and speeds that are accumulated.
pub(crate) const FRACTION: u32 = 64;

/// Whole position units of a length with 64 fraction bits.
#[must_use]
pub(crate) const fn whole(length: i128) -> i64 {
    (length >> FRACTION) as i64
}

/// A speed with 16 fraction bits from an increment per tick with 64; 0 for a negative increment.
#[must_use]
pub(crate) const fn speed(increment: i128) -> u64 {
    if increment < 0 {
        return 0;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "feeds are below 2⁵⁷")]
    let speed = (increment >> (FRACTION - 16)) as u64;
    speed
}
