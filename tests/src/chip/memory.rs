//! Decoding of loads and stores of one word (ARMv7-M reference manual, A5.2.4, A5.3.7, A5.3.10).

/// A load or store of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// Whether it is a load.
    pub loads: bool,
    /// Number of the register that is loaded or stored.
    pub register: u32,
    /// Number of the base register.
    pub base: u32,
    /// What is added to the base.
    pub offset: Offset,
}

/// Offset of an address from its base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offset {
    /// Bytes.
    Bytes(i32),
    /// A register, shifted to the left by a number of bits.
    Register(u32, u32),
}

/// The load or store of a word that the instruction `high` `low` is; `None` for other instructions and for those that
/// write back the base.
#[must_use]
pub fn word(high: u16, low: u16) -> Option<Word> {
    let (h, l) = (u32::from(high), u32::from(low));
    let narrow = |loads, offset| Word { loads, register: h & 7, base: (h >> 3) & 7, offset };
    let wide = |offset| Word { loads: h & 0x10 != 0, register: l >> 12, base: h & 15, offset };
    let bytes = |unsigned: u32| Offset::Bytes(unsigned.cast_signed());
    match (h & 0xfe00, h & 0xfff0) {
        (0x5000 | 0x5800, _) => Some(narrow(h & 0x800 != 0, Offset::Register((h >> 6) & 7, 0))),
        (0x6000..0x7000, _) => Some(narrow(h & 0x800 != 0, bytes((h >> 4) & 0x7c))),
        (_, 0xf8c0 | 0xf8d0) => Some(wide(bytes(l & 0xfff))),
        (_, 0xf840 | 0xf850) if l & 0xfc0 == 0 => Some(wide(Offset::Register(l & 15, (l >> 4) & 3))),
        (_, 0xf840 | 0xf850) if l & 0xf00 == 0xc00 => Some(wide(Offset::Bytes(-(l & 0xff).cast_signed()))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::Offset::{Bytes, Register};
    use super::*;

    /// Bytes and text of `llvm-mc -triple=thumbv7em-none-eabihf -show-encoding`.
    #[test]
    fn loads_and_stores_of_an_assembler() {
        let is = |loads, register, base, offset| Some(Word { loads, register, base, offset });
        assert_eq!(word(0x6820, 0), is(true, 0, 4, Bytes(0)), "ldr r0, [r4]");
        assert_eq!(word(0x60a1, 0), is(false, 1, 4, Bytes(8)), "str r1, [r4, #8]");
        assert_eq!(word(0x6fcf, 0), is(true, 7, 1, Bytes(124)), "ldr r7, [r1, #124]");
        assert_eq!(word(0x5808, 0), is(true, 0, 1, Register(0, 0)), "ldr r0, [r1, r0]");
        assert_eq!(word(0x506b, 0), is(false, 3, 5, Register(1, 0)), "str r3, [r5, r1]");
        assert_eq!(word(0xf8d4, 0x0400), is(true, 0, 4, Bytes(1024)), "ldr.w r0, [r4, #1024]");
        assert_eq!(word(0xf8c4, 0xb404), is(false, 11, 4, Bytes(1028)), "str.w r11, [r4, #1028]");
        assert_eq!(word(0xf859, 0x000a), is(true, 0, 9, Register(10, 0)), "ldr.w r0, [r9, r10]");
        assert_eq!(word(0xf844, 0xb021), is(false, 11, 4, Register(1, 2)), "str.w r11, [r4, r1, lsl #2]");
        assert_eq!(word(0xf851, 0x0c08), is(true, 0, 1, Bytes(-8)), "ldr r0, [r1, #-8]");
        assert_eq!(word(0xf844, 0xbcff), is(false, 11, 4, Bytes(-255)), "str r11, [r4, #-255]");
    }

    #[test]
    fn other_instructions_are_none() {
        // ldr r0, [r1, #4]!; ldr r0, [r1], #4; ldrb, strh with a register and with none; push; ldrb.w.
        let others = [
            (0xf851, 0x0f04),
            (0xf851, 0x0b04),
            (0x5c6a, 0),
            (0x522a, 0),
            (0x7820, 0),
            (0x8020, 0),
            (0xb510, 0),
            (0xf894, 0x0400),
        ];
        for (high, low) in others {
            assert_eq!(word(high, low), None, "{high:#x} {low:#x}");
        }
    }
}
