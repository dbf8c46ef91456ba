//! The ELF file that is flashed starts on an emulated STM32F405 and ticks.
//!
//! What is emulated, and the one thing that is put in the program's way, stands in [`tests::board`]. The first run leaves
//! the enable switch open. The period between its ticks is not that of the chip: QEMU's timer adds the time since
//! power-up when it was started. So the registers of the timers are read, and the rate is computed from them and the
//! clocks. A second run closes the loops: it answers for the switch and the counters of the encoders, too, and pends each
//! tick itself.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod checks;

use tests::firmware::{RAM, TICK, built};
use tests::gdb::SP;

use checks::{
    drives_come_on_and_push_back, drives_stay_off_and_the_watchdog_is_fed, every_device_has_a_clock,
    stack_is_as_deep_as_computed, stages, tick_is_as_fast_as_set_up,
};
use tests::board::inputs::{COUNTS, Inputs, PUSHED};
use tests::board::{Chip, End};

/// Ticks that have to run.
const TICKS: usize = 1000;

#[test]
fn the_program_that_is_flashed_starts_and_ticks_a_thousand_times_without_an_exception() {
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
    // An access to where there is no memory.
    assert!(!chip.log.text().contains("Invalid"), "{}", chip.diagnostics());
    stack_is_as_deep_as_computed(&mut chip);
    let accesses = chip.log.accesses();
    tick_is_as_fast_as_set_up(&mut chip, &accesses);
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
    assert_eq!(end, Ok(End::Ticked), "{}", chip.diagnostics());
    assert!(chip.log.exceptions().iter().all(|&number| number == TICK));
    stack_is_as_deep_as_computed(&mut chip);
    drives_come_on_and_push_back(&chip.log.accesses());
}

/// A fault of the core, or a crystal that fails (NMI), while the drives are on: enable pin and PWM go off, and stay so.
#[test]
fn what_the_core_cannot_go_on_from_cuts_the_stages() {
    const NMI: usize = 2;
    const HARD_FAULT: usize = 3;
    for exception in [NMI, HARD_FAULT] {
        let mut chip = Chip::start(&built("board"), Some(Inputs::default()));
        assert_eq!(chip.run(PUSHED as usize), Ok(End::Ticked), "{}", chip.diagnostics());
        assert_eq!(stages(&chip.log.accesses()), [true, true]);
        // A handful of instructions each time round.
        chip.enter_handler(exception, 100).unwrap();
        assert_eq!(stages(&chip.log.accesses()), [false, false]);
    }
}

/// The same start with 256 bytes of stack above the start of the RAM: the run ends in the hard fault, and says so.
#[test]
fn a_stack_that_is_too_small_is_seen() {
    let mut chip = Chip::start(&built("board"), None);
    chip.target.set_register(SP, RAM.start + 256).unwrap();
    assert_eq!(chip.run(1), Ok(End::Entered("HardFault".to_owned())), "{}", chip.diagnostics());
    assert!(chip.target.register(SP).unwrap() < RAM.start);
}
