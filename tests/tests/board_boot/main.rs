//! The ELF file that is flashed starts on an emulated STM32F405 and ticks.
//!
//! QEMU's `netduinoplus2` has the core, its interrupt controller, flash and RAM at their addresses, and TIM2 to
//! TIM5. The program is unchanged. One thing is put in its way, because it would wait for it for ever: the
//! clocks. The test halts at the accesses of `FLASH_ACR`, `RCC_CR`, `RCC_PLLCFGR` and `RCC_CFGR` and answers them as
//! the chip does (`clocks.rs`). Besides, it fills the free RAM with a pattern before the start.
//!
//! QEMU models no TIM1, no GPIO, no watchdog and no encoder mode. They read as 0, so the enable switch is open and
//! the drives stay off. What is written to them is checked in the emulator's log. The period between ticks is not
//! that of the chip either: QEMU's timer adds the time since power-up when it was started. So the registers of TIM2
//! are read, and the rate is computed from them and the clocks.
//!
//! A second run closes the loops: it answers for the switch, the counters of the encoders and the period of the PWM,
//! too, and pends each tick itself (`inputs.rs`).
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod checks;
mod chip;
mod clocks;
mod inputs;
mod log;

use tests::firmware::{RAM, TICK, built};
use tests::gdb::SP;

use checks::{
    drives_come_on_and_push_back, drives_stay_off_and_the_watchdog_is_fed, every_device_has_a_clock,
    stack_is_as_deep_as_computed, tick_is_as_fast_as_set_up,
};
use chip::{Chip, End};
use inputs::{COUNTS, Inputs, PUSHED};

/// Ticks that have to run.
const TICKS: usize = 1000;

#[test]
fn the_program_that_is_flashed_starts_and_ticks_a_thousand_times_without_an_exception() {
    let mut chip = Chip::start(&built("board"), None);
    let end = chip.run(TICKS);
    assert_eq!(end, Ok(End::Ticked), "stack pointer {:#x?}; {}", chip.target.register(SP), chip.words());
    let exceptions = chip.log.exceptions();
    assert!(exceptions.iter().all(|&number| number == TICK), "{exceptions:?}");
    assert!((TICKS..100 * TICKS).contains(&exceptions.len()), "{}", exceptions.len());
    // An access to where there is no memory.
    assert!(!chip.log.text().contains("Invalid"), "{}", chip.words());
    stack_is_as_deep_as_computed(&mut chip);
    tick_is_as_fast_as_set_up(&mut chip);
    let accesses = chip.log.accesses();
    every_device_has_a_clock(&accesses);
    // The last tick may still run.
    drives_stay_off_and_the_watchdog_is_fed(&accesses, exceptions.len() - 1);
}

/// With the switch and an encoder answered, too: the drives come on after a fresh edge of the switch, and what is
/// pushed away is pushed back.
#[test]
fn the_drives_come_on_when_the_switch_is_closed_afresh_and_push_back() {
    let mut chip = Chip::start(&built("board"), Some(Inputs::default()));
    let end = chip.run((PUSHED + 2 * COUNTS) as usize + 1);
    assert_eq!(end, Ok(End::Ticked), "{}", chip.words());
    assert!(chip.log.exceptions().iter().all(|&number| number == TICK));
    stack_is_as_deep_as_computed(&mut chip);
    drives_come_on_and_push_back(&chip.log.accesses());
}

/// The same start with 256 bytes of stack above the start of the RAM: the run ends in the hard fault, and says so.
#[test]
fn a_stack_that_is_too_small_is_seen() {
    let mut chip = Chip::start(&built("board"), None);
    chip.target.set_register(SP, RAM.start + 256).unwrap();
    assert_eq!(chip.run(1), Ok(End::Entered("HardFault".to_owned())), "{}", chip.words());
    assert!(chip.target.register(SP).unwrap() < RAM.start);
}
