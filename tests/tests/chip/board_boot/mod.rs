//! The ELF file that is flashed starts on an emulated STM32F405 and ticks; [`tests::board`] says what is emulated.
//!
//! The first run leaves the enable switch open. The period between its ticks is not that of the chip, since QEMU's
//! timer adds the time since power-up when it is started; the tick rate is computed from the registers of timers and
//! clocks instead. The other runs close the loops: they model switches, supply and encoder counters and pend each tick, and a host
//! at the serial port speaks the protocol of the link.

mod checks;
pub mod host;
mod stored;
mod ticks;
mod wiring;

use firmware::f405::IDENTITY;
use firmware::setup::RATES;
use shared::config::Brake;
use shared::drive::NotArmed;
use shared::link::report::UsbState;
use shared::link::{Refusal, Reply, Request};
use shared::safety::{Fault, Power};
use tests::firmware::{RAM, SERIAL, SETTINGS_SLOTS, TICK, built};
use tests::gdb::SP;

use checks::{
    drives_come_on_and_push_back, drives_stay_off_and_the_watchdog_is_fed, every_device_has_a_clock,
    power_stages, stack_depth_is_as_computed, tick_rate_is_as_set_up,
};
use host::Host;
use stored::record_of;
use tests::board::inputs::{ARMED, CLOSED, COUNTS, Inputs, PUSHED, SupplyInputs};
use tests::board::log::written;
use tests::board::usb_core::StuckUsbCore;
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

/// Runs until the drives are on: the switch closes, and a host at the serial port says hello and enables the drives.
fn enabled_by_a_host() -> (Chip, Host) {
    enabled_with(&[])
}

/// [`enabled_by_a_host`] with the beginning of the first slot for settings; the rest of the flash is erased.
fn enabled_with(slot: &[u8]) -> (Chip, Host) {
    let mut chip = Chip::start(&built("board"), Some(Inputs::default()));
    chip.target.set_memory(SETTINGS_SLOTS[0], slot).unwrap();
    let mut host = Host::connect(&chip);
    // QEMU drops bytes that arrive before the port is on.
    assert_eq!(chip.run(20), Ok(End::Ticked), "{}", chip.diagnostics());
    host.send(&Request::Hello { nonce: 77 });
    assert_eq!(chip.run(CLOSED as usize), Ok(End::Ticked), "{}", chip.diagnostics());
    let Some(Reply::Welcome(welcome)) = host.reply() else { panic!("no welcome; {}", chip.diagnostics()) };
    assert_eq!((welcome.steps.axes.len(), welcome.rates, welcome.board.as_str()), (2, RATES, IDENTITY.board));
    // Before the switch has settled, an enable is refused.
    host.send(&Request::Enable);
    assert_eq!(chip.run(CLOSED as usize + 40), Ok(End::Ticked), "{}", chip.diagnostics());
    assert_eq!(host.reply(), Some(Reply::Refused(Refusal::NotArmed(NotArmed::Switch))));
    assert_eq!(chip.run(ARMED as usize + 20), Ok(End::Ticked), "{}", chip.diagnostics());
    assert_eq!(power_stages(&chip.log.accesses()), [false, false]);
    host.send(&Request::Enable);
    assert_eq!(chip.run(PUSHED as usize), Ok(End::Ticked), "{}", chip.diagnostics());
    assert_eq!(host.reply(), Some(Reply::Done));
    assert_eq!(power_stages(&chip.log.accesses()), [true, true]);
    (chip, host)
}

