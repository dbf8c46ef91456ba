//! The pins of switches and fault inputs ([`crate::two_drives::switches`]).

use stm32f4xx_hal::gpio;
use stm32f4xx_hal::pac;

use crate::two_drives::switches::{Levels, Wiring};

/// The pins of this board.
pub static WIRING: Wiring = Wiring {
    scale_signals: [1 << 3, 1 << 10],
    probe: 1 << 15,
    limits: [[1 << 1, 1 << 5], [1 << 9, 1 << 13]],
    drive_faults: [1 << 2, 1 << 3],
    stop: 1 << 12,
    enable_switch: 1 << 15,
    homes: [1 << 9, 1 << 12],
};

/// The pins of port A.
pub type PinsA = (gpio::PA3, gpio::PA10, gpio::PA15<gpio::Debugger>);

/// The pins of port B.
pub type PinsB =
    (gpio::PB1, gpio::PB2, gpio::PB3<gpio::Debugger>, gpio::PB5, gpio::PB9, gpio::PB13, gpio::PB15);

/// The pins of port C.
pub type PinsC = (gpio::PC9, gpio::PC12);

/// Makes the pins inputs with pull-downs.
pub fn set_up(a: PinsA, b: PinsB, c: PinsC) {
    let _ = (a.0.into_pull_down_input(), a.1.into_pull_down_input(), a.2.into_pull_down_input());
    let (pb1, pb2, pb3, pb5, pb9, pb13, pb15) = b;
    let _ = (
        pb1.into_pull_down_input(),
        pb2.into_pull_down_input(),
        pb3.into_pull_down_input(),
        pb5.into_pull_down_input(),
        pb9.into_pull_down_input(),
        pb13.into_pull_down_input(),
        pb15.into_pull_down_input(),
    );
    let _ = (c.0.into_pull_down_input(), c.1.into_pull_down_input());
}

/// Reads all inputs.
pub fn levels() -> Levels {
    // SAFETY: reading input data has no effect.
    let (a, b, c) = unsafe { (&*pac::GPIOA::ptr(), &*pac::GPIOB::ptr(), &*pac::GPIOC::ptr()) };
    Levels { a: a.idr().read().bits(), b: b.idr().read().bits(), c: c.idr().read().bits() }
}
