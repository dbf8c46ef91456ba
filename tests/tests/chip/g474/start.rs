//! The start of the board: the order in which nothing can be switched on, and what keeps it from starting.

use firmware::g474::flash::SLOTS;
use firmware::g474::{StartError, nmi_was_of_settings};
use shared::safety::Fault;

use super::board::{Board, Port, model, parts_on};
use super::flash_model::Remains;
use super::model::{CAN, GPIOA, GPIOB, GPIOC, GPIOD, RCC, TIM1, Write};

const OPTR: u32 = 0x4002_2020;
const CSR: u32 = RCC + 0x94;

/// PB14 and PD2 are low before they are outputs, and outputs before the crystal is waited for; the break is set up and the compare values give no
/// pulse before the counter runs, and the pins of the PWM follow. The analogue outputs are at 0 V before they are on.
#[test]
fn the_power_stages_are_off_before_anything_can_switch_them_on() {
    let model = model(Remains::erased());
    let _parts = parts_on(model).unwrap();
    let written = |address| model.first(|write| write.address == address);
    let output =
        |port, pin: u32| model.first(|write| write.address == port && write.value >> (2 * pin) & 3 == 1);
    let low = |port: u32, pin: u32| {
        let write = Write { address: port + 0x18, value: 1 << (pin + 16) };
        model.first(|found| found == write)
    };
    let crystal = model.first(|write| write.address == RCC && write.value & 1 << 16 != 0);
    for (port, pin) in [(GPIOB, 14), (GPIOD, 2)] {
        assert!(low(port, pin) < output(port, pin) && output(port, pin) < crystal, "{port:#x} {pin}");
        // Before them only the clocks of the ports are enabled.
        assert!(model.log()[..low(port, pin)].iter().all(|write| {
            write.address == RCC + 0x4c || write.address & !0x7ff == GPIOA || write.address & !0xfff == GPIOA
        }));
        assert_eq!(model.word(port + 0x14) >> pin & 1, 0);
    }
    for before in [0x18, 0x2c, 0x34, 0x38, 0x44] {
        assert!(written(TIM1 + before) < written(TIM1), "{before:#x} after CR1");
    }
    let pwm = model.first(|write| write.address == GPIOA && write.value >> 16 & 0b1111 == 0b1010);
    assert!(written(TIM1) < pwm);
    let [first, second, on] = [0x5000_0808, 0x5000_0814, 0x5000_0800].map(written);
    assert!(first < second && second < on);
    // Nothing enables the main output.
    assert!(model.written(TIM1 + 0x44).iter().all(|value| value & 1 << 15 == 0));
    // The light is off: high, before it is an output.
    let light = model.first(|write| write == Write { address: GPIOC + 0x18, value: 1 << 13 });
    assert!(light < output(GPIOC, 13));
}

/// A flash with one bank, or with its banks exchanged, would have the settings elsewhere: the board does not start, and the drives are off.
#[test]
fn without_two_banks_the_board_does_not_start() {
    for options in [0xffaf_f8aa, 0xffff_f8aa, 0xffbf_f8aa] {
        let model = model(Remains::erased());
        model.set(OPTR, options);
        assert_eq!(parts_on(model).err(), Some(StartError::Banks), "{options:#x}");
        assert_eq!([model.word(GPIOB + 0x14), model.word(GPIOD + 0x14)], [0, 0]);
        assert_eq!(model.word(TIM1 + 0x44), 0);
    }
}

/// A reset by either watchdog is a fault; that by the pin is none. The flags are cleared.
#[test]
fn a_reset_by_a_watchdog_is_told() {
    for (bit, fault) in [(26, None), (27, None), (29, Some(Fault::Watchdog)), (30, Some(Fault::Watchdog))] {
        let model = model(Remains::erased());
        model.set(CSR, 1 << bit);
        assert_eq!(parts_on(model).unwrap().previous_fault, fault, "bit {bit}");
        assert_eq!(model.written(CSR), [1 << 23]);
    }
}

/// The watchdog is fed in each tick, and its period is never changed.
#[test]
fn each_tick_feeds_the_watchdog() {
    let mut board = Board::start(Port::Serial);
    let before = board.model.written(0x4000_3000).len();
    board.ticks(10);
    assert_eq!(board.model.written(0x4000_3000)[before..], [0xaaaa; 10]);
    assert_eq!(board.model.written(0x4000_3008), [79]);
}

/// The NMI of a double word in the settings lets the program go on, once for each; that of the crystal, of the first bank and of nothing does not.
#[test]
fn only_the_settings_let_the_program_go_on_after_an_nmi() {
    let model = model(Remains::erased());
    assert!(!nmi_was_of_settings(model));
    model.with(|state| {
        state.flash.damaged.insert(SLOTS.starts[1]);
        let _ = state.flash.word(SLOTS.starts[1]);
    });
    // With a failure of the crystal at the same time.
    model.set(RCC + 0x1c, 1 << 8);
    assert!(!nmi_was_of_settings(model));
    model.set(RCC + 0x1c, 0);
    assert!(nmi_was_of_settings(model));
    assert!(!nmi_was_of_settings(model));
    model.with(|state| state.flash.damage_program());
    assert!(!nmi_was_of_settings(model));
}

/// CAN joins the bus when everything else of it is set up: a frame that arrived before would find no filter, and raise no interrupt.
#[test]
fn can_joins_the_bus_last() {
    let model = model(Remains::erased());
    let _parts = parts_on(model).unwrap();
    let joins = model.first(|write| write.address == CAN + 0x18 && write.value & 1 == 0);
    // RXGFC, both bit times, the compensation, and the enables of the interrupts.
    for offset in [0x80, 0x1c, 0x0c, 0x48, 0xdc, 0x54, 0x5c] {
        assert!(model.first(|write| write.address == CAN + offset) < joins, "{offset:#x}");
    }
}

/// Each device that is set up was reset before (chapter 7): the bits of AHB2RSTR, APB1RSTR1 and APB2RSTR.
#[test]
fn each_device_is_reset() {
    let model = model(Remains::erased());
    let _parts = parts_on(model).unwrap();
    for (register, bits) in [(0x2c, &[13, 16][..]), (0x38, &[0, 1, 2, 3, 18, 25]), (0x40, &[11, 13])] {
        let reset = model.written(RCC + register).into_iter().fold(0, |all, bits| all | bits);
        assert!(bits.iter().all(|bit| reset >> bit & 1 == 1), "{register:#x}: {reset:#x}");
    }
}

/// A boot loader or a debugger may have used clocks and pins before: the caches are switched on, and a field that is set has no bit of what was
/// there.
#[test]
fn the_start_sets_whole_fields() {
    const ACR: u32 = 0x4002_2000;
    const CCIPR: u32 = RCC + 0x88;
    let clean = model(Remains::erased());
    let _parts = parts_on(clean).unwrap();
    let dirty = model(Remains::erased());
    let functions = || [GPIOA, GPIOB, GPIOC].into_iter().flat_map(|port| [port + 0x20, port + 0x24]);
    functions().chain([CCIPR]).for_each(|address| dirty.set(address, u32::MAX));
    dirty.set(ACR, 0x0004_0000);
    let _parts = parts_on(dirty).unwrap();
    assert_eq!((dirty.word(ACR), dirty.word(CCIPR) >> 24 & 0b11), (clean.word(ACR), 0b10));
    for address in functions() {
        for place in (0..32).step_by(4) {
            let [expected, found] = [clean, dirty].map(|model| model.word(address) >> place & 0b1111);
            assert!(expected == 0 || found == expected, "{address:#x}, bit {place}: {found}");
        }
    }
}
