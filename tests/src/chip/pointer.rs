//! Effect of a Thumb-2 instruction on the stack pointer (ARMv7-M reference manual, chapters A5 to A7).

/// Number of the stack pointer among the registers.
const SP: u32 = 13;

/// Effect of an instruction on the stack pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pointer {
    /// None.
    Kept,
    /// Lowers it by this many bytes.
    Lowered(u32),
    /// Lowers it by the value of this register.
    LoweredBy(u32),
    /// Raises it: releases stack.
    Raised,
    /// Sets it to a value that the instruction alone does not determine.
    Set,
}

/// Effect of the instruction `high` `low` on the stack pointer; `low` matters for 32-bit instructions only.
///
/// Instructions that the manual calls unpredictable, such as a multiplication into the stack pointer, are not
/// recognised: no compiler emits them.
#[must_use]
pub fn pointer(high: u16, low: u16) -> Pointer {
    if high >= 0xe800 { wide(u32::from(high), u32::from(low)) } else { narrow(u32::from(high)) }
}

fn narrow(h: u32) -> Pointer {
    match h {
        // PUSH {r0-r7, lr}.
        _ if h & 0xfe00 == 0xb400 => Pointer::Lowered(4 * (h & 0x1ff).count_ones()),
        // POP {r0-r7, pc}.
        _ if h & 0xfe00 == 0xbc00 => Pointer::Raised,
        // ADD SP, #imm7·4 and SUB SP, #imm7·4.
        _ if h & 0xff80 == 0xb000 => Pointer::Raised,
        _ if h & 0xff80 == 0xb080 => Pointer::Lowered(4 * (h & 0x7f)),
        // ADD SP, reg and MOV SP, reg.
        _ if h & 0xff87 == 0x4485 || h & 0xff87 == 0x4685 => Pointer::Set,
        _ => Pointer::Kept,
    }
}

fn wide(h: u32, l: u32) -> Pointer {
    let (base, destination) = (h & 15, (l >> 8) & 15);
    match h >> 9 {
        // STM, LDM, VSTM, VLDM, STRD, LDRD and the loads and stores of one word.
        0b111_0100 if h & 0x40 == 0 => several(h, base, l.count_ones()),
        0b111_0100 => pair(h, l, base),
        0b111_0110 => several(h, base, l & 0xff),
        0b111_1100 => single(h, l, base),
        // Two registers, the second one shifted; an immediate of 12 bits.
        0b111_0101 if destination == SP => by_register(h, l, base),
        0b111_1000..=0b111_1011 if l & 0x8000 == 0 && destination == SP => by_immediate(h, l, base),
        // MSR MSP and MSR PSP.
        0b111_1001 if h & 0xfff0 == 0xf380 && matches!(l, 0x8808 | 0x8809) => Pointer::Set,
        _ => Pointer::Kept,
    }
}

/// Write-back of the stack pointer as a base, up or down by a number of bytes.
fn moved(up: bool, bytes: u32) -> Pointer {
    if up { Pointer::Raised } else { Pointer::Lowered(bytes) }
}

/// STM, LDM, VSTM and VLDM of a number of words: P (bit 8), U (bit 7), W (bit 5), L (bit 4).
fn several(h: u32, base: u32, words: u32) -> Pointer {
    if base != SP || h & 0x20 == 0 {
        return Pointer::Kept;
    }
    match (h & 0x100 != 0, h & 0x80 != 0) {
        (true, false) => Pointer::Lowered(4 * words),
        (false, true) => Pointer::Raised,
        _ => Pointer::Set,
    }
}

/// STRD and LDRD: P (bit 8), U (bit 7), W (bit 5), imm8·4. Without P and W the encoding is another instruction.
fn pair(h: u32, l: u32, base: u32) -> Pointer {
    if base != SP || h & 0x20 == 0 { Pointer::Kept } else { moved(h & 0x80 != 0, 4 * (l & 0xff)) }
}

/// STR, LDR and their byte and halfword forms.
fn single(h: u32, l: u32, base: u32) -> Pointer {
    let loads_word = h & 0x70 == 0x50;
    if loads_word && l >> 12 == SP {
        return Pointer::Set;
    }
    // imm8 with U (bit 9) and W (bit 8); the other forms do not write back.
    let writes_back = h & 0x80 == 0 && l & 0x900 == 0x900;
    if base == SP && writes_back { moved(l & 0x200 != 0, l & 0xff) } else { Pointer::Kept }
}

