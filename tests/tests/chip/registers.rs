//! The registers after the start-up of the board against a table, in a run of the flashed ELF file on an emulated STM32F405
//! ([`tests::board`]).
//!
//! Bits and addresses are those of the reference manual RM0090. A device that QEMU does not model reads as 0, so that a
//! read-modify-write writes the changed bits alone.

use firmware::setup::CRYSTAL_HZ;
use tests::board::log::{Access, watchdog_periods_ms, written};
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

/// Bits that must be set by a write to a register of RCC.
const BITS: [(&str, &str, u32, u32); 3] = [
    // 7.3.21: the flags of the cause of the reset are cleared.
    ("RCC", "CSR: RMVF", 0x74, 1 << 24),
    // 7.3.12 and 7.3.7: the clock of OTG_FS, and its reset.
    ("RCC", "AHB2ENR: OTGFSEN", 0x34, 1 << 7),
    ("RCC", "AHB2RSTR: OTGFSRST", 0x14, 1 << 7),
];

/// What a pin is: its mode (8.4.1), pull (8.4.4) and alternate function (8.4.9 and 8.4.10).
#[derive(Clone, Copy)]
enum Role {
    /// Input with a pull-down: a broken wire is active.
    Contact,
    /// Output.
    Output,
    /// Of a converter.
    Analog,
    /// A device's, by its number, and pulled up (01), down (10) or not.
    Device(u32, u32),
}

/// Not pulled.
const FREE: u32 = 0b00;
/// Pulled up: an open input does not float.
const UP: u32 = 0b01;
/// Pulled down: a broken wire stops the drives.
const DOWN: u32 = 0b10;

/// Every pin of the wiring table of `docs/firmware.md`.
const PINS: [(&str, u32, Role); 44] = [
    ("GPIOA", 0, Role::Device(2, UP)),
    ("GPIOA", 1, Role::Device(2, UP)),
    ("GPIOA", 2, Role::Device(2, UP)),
    ("GPIOA", 3, Role::Contact),
    ("GPIOA", 4, Role::Analog),
    ("GPIOA", 5, Role::Analog),
    ("GPIOA", 6, Role::Device(2, UP)),
    ("GPIOA", 7, Role::Device(2, UP)),
    ("GPIOA", 8, Role::Device(1, FREE)),
    ("GPIOA", 9, Role::Device(1, FREE)),
    ("GPIOA", 10, Role::Contact),
    ("GPIOA", 11, Role::Device(10, FREE)),
    ("GPIOA", 12, Role::Device(10, FREE)),
    ("GPIOA", 15, Role::Contact),
    ("GPIOB", 0, Role::Device(2, UP)),
    ("GPIOB", 1, Role::Contact),
    ("GPIOB", 2, Role::Contact),
    ("GPIOB", 3, Role::Contact),
    ("GPIOB", 5, Role::Contact),
    ("GPIOB", 6, Role::Device(2, UP)),
    ("GPIOB", 7, Role::Device(2, UP)),
    ("GPIOB", 8, Role::Device(2, UP)),
    ("GPIOB", 9, Role::Contact),
    ("GPIOB", 10, Role::Device(7, FREE)),
    ("GPIOB", 11, Role::Device(7, UP)),
    ("GPIOB", 12, Role::Device(1, DOWN)),
    ("GPIOB", 13, Role::Contact),
    ("GPIOB", 14, Role::Output),
    ("GPIOB", 15, Role::Contact),
    ("GPIOC", 0, Role::Analog),
    ("GPIOC", 1, Role::Analog),
    ("GPIOC", 2, Role::Analog),
    ("GPIOC", 3, Role::Analog),
    ("GPIOC", 4, Role::Analog),
    ("GPIOC", 5, Role::Analog),
    ("GPIOC", 6, Role::Device(3, UP)),
    ("GPIOC", 7, Role::Device(3, UP)),
    ("GPIOC", 8, Role::Device(3, UP)),
    ("GPIOC", 9, Role::Contact),
    ("GPIOC", 10, Role::Output),
    ("GPIOC", 11, Role::Output),
    ("GPIOC", 12, Role::Contact),
    ("GPIOC", 13, Role::Output),
    ("GPIOD", 2, Role::Output),
];

/// The values that the field of a pin has had. A write that changes another pin has zeros there.
fn field(accesses: &[Access], port: &str, offset: u32, bits: u32, pin: u32) -> Vec<u32> {
    let fields = written(accesses, port, offset).map(|value| value >> (bits * pin) & ((1 << bits) - 1));
    let mut fields: Vec<u32> = fields.filter(|field| *field != 0).collect();
    fields.dedup();
    fields
}

