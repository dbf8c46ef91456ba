//! What has to hold after the run.

use firmware::setup::{CRYSTAL_HZ, TICK_HZ};
use tests::chip::vectors::EXCEPTION_FRAME;
use tests::firmware::{SELF_CALLS, TICK};
use tests::gdb::{SP, XPSR};

use crate::chip::Chip;
use crate::log::Access;

/// TIM2 (RM0090, 18.4).
const TIM2: u32 = 0x4000_0000;

/// Offsets of CR1, DIER, PSC and ARR.
const TIMER_REGISTERS: [u32; 4] = [0, 0xc, 0x28, 0x2c];

/// Enabled interrupts 0 to 31 (ARMv7-M reference manual, B3.4.4).
const NVIC_ISER0: u32 = 0xe000_e100;

/// What was used of the stack is not more than its depth computed from the code, and not less than one tick takes.
pub fn stack_is_as_deep_as_computed(chip: &mut Chip) {
    let [used, room] = chip.stack().unwrap();
    let worst = chip.vectors.worst_case(&chip.image, &SELF_CALLS).unwrap();
    println!("{used} B of the stack were used, {} B computed, {room} B are there", worst.bytes());
    assert!(used <= worst.bytes() && worst.bytes() <= room, "{used} B of {} B of {room} B", worst.bytes());
    // The tick's own frame on that of the core, of which two words, alignment and reserve, are not written.
    let tick = chip.vectors.handler(TICK);
    let (_, frame) = worst.exceptions.iter().find(|depth| depth.way[0].0 == tick).unwrap().way[0];
    assert!(used >= frame + EXCEPTION_FRAME - 8, "{used} B of {frame} B");
    let (sp, running) = (chip.target.register(SP).unwrap(), chip.target.register(XPSR).unwrap() & 511);
    assert!(sp <= chip.vectors.initial_sp && sp >= chip.vectors.initial_sp - worst.bytes(), "{sp:#x}");
    assert!(running == 0 || running as usize == TICK, "exception {running}");
}

/// The clocks as they were set up, over the factors of TIM2, give the rate of the ticks.
pub fn tick_is_as_fast_as_set_up(chip: &mut Chip) {
    let [control, interrupts, prescaler, reload] =
        TIMER_REGISTERS.map(|offset| chip.target.word(TIM2 + offset).unwrap());
    // Counts up, without end; interrupts at an update, and at nothing else.
    assert_eq!((control & 0x79, interrupts), (1, 1), "CR1 {control:#x}, DIER {interrupts:#x}");
    let clock = chip.clocks.timers_hz(CRYSTAL_HZ);
    assert_eq!(clock % ((prescaler + 1) * (reload + 1)), 0);
    assert_eq!(clock / ((prescaler + 1) * (reload + 1)), TICK_HZ);
    assert_eq!(chip.target.word(NVIC_ISER0).unwrap(), 1 << 28, "TIM2 and nothing else");
}

/// Offset and bit of each device's clock (RM0090, 7.3.10 to 7.3.14): without it a write is lost.
const CLOCK_OF: [(&str, u32, u32); 4] =
    [("GPIOA", 0x30, 0), ("GPIOB", 0x30, 1), ("GPIOC", 0x30, 2), ("timer[1]", 0x44, 0)];

/// The clock of each device was switched on before its first access.
pub fn every_device_has_a_clock(accesses: &[Access]) {
    for (device, offset, bit) in CLOCK_OF {
        let first = accesses.iter().position(|access| access.device == device).expect(device);
        let clocked = |access: &Access| {
            let enables = access.written.is_some_and(|value| value >> bit & 1 == 1);
            access.device == "RCC" && access.offset == offset && enables
        };
        assert!(accesses[..first].iter().any(clocked), "{device} is used without its clock");
    }
    // TIM2 to TIM4 are modelled: their accesses are not in the log.
    for bit in 0..3 {
        let enables = |access: &Access| access.written.is_some_and(|value| value >> bit & 1 == 1);
        let clocked = accesses.iter().any(|a| a.device == "RCC" && a.offset == 0x40 && enables(a));
        assert!(clocked, "TIM{} without its clock", bit + 2);
    }
}

/// The enable switch reads as open: PB14 is low before it is an output, and stays so. No overrun: the fault light
/// at PC13, on when low, stays off. Each of the `ticks` that have ended sets the duties and feeds the watchdog.
pub fn drives_stay_off_and_the_watchdog_is_fed(accesses: &[Access], ticks: usize) {
    let written = |device: &'static str, offset: u32| {
        let is = move |access: &&Access| access.device == device && access.offset == offset;
        accesses.iter().filter(is).filter_map(|access| access.written)
    };
    let low_before = |device, bit: u32, mode: u32| {
        let position = |offset: u32, bits: u32| {
            let is = |access: &Access| {
                let sets = access.written.is_some_and(|value| value & bits != 0);
                access.device == device && access.offset == offset && sets
            };
            accesses.iter().position(is)
        };
        position(0x18, bit).unwrap() < position(0, mode).unwrap()
    };
    assert!(low_before("GPIOB", 1 << (14 + 16), 1 << (2 * 14)), "PB14 is an output before it is low");
    assert!(written("GPIOB", 0x18).all(|bits| bits & 1 << 14 == 0), "PB14 was set");
    assert!(written("GPIOC", 0x18).all(|bits| bits & 1 << (13 + 16) == 0), "the fault light was on");
    // Compare values of PWM channels 1 and 2 of TIM1.
    for offset in [0x34, 0x38] {
        assert!(written("timer[1]", offset).all(|counts| counts == 0), "a duty");
        assert!(written("timer[1]", offset).count() >= ticks, "every tick sets a duty");
    }
    // QEMU maps another device without registers over the watchdog: either name may be logged.
    let key = |value: u32| {
        let keys = written("IWDG", 0).chain(written("I2S2ext", 0));
        keys.filter(move |&written| written == value).count()
    };
    assert_eq!(key(0xcccc), 1, "the watchdog is started once");
    assert!(key(0xaaaa) >= ticks, "fed {} times in {ticks} ticks", key(0xaaaa));
}