/// Data processing of registers into the stack pointer; only an unshifted SUB from itself is evaluated.
fn by_register(h: u32, l: u32, base: u32) -> Pointer {
    let (operation, unshifted) = ((h >> 5) & 15, l & 0x70f0 == 0);
    if operation == 0b1101 && base == SP && unshifted { Pointer::LoweredBy(l & 15) } else { Pointer::Set }
}

/// Data processing of an immediate into the stack pointer: ADD and SUB, modified or of 12 bits.
fn by_immediate(h: u32, l: u32, base: u32) -> Pointer {
    let plain = (h & 0x400) << 1 | (l & 0x7000) >> 4 | l & 0xff;
    match (h & 0x200 != 0, (h >> 5) & 15, h & 0x10 != 0) {
        _ if base != SP => Pointer::Set,
        (false, 0b1000, _) | (true, 0b0000, false) => Pointer::Raised,
        (false, 0b1101, _) => Pointer::Lowered(expanded(plain)),
        (true, 0b0101, false) => Pointer::Lowered(plain),
        _ => Pointer::Set,
    }
}

/// The value of a modified immediate of 12 bits: a repeated byte, or a byte with its top bit set, rotated.
#[must_use]
pub fn expanded(coded: u32) -> u32 {
    let byte = coded & 0xff;
    match coded >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (0x80 | coded & 0x7f).rotate_right(coded >> 7),
    }
}

/// The constant that an instruction loads into a register: `movw`, `mov.w`, `movs`.
#[must_use]
pub fn constant(high: u16, low: u16, register: u32) -> Option<u32> {
    let (h, l) = (u32::from(high), u32::from(low));
    if high < 0xe800 {
        return (h & 0xf800 == 0x2000 && (h >> 8) & 7 == register).then_some(h & 0xff);
    }
    let coded = (h & 0x400) << 1 | (l & 0x7000) >> 4 | l & 0xff;
    match (h & 0xfbff, h & 0xfbf0) {
        _ if l & 0x8000 != 0 || (l >> 8) & 15 != register => None,
        (_, 0xf240) => Some((h & 15) << 12 | coded),
        (0xf04f | 0xf05f, _) => Some(expanded(coded)),
        _ => None,
    }
}

/// The upper half that `movt` loads into a register.
#[must_use]
pub fn upper_half(high: u16, low: u16, register: u32) -> Option<u32> {
    let (h, l) = (u32::from(high), u32::from(low));
    let is = h & 0xfbf0 == 0xf2c0 && l & 0x8000 == 0 && (l >> 8) & 15 == register;
    is.then_some((h & 15) << 12 | (h & 0x400) << 1 | (l & 0x7000) >> 4 | l & 0xff)
}

#[cfg(test)]
mod tests {
    use super::Pointer::{Kept, Lowered, LoweredBy, Raised, Set};
    use super::*;