fn pin_is_set_up(accesses: &[Access], port: &str, pin: u32, role: Role) {
    let (mode, pull, function) = match role {
        Role::Contact => (0b00, DOWN, 0),
        Role::Output => (0b01, FREE, 0),
        Role::Analog => (0b11, FREE, 0),
        Role::Device(function, pull) => (0b10, pull, function),
    };
    // AFRL has the pins 0 to 7, and AFRH the others.
    let (alternate, in_alternate) = if pin < 8 { (0x20, pin) } else { (0x24, pin - 8) };
    for (what, offset, bits, pin, expected) in [
        ("mode", 0x00, 2, pin, mode),
        ("pull", 0x0c, 2, pin, pull),
        ("function", alternate, 4, in_alternate, function),
    ] {
        let expected = Vec::from_iter((expected != 0).then_some(expected));
        assert_eq!(field(accesses, port, offset, bits, pin), expected, "{port} {pin}: {what}");
    }
}

/// Last values written to devices that QEMU does not model: TIM8 as the scale of Y (17.4), and the DAC (14.5).
const LAST: [(&str, &str, u32, u32); 9] = [
    ("timer[8]", "CCMR1", 0x18, 0x5151),
    ("timer[8]", "CCMR2: TI3, filtered, and the trigger", 0x1c, 0x0351),
    ("timer[8]", "CCER", 0x20, 0x1111),
    ("timer[8]", "SMCR: the trigger is TIM2, ITR1 (17.4.3)", 0x08, 1 << 4 | 0b011),
    ("timer[8]", "CR1", 0x00, 1),
    // 5.4.1: the detector, with its level 7.
    ("PWR", "CR", 0x00, 0b111 << 5 | 1 << 4),
    ("DAC", "CR: both channels on, without a trigger", 0x00, 1 << 16 | 1),
    ("DAC", "DHR12R1: 0 V", 0x08, 2048),
    ("DAC", "DHR12R2: 0 V", 0x14, 2048),
];

/// Registers of the modelled devices after the start-up: the timers TIM2 to TIM5, the converters and the serial port.
const TIMERS: [(&str, u32, u32); 31] = [
    // 18.4.3: reset (SMS 100) by TIM1 (TS 000).
    ("TIM2 SMCR", 0x4000_0008, 0b100),
    ("TIM2 DIER", 0x4000_000c, 1),
    // 18.4.2: the update is the trigger output (MMS 010), at which the counters are latched.
    ("TIM2 CR2", 0x4000_0004, 0b010 << 4),
    // 18.4.7: PWM mode 2; rises 600 counts, 7.1 µs, before the tick and triggers the converters.
    ("TIM2 CCMR1", 0x4000_0018, 0x70),
    ("TIM2 CCER", 0x4000_0020, 1),
    ("TIM2 CCR1", 0x4000_0034, 3600),
    ("TIM2 CR1", 0x4000_0000, 1),
    // 18.4.7: inputs 1 to 3 on their own pins (01), filter of 8 samples at half the timer clock (0101); channel 4 at the trigger (11).
    ("TIM3 CCMR1", 0x4000_0418, 0x5151),
    ("TIM3 CCMR2", 0x4000_041c, 0x0351),
    // Inputs 1 and 2, and the captures of index and tick, at rising edges.
    ("TIM3 CCER", 0x4000_0420, 0x1111),
    // 18.4.3: counts the edges of both inputs (SMS 011); the trigger is TIM2, ITR1 (001), of TIM5 ITR0.
    ("TIM3 SMCR", 0x4000_0408, 1 << 4 | 0b011),
    ("TIM3 ARR", 0x4000_042c, 0xffff),
    ("TIM3 CR1", 0x4000_0400, 1),
    ("TIM4 CCMR1", 0x4000_0818, 0x5151),
    ("TIM4 CCMR2", 0x4000_081c, 0x0351),
    ("TIM4 CCER", 0x4000_0820, 0x1111),
    ("TIM4 SMCR", 0x4000_0808, 1 << 4 | 0b011),
    ("TIM4 ARR", 0x4000_082c, 0xffff),
    ("TIM4 CR1", 0x4000_0800, 1),
    ("TIM5 CCMR1", 0x4000_0c18, 0x5151),
    ("TIM5 CCMR2", 0x4000_0c1c, 0x0351),
    ("TIM5 CCER", 0x4000_0c20, 0x1111),
    ("TIM5 SMCR", 0x4000_0c08, 0b011),
    ("TIM5 ARR", 0x4000_0c2c, 0xffff_ffff),
    ("TIM5 CR1", 0x4000_0c00, 1),
    // 13.13.12: three channels (JL 2), 12, 14 and 10; 13, 15 and 11.
    ("ADC1 JSQR", 0x4001_2038, 2 << 20 | 10 << 15 | 14 << 10 | 12 << 5),
    ("ADC2 JSQR", 0x4001_2138, 2 << 20 | 11 << 15 | 15 << 10 | 13 << 5),
    // 13.13.3: on, injected conversions at rising edges (20) of TIM2 channel 1 (16: 0010).
    ("ADC1 CR2", 0x4001_2008, 1 << 20 | 2 << 16 | 1),
    ("ADC2 CR2", 0x4001_2108, 1),
    // 30.6.3 and 30.6.4: 42 MHz / 42; on, transmitter and receiver, interrupt of the receiver.
    ("USART3 BRR", 0x4000_4808, 42),
    ("USART3 CR1", 0x4000_480c, 1 << 13 | 1 << 5 | 1 << 3 | 1 << 2),
];

