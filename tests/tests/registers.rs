//! The registers after the start-up of the board against a table, in a run of the flashed ELF file on an emulated STM32F405
//! ([`tests::board`]).
//!
//! Bits and addresses are those of the reference manual RM0090. A device that QEMU does not model reads as 0, so that a
//! read-modify-write writes the changed bits alone.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use tests::board::log::{Access, written};
use tests::board::{Chip, End};
use tests::firmware::built;

/// Registers of TIM1: name, offset, final value.
const TIM1: [(&str, u32, u32); 9] = [
    // 16.4.3: an update is the trigger output to TIM2 (MMS 010); idle outputs are low (OIS 0).
    ("CR2", 0x04, 0b010 << 4),
    // No interrupts and no DMA.
    ("DIER", 0x0c, 0),
    // 16.4.7: PWM mode 2 (111), buffered, on both channels.
    ("CCMR1", 0x18, 0x7878),
    // 16.4.9: both outputs on, active high; complementary outputs off.
    ("CCER", 0x20, 0x0011),
    // A period of 8400 counts without a pulse.
    ("ARR", 0x2c, 8399),
    ("CCR1", 0x34, 8400),
    ("CCR2", 0x38, 8400),
    // 16.4.18: break on (12), active low (13), no automatic output (14), main output off (15); outputs are driven when
    // running and idle (11, 10); lock level 2 (9:8), which protects these bits, too.
    ("BDTR", 0x44, 1 << 12 | 1 << 11 | 1 << 10 | 2 << 8),
    // The last write: counter enabled, with a buffered period.
    ("CR1", 0x00, 0x81),
];

/// Bits that must be set by a write to a register of a port or of RCC.
const BITS: [(&str, &str, u32, u32); 17] = [
    // 7.3.21: the flags of the cause of the reset are cleared.
    ("RCC", "CSR: RMVF", 0x74, 1 << 24),
    ("GPIOA", "PA8, PA9: alternate", 0x00, 0b10 << 16),
    ("GPIOA", "PA9: alternate", 0x00, 0b10 << 18),
    ("GPIOA", "PA8: TIM1 (AF1)", 0x24, 1),
    ("GPIOA", "PA9: TIM1 (AF1)", 0x24, 1 << 4),
    ("GPIOA", "PA6: TIM3 (AF2)", 0x20, 2 << 24),
    ("GPIOA", "PA7: TIM3 (AF2)", 0x20, 2 << 28),
    ("GPIOA", "PA6: pulled up", 0x0c, 0b01 << 12),
    ("GPIOA", "PA7: pulled up", 0x0c, 0b01 << 14),
    ("GPIOB", "PB6: TIM4 (AF2)", 0x20, 2 << 24),
    ("GPIOB", "PB7: TIM4 (AF2)", 0x20, 2 << 28),
    ("GPIOB", "PB6: pulled up", 0x0c, 0b01 << 12),
    ("GPIOB", "PB7: pulled up", 0x0c, 0b01 << 14),
    ("GPIOB", "PB12: TIM1 break (AF1)", 0x24, 1 << 16),
    ("GPIOB", "PB12: pulled down, a broken wire stops", 0x0c, 0b10 << 24),
    ("GPIOB", "PB14: output", 0x00, 0b01 << 28),
    ("GPIOB", "PB15: pulled down, a broken wire is open", 0x0c, 0b10 << 30),
];

/// Registers of the modelled timers after the start-up: TIM2, and the encoders TIM3 and TIM4.
const TIMERS: [(&str, u32, u32); 13] = [
    // 18.4.3: reset (SMS 100) by TIM1 (TS 000).
    ("TIM2 SMCR", 0x4000_0008, 0b100),
    ("TIM2 DIER", 0x4000_000c, 1),
    ("TIM2 CR1", 0x4000_0000, 1),
    // 18.4.7: both inputs on their own pins (01), filter of 8 samples at half the timer clock (0101).
    ("TIM3 CCMR1", 0x4000_0418, 0x5151),
    ("TIM3 CCER", 0x4000_0420, 0x0011),
    // 18.4.3: counts the edges of both inputs (SMS 011).
    ("TIM3 SMCR", 0x4000_0408, 0b011),
    ("TIM3 ARR", 0x4000_042c, 0xffff),
    ("TIM3 CR1", 0x4000_0400, 1),
    ("TIM4 CCMR1", 0x4000_0818, 0x5151),
    ("TIM4 CCER", 0x4000_0820, 0x0011),
    ("TIM4 SMCR", 0x4000_0808, 0b011),
    ("TIM4 ARR", 0x4000_082c, 0xffff),
    ("TIM4 CR1", 0x4000_0800, 1),
];

/// Enabled interrupts, and the priority of interrupt 28, TIM2, in the highest byte: the second lowest of 16 (ARMv7-M,
/// B3.4.4 and B3.4.9; RTIC's priority 1).
const INTERRUPTS: [(&str, u32, u32); 2] = [("ISER0", 0xe000_e100, 1 << 28), ("IPR7", 0xe000_e41c & !3, 0xf0)];

fn position(accesses: &[Access], device: &str, offset: u32) -> usize {
    let is = |access: &Access| access.device == device && access.offset == offset && access.written.is_some();
    accesses.iter().position(is).unwrap_or_else(|| panic!("{device} + {offset:#x} is never written"))
}

#[test]
fn the_start_up_writes_the_table() {
    let mut chip = Chip::start(&built("board"), None);
    assert_eq!(chip.run(1), Ok(End::Ticked), "{}", chip.diagnostics());
    let accesses = chip.log.accesses();
    for (name, offset, value) in TIM1 {
        let last = written(&accesses, "timer[1]", offset).last().unwrap_or(0);
        assert_eq!(last, value, "TIM1 {name}: {last:#x}, expected {value:#x}");
    }
    for (device, what, offset, bits) in BITS {
        let sets = written(&accesses, device, offset).any(|value| value & bits == bits);
        assert!(sets, "{device} {what}: bits {bits:#x} at {offset:#x}");
    }
    for (name, address, value) in TIMERS.into_iter().chain(INTERRUPTS) {
        let found = chip.target.word(address).unwrap();
        let found = if name == "IPR7" { found & 0xff } else { found };
        assert_eq!(found, value, "{name}: {found:#x}, expected {value:#x}");
    }
    assert!(chip.clocks.are_monitored(), "the clock security system is off");
}

/// The order of the writes in which the power stages get no unwanted pulse.
#[test]
fn the_power_stages_are_off_before_anything_can_switch_them_on() {
    let mut chip = Chip::start(&built("board"), None);
    assert_eq!(chip.run(1), Ok(End::Ticked), "{}", chip.diagnostics());
    let accesses = chip.log.accesses();
    let at = |device, offset| position(&accesses, device, offset);
    // PB14 is low before the wait for the crystal, after which the clock of TIM1 is enabled.
    let tim1_clock = accesses.iter().position(|access| {
        (access.device.as_str(), access.offset) == ("RCC", 0x44)
            && access.written.is_some_and(|bits| bits & 1 == 1)
    });
    assert!(at("GPIOB", 0x18) < at("GPIOB", 0x00) && at("GPIOB", 0x00) < tim1_clock.unwrap());
    // TIM1: no pulse, and the break is set up, before the counter is enabled.
    for before in [0x18, 0x34, 0x38, 0x44] {
        assert!(at("timer[1]", before) < at("timer[1]", 0x00), "{before:#x} after CR1");
    }
    // The start-up never enables the main output.
    assert!(written(&accesses, "timer[1]", 0x44).all(|bits| bits & 1 << 15 == 0));
}