/// With switch, encoders and a host at the serial port: the program that is flashed takes commands, the drives come on, and a
/// displaced axis is pushed back. The status tells where it is.
#[test]
fn a_host_at_the_serial_port_enables_the_drives_which_push_back() {
    let (mut chip, mut host) = enabled_by_a_host();
    let end = chip.run((PUSHED + 2 * COUNTS) as usize + 1);
    assert_eq!(end, Ok(End::Ticked), "{}", chip.diagnostics());
    assert!(chip.log.exceptions().iter().all(|&number| number == TICK || number == SERIAL));
    stack_depth_is_as_computed(&mut chip);
    drives_come_on_and_push_back(&chip.log.accesses());
    let ticks = chip.ticks();
    host.send(&Request::Status);
    assert_eq!(chip.run(ticks + 40), Ok(End::Ticked), "{}", chip.diagnostics());
    let Some(Reply::Status(status)) = host.reply() else { panic!("no status") };
    // QEMU has no USB core: the board starts without it, and says so.
    assert_eq!((status.power, status.usb), (Power::On, UsbState::NotAnswering));
    host.send(&Request::Disable);
    assert_eq!(chip.run(ticks + 80), Ok(End::Ticked), "{}", chip.diagnostics());
    assert_eq!((host.reply(), power_stages(&chip.log.accesses())), (Some(Reply::Done), [false, false]));
}

/// A USB core whose reset does not end: the board starts without it after a bounded number of reads, and takes commands at its serial
/// port.
#[test]
fn a_usb_core_that_does_not_answer_does_not_stop_the_start() {
    // The test pends the ticks: the period of QEMU's timer has the time of the start added.
    let mut chip = Chip::start(&built("board"), Some(Inputs::default()));
    chip.attach_usb(StuckUsbCore::default()).unwrap();
    let mut host = Host::connect(&chip);
    assert_eq!(chip.run(20), Ok(End::Ticked), "{}", chip.diagnostics());
    let reads = chip.usb.as_ref().map(|usb| usb.reads).unwrap();
    // One for AHBIDL, one before the reset, and those of the wait (`firmware/src/board/usb.rs`).
    assert_eq!(reads, 1 + 1 + 1000);
    assert!(!chip.log.text().contains("Invalid"), "its memory was accessed; {}", chip.diagnostics());
    host.send(&Request::Hello { nonce: 5 });
    assert_eq!(chip.run(100), Ok(End::Ticked), "{}", chip.diagnostics());
    assert!(matches!(host.reply(), Some(Reply::Welcome(_))));
    host.send(&Request::Status);
    assert_eq!(chip.run(200), Ok(End::Ticked), "{}", chip.diagnostics());
    let Some(Reply::Status(status)) = host.reply() else { panic!("no status") };
    assert_eq!((status.power, status.usb), (Power::Off, UsbState::NotAnswering));
}

/// Each safety contact that opens, and the stop, switches the drives off in the next tick; a limit switch does not while nothing
/// moves onto it.
#[test]
fn an_open_safety_contact_switches_the_drives_off() {
    // Drive faults of X and Y, the stop; the limit switch at the positive end of X.
    for (bit, off) in [(2, true), (3, true), (12, true), (5, false)] {
        let (mut chip, _host) = enabled_by_a_host();
        if let Some(inputs) = &mut chip.inputs {
            inputs.open = 1 << bit;
        }
        let ticks = chip.ticks();
        assert_eq!(chip.run(ticks + 3), Ok(End::Ticked), "{}", chip.diagnostics());
        assert_eq!(power_stages(&chip.log.accesses()), [!off; 2], "bit {bit}");
    }
}

/// The last write to PC13 of the fault light, which is on while the pin is low.
fn is_light_on(chip: &Chip) -> Option<bool> {
    let writes = chip.log.accesses();
    let last = written(&writes, "GPIOC", 0x18).filter(|bits| bits & 0x2000_2000 != 0).last();
    last.map(|bits| bits & 1 << (13 + 16) != 0)
}

