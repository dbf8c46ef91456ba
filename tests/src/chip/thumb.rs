//! Effect of a Thumb-2 instruction on the program counter (ARMv7-M reference manual, chapter A5 and A7.7).

/// Effect of an instruction on the program counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// The next instruction, or a return.
    Next,
    /// A jump to an address, conditional or not.
    To(u32),
    /// A call of an address: the return address is saved.
    Call(u32),
    /// A call or jump through a register or a table of addresses in memory.
    Indirect,
    /// A permanently undefined instruction, or one that this core does not have.
    Trap,
}

/// The flow of the instruction `high` `low` at an address, and its length in bytes.
#[must_use]
pub fn decode(address: u32, high: u16, low: u16) -> (Flow, u32) {
    if high >= 0xe800 { (wide(address, high, low), 4) } else { (narrow(address, high), 2) }
}

/// The target of a relative branch: the lowest `bits` bits of `value`, sign-extended, added to the program counter,
/// which is 4 ahead of the instruction.
fn relative(address: u32, value: u32, bits: u32) -> u32 {
    let unused = 32 - bits;
    let offset = (value << unused).cast_signed() >> unused;
    address.wrapping_add(4).wrapping_add_signed(offset)
}

fn narrow(address: u32, high: u16) -> Flow {
    let bits = u32::from(high);
    match high >> 12 {
        // B<c> label; conditions 14 and 15 are UDF and SVC.
        0b1101 => match (high >> 8) & 15 {
            14 => Flow::Trap,
            15 => Flow::Next,
            _ => Flow::To(relative(address, (bits & 0xff) << 1, 9)),
        },
        // B label.
        0b1110 => Flow::To(relative(address, (bits & 0x7ff) << 1, 12)),
        // CBZ, CBNZ: forward only.
        0b1011 if high & 0xf500 == 0xb100 => {
            let offset = (bits & 0x200) >> 3 | (bits & 0xf8) >> 2;
            Flow::To(address + 4 + offset)
        }
        // BX LR returns; BX and BLX of other registers are indirect.
        0b0100 if high == 0x4770 => Flow::Next,
        0b0100 if high & 0xff00 == 0x4700 => Flow::Indirect,
        // ADD PC, reg and MOV PC, reg.
        0b0100 if high & 0xfd87 == 0x4487 => {
            if high == 0x46f7 {
                Flow::Next
            } else {
                Flow::Indirect
            }
        }
        _ => Flow::Next,
    }
}

fn wide(address: u32, high: u16, low: u16) -> Flow {
    let (h, l) = (u32::from(high), u32::from(low));
    if high & 0xf800 == 0xf000 && low & 0x8000 != 0 {
        let sign = (h >> 10) & 1;
        // B.W label and BL label share their offset: S:I1:I2:imm10:imm11:0, I = not (J xor S).
        let far = || {
            let i1 = !((l >> 13) ^ sign) & 1;
            let i2 = !((l >> 11) ^ sign) & 1;
            relative(address, sign << 24 | i1 << 23 | i2 << 22 | (h & 0x3ff) << 12 | (l & 0x7ff) << 1, 25)
        };
        return match (low >> 12) & 0b0101 {
            0b0001 => Flow::To(far()),
            0b0101 => Flow::Call(far()),
            // BLX label changes to the ARM instruction set, which this core does not have.
            0b0100 => Flow::Trap,
            // B<c>.W label: S:J2:J1:imm6:imm11:0; conditions 14 and 15 are system instructions.
            _ if (high >> 7) & 7 != 7 => {
                let (j1, j2) = ((l >> 13) & 1, (l >> 11) & 1);
                let offset = sign << 20 | j2 << 19 | j1 << 18 | (h & 0x3f) << 12 | (l & 0x7ff) << 1;
                Flow::To(relative(address, offset, 21))
            }
            _ if high & 0xfff0 == 0xf7f0 && low & 0xf000 == 0xa000 => Flow::Trap,
            _ => Flow::Next,
        };
    }
    // TBB, TBH: the targets are within the function, all of which is walked.
    if high & 0xfff0 == 0xe8d0 && low & 0xffe0 == 0xf000 {
        return Flow::Next;
    }
    // LDR PC, …: a return where it pops one word from the stack.
    if high & 0xff70 == 0xf850 && low & 0xf000 == 0xf000 {
        let pops = high == 0xf85d && low == 0xfb04;
        return if pops { Flow::Next } else { Flow::Indirect };
    }
    // LDM with the program counter from any register but the stack pointer.
    if (high & 0xffd0 == 0xe890 || high & 0xffd0 == 0xe910) && low & 0x8000 != 0 && high & 15 != 13 {
        return Flow::Indirect;
    }
    Flow::Next
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_of_the_manual_and_of_an_assembler() {
        // Checked against `llvm-objdump -d` of the same bytes at 0x1000.
        let flow = |high, low| decode(0x1000, high, low).0;
        assert_eq!(flow(0xf000, 0xf880), Flow::Call(0x1104)); // bl
        assert_eq!(flow(0xf7ff, 0xfffe), Flow::Call(0x1000)); // bl to itself
        assert_eq!(flow(0xf7ff, 0xbffe), Flow::To(0x1000)); // b.w
        assert_eq!(flow(0xf43f, 0xaffe), Flow::To(0x1000)); // beq.w
        assert_eq!(flow(0xe7fe, 0), Flow::To(0x1000)); // b
        assert_eq!(flow(0xd0fe, 0), Flow::To(0x1000)); // beq
        assert_eq!(flow(0xb108, 0), Flow::To(0x1006)); // cbz r0
        assert_eq!(flow(0xbb08, 0), Flow::To(0x1046)); // cbnz r0
        assert_eq!(flow(0x4798, 0), Flow::Indirect); // blx r3
        assert_eq!(flow(0x4718, 0), Flow::Indirect); // bx r3
        assert_eq!(flow(0x4770, 0), Flow::Next); // bx lr
        assert_eq!(flow(0x469f, 0), Flow::Indirect); // mov pc, r3
        assert_eq!(flow(0x4698, 0), Flow::Next); // mov r8, r3
        assert_eq!(flow(0xbd10, 0), Flow::Next); // pop {r4, pc}
        assert_eq!(flow(0xde00, 0), Flow::Trap); // udf
        assert_eq!(flow(0xf7f0, 0xa000), Flow::Trap); // udf.w
        assert_eq!(flow(0xf85d, 0xfb04), Flow::Next); // pop.w {pc}
        assert_eq!(flow(0xf8d3, 0xf000), Flow::Indirect); // ldr.w pc, [r3]
        assert_eq!(flow(0xe8bd, 0x8010), Flow::Next); // pop.w {r4, pc}
        assert_eq!(flow(0xe8b3, 0x8010), Flow::Indirect); // ldm r3!, {r4, pc}
        assert_eq!(flow(0xe8df, 0xf000), Flow::Next); // tbb [pc, r0]
        assert_eq!(flow(0xf3bf, 0x8f5f), Flow::Next); // dmb
        assert_eq!(flow(0xf04f, 0x30ff), Flow::Next); // mov.w r0, #-1
        assert_eq!(decode(0, 0xbd10, 0).1, 2);
        assert_eq!(decode(0, 0xf04f, 0).1, 4);
    }
}
