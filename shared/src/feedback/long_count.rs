//! A 16-bit counter that wraps, counted on over 32 bits.
//!
//! ```
//! use shared::feedback::long_count::LongCount;
//!
//! let mut count = LongCount::at(65_530);
//! assert_eq!([count.read(4), count.read(65_535)], [10, 5]);
//! ```

/// A counter over 32 bits, which wrap as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LongCount {
    count: u32,
    last: u16,
}

impl LongCount {
    /// Zero when the counter reads `raw`.
    #[must_use]
    pub const fn at(raw: u16) -> Self {
        Self { count: 0, last: raw }
    }

    /// The count for a counter value. The counter must have moved by less than half its range since the last call.
    pub fn read(&mut self, raw: u16) -> u32 {
        let moved = raw.wrapping_sub(self.last).cast_signed();
        self.last = raw;
        self.count = self.count.wrapping_add_signed(i32::from(moved));
        self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up over 32 bits would take long: from −1 down and back it wraps both ways, and the greatest steps are 2¹⁵ − 1 up and 2¹⁵ down.
    #[test]
    fn it_counts_through_both_wraps() {
        let mut count = LongCount::at(0);
        assert_eq!(count.read(0xffff), u32::MAX);
        assert_eq!(count.read(0), 0);
        assert_eq!(count.read(0x7fff), 0x7fff);
        assert_eq!(count.read(0xfffe), 0xfffe);
        assert_eq!(count.read(0x7ffe), 0x7ffe);
        let mut sum = 0x7ffe;
        for step in 0..100_000u32 {
            let raw = (0x7ffe + 7 * (step + 1)) & 0xffff;
            sum += 7;
            let raw = raw as u16;
            assert_eq!(count.read(raw), sum);
        }
    }
}