    /// Bytes and text of `llvm-mc -triple=thumbv7em-none-eabihf -show-encoding`.
    #[rustfmt::skip]
    const ASSEMBLED: &[(u16, u16, &str, Pointer)] = &[
        (0xb5f0, 0x0000, "push {r4, r5, r6, r7, lr}", Lowered(20)),
        (0xb401, 0x0000, "push {r0}", Lowered(4)),
        (0xe92d, 0x0f00, "push.w {r8, r9, r10, r11}", Lowered(16)),
        (0xf84d, 0xbd04, "str r11, [sp, #-4]!", Lowered(4)),
        (0xf84d, 0x0908, "str r0, [sp], #-8", Lowered(8)),
        (0xf80d, 0x0d10, "strb r0, [sp, #-16]!", Lowered(16)),
        (0xe96d, 0x0104, "strd r0, r1, [sp, #-16]!", Lowered(16)),
        (0xed2d, 0x8b04, "vpush {d8, d9}", Lowered(16)),
        (0xed2d, 0x8a01, "vpush {s16}", Lowered(4)),
        (0xed2d, 0x8b10, "vpush {d8, d9, d10, d11, d12, d13, d14, d15}", Lowered(64)),
        (0xb0ff, 0x0000, "sub sp, #508", Lowered(508)),
        (0xf5ad, 0x3db1, "sub.w sp, sp, #90624", Lowered(90_624)),
        (0xf5ad, 0x3d80, "sub.w sp, sp, #65536", Lowered(65_536)),
        (0xf2ad, 0x5d74, "subw sp, sp, #1396", Lowered(1396)),
        (0xf5ad, 0x7d69, "sub.w sp, sp, #932", Lowered(932)),
        (0xebad, 0x0d04, "sub.w sp, sp, r4", LoweredBy(4)),
        (0xebad, 0x0d84, "sub.w sp, sp, r4, lsl #2", Set),
        (0x46bd, 0x0000, "mov sp, r7", Set),
        (0x44a5, 0x0000, "add sp, r4", Set),
        (0xeb0d, 0x0d04, "add.w sp, sp, r4", Set),
        (0xf8d0, 0xd000, "ldr.w sp, [r0]", Set),
        (0xf380, 0x8808, "msr msp, r0", Set),
        (0xf380, 0x8809, "msr psp, r0", Set),
        (0xf380, 0x8811, "msr basepri, r0", Kept),
        (0xe89d, 0x0030, "ldm.w sp, {r4, r5}", Kept),
        (0xe93d, 0x0030, "ldmdb sp!, {r4, r5}", Lowered(8)),
        (0xe8ad, 0x0030, "stm.w sp!, {r4, r5}", Raised),
        (0xbd10, 0x0000, "pop {r4, pc}", Raised),
        (0xe8bd, 0x0300, "pop.w {r8, r9}", Raised),
        (0xf85d, 0xbb04, "ldr r11, [sp], #4", Raised),
        (0xe8fd, 0x0102, "ldrd r0, r1, [sp], #8", Raised),
        (0xecbd, 0x8b04, "vpop {d8, d9}", Raised),
        (0xb07f, 0x0000, "add sp, #508", Raised),
        (0xf20d, 0x4d3c, "addw sp, sp, #1084", Raised),
        (0xf50d, 0x3db1, "add.w sp, sp, #90624", Raised),
        (0xaf03, 0x0000, "add r7, sp, #12", Kept),
        (0xf50d, 0x6780, "add.w r7, sp, #1024", Kept),
        (0xf1ad, 0x0408, "sub.w r4, sp, #8", Kept),
        (0x9001, 0x0000, "str r0, [sp, #4]", Kept),
        (0xf8cd, 0x0190, "str.w r0, [sp, #400]", Kept),
        (0xf84d, 0x0c04, "str r0, [sp, #-4]", Kept),
        (0xe9cd, 0x0102, "strd r0, r1, [sp, #8]", Kept),
        (0xed8d, 0x8b02, "vstr d8, [sp, #8]", Kept),
        (0xed9d, 0x8b02, "vldr d8, [sp, #8]", Kept),
        (0xecb0, 0x8b02, "vldmia r0!, {d8}", Kept),
        (0xf84d, 0x4d04, "str r4, [sp, #-4]!", Lowered(4)),
        (0xf851, 0x0d04, "ldr r0, [r1, #-4]!", Kept),
        (0xe920, 0x0030, "stmdb r0!, {r4, r5}", Kept),
        (0xf1bd, 0x0f08, "cmp.w sp, #8", Kept),
        (0xf010, 0x0f08, "tst.w r0, #8", Kept),
        (0xf000, 0xf9f4, "bl #1000", Kept),
        (0xe8df, 0xf000, "tbb [pc, r0]", Kept),
        (0xf3bf, 0x8f5f, "dmb sy", Kept),
        (0xeef1, 0xfa10, "vmrs APSR_nzcv, fpscr", Kept),
        (0xee30, 0x0a81, "vadd.f32 s0, s1, s2", Kept),
        (0xec51, 0x0b10, "vmov r0, r1, d0", Kept),
        (0xfb82, 0x0103, "smull r0, r1, r2, r3", Kept),
        (0xf649, 0x4440, "movw r4, #40000", Kept),
        (0xf2c0, 0x0401, "movt r4, #1", Kept),
        (0xf44f, 0x34b1, "mov.w r4, #90624", Kept),
        (0x2407, 0x0000, "movs r4, #7", Kept),
    ];

    #[test]
    fn instructions_of_an_assembler() {
        for &(high, low, text, expected) in ASSEMBLED {
            assert_eq!(pointer(high, low), expected, "{text}");
        }
    }

    #[test]
    fn constants_of_an_assembler() {
        assert_eq!(constant(0xf649, 0x4440, 4), Some(40_000), "movw r4, #40000");
        assert_eq!(constant(0xf649, 0x4440, 5), None, "the same, asked for r5");
        assert_eq!(constant(0xf44f, 0x34b1, 4), Some(90_624), "mov.w r4, #90624");
        assert_eq!(constant(0x2407, 0, 4), Some(7), "movs r4, #7");
        assert_eq!(constant(0xf2c0, 0x0401, 4), None, "movt r4, #1");
        assert_eq!(upper_half(0xf2c0, 0x0401, 4), Some(1), "movt r4, #1");
        assert_eq!(upper_half(0xf649, 0x4440, 4), None, "movw r4, #40000");
    }
}
