//! Loads and stores of one word: which register, and where (ARMv7-M reference manual, A5.2.4, A5.3.7, A5.3.10).

/// A load or store of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// From memory into the register.
    pub loads: bool,
    /// The register that is loaded or stored.
    pub register: u32,
    /// Register with the address.
    pub base: u32,
    /// What is added to it, bytes.
    pub offset: u32,
}

/// The load or store that an instruction is, where it is one with a constant offset above its base: what
/// compilers use for the registers of a peripheral.
#[must_use]
pub fn word(high: u16, low: u16) -> Option<Word> {
    let (h, l) = (u32::from(high), u32::from(low));
    match (h & 0xf000, h & 0xfff0) {
        (0x6000, _) => {
            let offset = (h >> 4) & 0x7c;
            Some(Word { loads: h & 0x800 != 0, register: h & 7, base: (h >> 3) & 7, offset })
        }
        (_, 0xf8c0 | 0xf8d0) => {
            Some(Word { loads: h & 0x10 != 0, register: l >> 12, base: h & 15, offset: l & 0xfff })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_and_stores_of_an_assembler() {
        let is = |loads, register, base, offset| Some(Word { loads, register, base, offset });
        assert_eq!(word(0x6820, 0), is(true, 0, 4, 0), "ldr r0, [r4]");
        assert_eq!(word(0x60a1, 0), is(false, 1, 4, 8), "str r1, [r4, #8]");
        assert_eq!(word(0x6fcf, 0), is(true, 7, 1, 124), "ldr r7, [r1, #124]");
        assert_eq!(word(0xf8d4, 0x0400), is(true, 0, 4, 1024), "ldr.w r0, [r4, #1024]");
        assert_eq!(word(0xf8c4, 0xb404), is(false, 11, 4, 1028), "str.w r11, [r4, #1028]");
        // ldrb, strh, ldr with a register, push.
        for (high, low) in [(0x7820, 0), (0x8020, 0), (0x5860, 0), (0xb510, 0), (0xf894, 0x0400)] {
            assert_eq!(word(high, low), None, "{high:#x}");
        }
    }
}