/// Enabled interrupts: 28, TIM2, and 39, USART3. Their priorities, in the highest byte of each word (ARMv7-M, B3.4.4 and B3.4.9): the
/// lowest of 16 for the tick, the second lowest for the serial port (RTIC's priorities 1 and 2).
const INTERRUPTS: [(&str, u32, u32); 4] = [
    ("ISER0", 0xe000_e100, 1 << 28),
    ("ISER1", 0xe000_e104, 1 << 7),
    ("IPR7, lowest byte", 0xe000_e41c, 0xf0),
    ("IPR9, highest byte", 0xe000_e424, 0xe0),
];

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
    for (port, pin, role) in PINS {
        pin_is_set_up(&accesses, port, pin, role);
    }
    for (device, what, offset, value) in LAST {
        let last = written(&accesses, device, offset).last();
        assert_eq!(last, Some(value), "{device} {what}");
    }
    for (name, address, value) in TIMERS.into_iter().chain(INTERRUPTS) {
        let found = chip.target.word(address).unwrap();
        let found = match name {
            "IPR7, lowest byte" => found & 0xff,
            "IPR9, highest byte" => found >> 24,
            _ => found,
        };
        assert_eq!(found, value, "{name}: {found:#x}, expected {value:#x}");
    }
    watchdog_periods_ms(&accesses, &[10.0]);
    assert!(chip.clocks.are_monitored(), "the clock security system is off");
    // 34.4.3: 48 MHz; USB 2.0, 7.1.11: within 0.25 % with the crystal, which has far less.
    assert_eq!(chip.clocks.usb_hz(CRYSTAL_HZ), 48_000_000);
}

/// The order of the writes in which the power stages get no unwanted pulse.
#[test]
fn the_power_stages_are_off_before_anything_can_switch_them_on() {
    let mut chip = Chip::start(&built("board"), None);
    assert_eq!(chip.run(1), Ok(End::Ticked), "{}", chip.diagnostics());
    let accesses = chip.log.accesses();
    let at = |device, offset| position(&accesses, device, offset);
    // PB14, and PD2 of the brakes, are low before the wait for the crystal, after which the clock of TIM1 is enabled.
    let tim1_clock = accesses.iter().position(|access| {
        (access.device.as_str(), access.offset) == ("RCC", 0x44)
            && access.written.is_some_and(|bits| bits & 1 == 1)
    });
    for port in ["GPIOB", "GPIOD"] {
        assert!(at(port, 0x18) < at(port, 0x00) && at(port, 0x00) < tim1_clock.unwrap(), "{port}");
    }
    // TIM1: no pulse, and the break is set up, before the counter is enabled.
    for before in [0x18, 0x34, 0x38, 0x44] {
        assert!(at("timer[1]", before) < at("timer[1]", 0x00), "{before:#x} after CR1");
    }
    // DAC: channel 1 is that of X, which is set first; both before the outputs are on.
    assert!(at("DAC", 0x08) < at("DAC", 0x14) && at("DAC", 0x14) < at("DAC", 0x00));
    // The start-up never enables the main output.
    assert!(written(&accesses, "timer[1]", 0x44).all(|bits| bits & 1 << 15 == 0));
}
