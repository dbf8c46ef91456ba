//! Whole numbers in groups of four bits: three bits of the number, the lowest first, and one that says that more follow.
//!
//! Negative numbers are mapped to odd ones (0, −1, 1, −2 … to 0, 1, 2, 3 …), so that −4 to 3 take one group and −32 to 31 two.

/// Groups of the longest number: 64 bits by three.
pub const LONGEST: usize = 22;

/// Bit that says that more groups follow.
const MORE: u8 = 8;

/// Writes numbers from a position in a buffer onwards. The rest of the buffer need not be zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Writer {
    /// Groups that have been written.
    pub groups: usize,
}

impl Writer {
    /// Appends a number. False if the buffer is full; part of the number may have been written then.
    #[inline]
    pub fn push(&mut self, value: i64, bytes: &mut [u8]) -> bool {
        let mut rest = ((value << 1) ^ (value >> 63)).cast_unsigned();
        loop {
            let low = (rest & 7) as u8;
            rest >>= 3;
            let group = if rest == 0 { low } else { low | MORE };
            let Some(byte) = bytes.get_mut(self.groups / 2) else { return false };
            *byte = if self.groups.is_multiple_of(2) { group } else { *byte | group << 4 };
            self.groups += 1;
            if rest == 0 {
                return true;
            }
        }
    }

    /// Bytes that have been written, including one that is half full.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        self.groups.div_ceil(2)
    }
}

/// Reads numbers.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    groups: usize,
}

impl<'a> Reader<'a> {
    /// Reads from the start.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, groups: 0 }
    }

    /// The next number; `None` at the end, or if it is longer than 64 bits.
    pub fn pull(&mut self) -> Option<i64> {
        let mut value = 0u64;
        for group in 0..LONGEST {
            let byte = self.bytes.get(self.groups / 2)?;
            let bits = if self.groups.is_multiple_of(2) { byte & 15 } else { byte >> 4 };
            self.groups += 1;
            let low = u64::from(bits & !MORE);
            // The last of 22 groups has one bit.
            if group + 1 == LONGEST && bits > 1 {
                return None;
            }
            value |= low << (3 * group);
            if bits & MORE == 0 {
                return Some((value >> 1).cast_signed() ^ -(value & 1).cast_signed());
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn numbers_are_read_as_written(values in proptest::collection::vec(any::<(i64, u32)>(), 1..40)) {
            // Of every length, not only long ones.
            let values: std::vec::Vec<i64> = values.into_iter().map(|(value, shift)| value >> (shift % 64)).collect();
            let mut bytes = [0xff; 40 * LONGEST / 2];
            let mut writer = Writer::default();
            for value in &values {
                prop_assert!(writer.push(*value, &mut bytes));
            }
            let mut reader = Reader::new(&bytes[..writer.bytes()]);
            for value in &values {
                prop_assert_eq!(reader.pull(), Some(*value));
            }
        }

        #[test]
        fn any_bytes_are_read_without_a_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let mut reader = Reader::new(&bytes);
            let mut numbers = 0;
            while reader.pull().is_some() {
                numbers += 1;
            }
            prop_assert!(numbers <= 2 * bytes.len());
        }
    }

    #[test]
    fn small_numbers_take_one_group() {
        for (value, groups) in
            [(0, 1), (3, 1), (-4, 1), (4, 2), (31, 2), (-32, 2), (32, 3), (i64::MAX, 22), (i64::MIN, 22)]
        {
            let mut writer = Writer::default();
            assert!(writer.push(value, &mut [0; 16]));
            assert_eq!(writer.groups, groups, "{value}");
        }
    }

    #[test]
    fn a_full_buffer_is_reported() {
        let mut bytes = [0; 1];
        let mut writer = Writer::default();
        assert!(writer.push(1, &mut bytes) && writer.push(-1, &mut bytes));
        assert!(!writer.push(1, &mut bytes));
    }

    /// 21 groups have 63 bits. The last has the one that is left: 0 or 1, with none to follow.
    #[test]
    fn a_number_of_more_than_64_bits_is_none() {
        for (last, expected) in
            [(0, Some(0)), (1, Some(1i64 << 62)), (2, None), (7, None), (8, None), (9, None)]
        {
            // Zeros, each with more to follow.
            let mut bytes = [0x88; LONGEST / 2];
            bytes[LONGEST / 2 - 1] = last << 4 | 8;
            assert_eq!(Reader::new(&bytes).pull(), expected, "{last}");
        }
    }
}