/// A bus voltage beyond 36 to 60 V switches the drives off, by the divider of the page; more than 80 °C stops the axes first. The light is on then.
#[test]
fn a_supply_beyond_its_limits_is_a_fault_with_its_name() {
    let of = |bus_v, temperature_c| SupplyInputs { bus_v, temperature_c };
    for (supply, fault) in [
        (of(35.5, 25.0), Some(Fault::BusUndervoltage)),
        (of(36.5, 25.0), None),
        (of(59.5, 79.0), None),
        (of(60.5, 25.0), Some(Fault::BusOvervoltage)),
        (of(48.0, 81.0), Some(Fault::OverTemperature)),
    ] {
        let (mut chip, mut host) = enabled_by_a_host();
        assert_eq!(is_light_on(&chip), Some(false));
        chip.inputs.as_mut().unwrap().supply = supply;
        let ticks = chip.ticks();
        assert_eq!(chip.run(ticks + 20), Ok(End::Ticked), "{}", chip.diagnostics());
        host.send(&Request::Status);
        assert_eq!(chip.run(ticks + 60), Ok(End::Ticked), "{}", chip.diagnostics());
        let Some(Reply::Status(status)) = host.reply() else { panic!("no status") };
        let expected = fault.map_or(Power::On, Power::Faulted);
        assert_eq!(status.power, expected, "{} V, {} °C", supply.bus_v, supply.temperature_c);
        assert_eq!(
            (is_light_on(&chip), power_stages(&chip.log.accesses())),
            (Some(fault.is_some()), [fault.is_none(); 2])
        );
    }
}

/// A low supply of the chip itself is a stop, in the next tick, for as long as it lasts.
#[test]
fn a_low_supply_of_the_chip_stops_the_drives() {
    let (mut chip, mut host) = enabled_by_a_host();
    chip.inputs.as_mut().unwrap().low_supply = true;
    let ticks = chip.ticks();
    assert_eq!(chip.run(ticks + 2), Ok(End::Ticked), "{}", chip.diagnostics());
    assert_eq!(power_stages(&chip.log.accesses()), [false; 2]);
    host.send(&Request::Status);
    assert_eq!(chip.run(ticks + 60), Ok(End::Ticked), "{}", chip.diagnostics());
    let Some(Reply::Status(status)) = host.reply() else { panic!("no status") };
    assert_eq!(status.power, Power::Faulted(Fault::HardwareStop));
}

/// The writes to PD2 of the brakes: high opens them.
fn brakes_open(chip: &Chip) -> Vec<bool> {
    let writes = chip.log.accesses();
    let bits = written(&writes, "GPIOD", 0x18).filter(|bits| bits & 0x0004_0004 != 0);
    let mut open: Vec<bool> = bits.map(|bits| bits & 1 << 2 != 0).collect();
    open.dedup();
    open
}

/// With a brake on an axis, PD2 goes high when the drives come on, and low when they go off: by a disable, and by the stop.
#[test]
fn the_brakes_open_with_the_drives_and_close_with_them() {
    let slot = record_of(|axis| axis.brake = Some(Brake { release_s: 0.0, engage_s: 0.0 }));
    for by_stop in [false, true] {
        let (mut chip, mut host) = enabled_with(&slot);
        assert_eq!(brakes_open(&chip), [false, true], "{}", chip.diagnostics());
        let ticks = chip.ticks();
        if by_stop {
            chip.inputs.as_mut().unwrap().open = 1 << 12;
        } else {
            host.send(&Request::Disable);
        }
        assert_eq!(chip.run(ticks + 40), Ok(End::Ticked), "{}", chip.diagnostics());
        assert_eq!(power_stages(&chip.log.accesses()), [false, false]);
        assert_eq!(brakes_open(&chip), [false, true, false], "by the stop: {by_stop}");
    }
}

/// A hard fault or a failing crystal (NMI) while the drives are on: enable pin and PWM are switched off and stay off.
#[test]
fn a_hard_fault_or_nmi_switches_the_power_stages_off() {
    const NMI: usize = 2;
    const HARD_FAULT: usize = 3;
    for exception in [NMI, HARD_FAULT] {
        let (mut chip, _host) = enabled_by_a_host();
        // Several rounds of the handler's loop.
        chip.enter_handler(exception, 100).unwrap();
        let accesses = chip.log.accesses();
        assert_eq!(power_stages(&accesses), [false, false]);
        // The start-up and the handler set 0 V; 14.5.3 and 14.5.6.
        for register in [0x08, 0x14] {
            let written: Vec<u32> = written(&accesses, "DAC", register).collect();
            assert!(written.len() >= 2 && written.iter().all(|counts| *counts == 2048), "{written:?}");
        }
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
