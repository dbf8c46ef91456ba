//! Numbers in binary files.

/// How the numbers of an array are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The kind of its numbers.
    pub kind: Kind,
    /// Bytes of a number.
    pub size: usize,
    /// Whether the first byte is the least significant one.
    pub is_little: bool,
}

/// A kind of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Without sign; logical values too.
    Unsigned,
    /// Two's complement.
    Signed,
    /// IEEE 754.
    Float,
}

impl Layout {
    /// Whether numbers of this kind and size are read.
    #[must_use]
    pub const fn is_known(self) -> bool {
        match self.kind {
            Kind::Float => matches!(self.size, 4 | 8),
            Kind::Signed | Kind::Unsigned => matches!(self.size, 1 | 2 | 4 | 8),
        }
    }

    /// A number from its bytes, of which there are `size`. Whole numbers above 2⁵³ are rounded.
    #[must_use]
    pub fn number(self, bytes: &[u8]) -> f64 {
        let digit = |bits: u64, byte: &u8| bits << 8 | u64::from(*byte);
        let bits =
            if self.is_little { bytes.iter().rev().fold(0, digit) } else { bytes.iter().fold(0, digit) };
        match self.kind {
            Kind::Float if self.size == 8 => f64::from_bits(bits),
            #[expect(clippy::cast_possible_truncation, reason = "four bytes")]
            Kind::Float => f64::from(f32::from_bits(bits as u32)),
            Kind::Unsigned => bits as f64,
            Kind::Signed => {
                let unused = 64 - 8 * self.size.clamp(1, 8);
                ((bits << unused).cast_signed() >> unused) as f64
            }
        }
    }

    /// The numbers of an array; a rest that is no whole number is left out.
    #[must_use]
    pub fn numbers(self, bytes: &[u8]) -> Vec<f64> {
        bytes.chunks_exact(self.size.max(1)).map(|number| self.number(number)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_kinds_are_read() {
        let of = |kind, size, is_little, bytes: &[u8]| Layout { kind, size, is_little }.numbers(bytes);
        assert_eq!(of(Kind::Signed, 2, true, &(-2i16).to_le_bytes()), [-2.0]);
        assert_eq!(of(Kind::Signed, 2, false, &(-2i16).to_be_bytes()), [-2.0]);
        assert_eq!(of(Kind::Signed, 8, true, &i64::MIN.to_le_bytes()), [-(2f64.powi(63))]);
        assert_eq!(of(Kind::Signed, 1, true, &[0xff, 0x7f]), [-1.0, 127.0]);
        assert_eq!(of(Kind::Unsigned, 4, true, &u32::MAX.to_le_bytes()), [4_294_967_295.0]);
        assert_eq!(of(Kind::Float, 4, true, &0.1f32.to_le_bytes()), [f64::from(0.1f32)]);
        assert_eq!(
            of(Kind::Float, 8, false, &[(-0.1f64).to_be_bytes(), 7f64.to_be_bytes()].concat()),
            [-0.1, 7.0]
        );
        assert_eq!(of(Kind::Float, 8, true, &[0; 7]), [0.0; 0]);
    }
}
