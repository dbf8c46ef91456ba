//! The ELF file that is flashed starts on an emulated STM32F405 and ticks; [`tests::board`] says what is emulated.
//!
//! The first run leaves the enable switch open. The period between its ticks is not that of the chip, since QEMU's
//! timer adds the time since power-up when it is started; the tick rate is computed from the registers of timers and
//! clocks instead. The second run closes the loops: it models the switch and the encoder counters and pends each tick
//! itself.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod checks;

use tests::firmware::{RAM, TICK, built};
use tests::gdb::SP;

use checks::{
    drives_come_on_and_push_back, drives_stay_off_and_the_watchdog_is_fed, every_device_has_a_clock,
    power_stages, stack_depth_is_as_computed, tick_rate_is_as_set_up,
};
use tests::board::inputs::{COUNTS, Inputs, PUSHED};
use tests::board::{Chip, End};

/// Number of ticks.
const TICKS: usize = 1000;

#[test]
fn the_flashed_program_starts_and_ticks_a_thousand_times_without_an_exception() {
    let mut chip = Chip::start(&built("board"), None);
    let end = chip.run(TICKS);
    assert_eq!(
        end,
        Ok(End::Ticked),
        "stack pointer {:#x?}; {}",
        chip.target.register(SP),
        chip.diagnostics()
    );
    let exceptions = chip.log.exceptions();
    assert!(exceptions.iter().all(|&number| number == TICK), "{exceptions:?}");
    assert!((TICKS..100 * TICKS).contains(&exceptions.len()), "{}", exceptions.len());
    // QEMU's message of an access to an address without memory.
    assert!(!chip.log.text().contains("Invalid"), "{}", chip.diagnostics());
    stack_depth_is_as_computed(&mut chip);
    let accesses = chip.log.accesses();
    tick_rate_is_as_set_up(&mut chip, &accesses);
    every_device_has_a_clock(&accesses);
    // The last tick may not have finished.
    drives_stay_off_and_the_watchdog_is_fed(&accesses, exceptions.len() - 1);
}

/// With switch and encoders: a closing edge of the switch enables the drives, and a displaced axis is pushed back.
#[test]
fn a_closing_switch_enables_the_drives_which_push_back() {
    let mut chip = Chip::start(&built("board"), Some(Inputs::default()));
    let end = chip.run((PUSHED + 2 * COUNTS) as usize + 1);
    assert_eq!(end, Ok(End::Ticked), "{}", chip.diagnostics());
    assert!(chip.log.exceptions().iter().all(|&number| number == TICK));
    stack_depth_is_as_computed(&mut chip);
    drives_come_on_and_push_back(&chip.log.accesses());
}

/// A hard fault or a failing crystal (NMI) while the drives are on: enable pin and PWM are switched off and stay off.
#[test]
fn a_hard_fault_or_nmi_switches_the_power_stages_off() {
    const NMI: usize = 2;
    const HARD_FAULT: usize = 3;
    for exception in [NMI, HARD_FAULT] {
        let mut chip = Chip::start(&built("board"), Some(Inputs::default()));
        assert_eq!(chip.run(PUSHED as usize), Ok(End::Ticked), "{}", chip.diagnostics());
        assert_eq!(power_stages(&chip.log.accesses()), [true, true]);
        // Several rounds of the handler's loop.
        chip.enter_handler(exception, 100).unwrap();
        assert_eq!(power_stages(&chip.log.accesses()), [false, false]);
    }
}

/// With 256 bytes of stack above the start of the RAM the run ends in a hard fault.
#[test]
fn a_stack_overflow_is_detected() {
    let mut chip = Chip::start(&built("board"), None);
    chip.target.set_register(SP, RAM.start + 256).unwrap();
    assert_eq!(chip.run(1), Ok(End::Entered("HardFault".to_owned())), "{}", chip.diagnostics());
    assert!(chip.target.register(SP).unwrap() < RAM.start);
}
