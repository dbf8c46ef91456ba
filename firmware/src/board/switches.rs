//! Switches and fault inputs: each port is read once in a tick, so that all inputs are of the same moment.
//!
//! Limit switches, drive faults, the stop and the probe are closed contacts to 3.3 V with pull-downs: a broken wire reads as active. Home
//! switches close when active: with a broken wire no switch is found. The signal of a scale is high while it is there: a broken wire reads
//! as lost.

use shared::drive::AxisInputs;
use stm32f4xx_hal::gpio;
use stm32f4xx_hal::pac;

use crate::setup::{AXES, AxisTable};

/// Input data of ports A, B and C.
#[derive(Clone, Copy, Default)]
pub struct Switches {
    a: u32,
    b: u32,
    c: u32,
}

/// Bits of port B: limit switches at the negative and the positive end of X and Y.
const LIMITS: [[u32; 2]; AXES] = [[1 << 1, 1 << 5], [1 << 9, 1 << 13]];
/// Drive faults.
const DRIVE_FAULTS: [u32; AXES] = [1 << 2, 1 << 3];
const STOP: u32 = 1 << 12;
const ENABLE_SWITCH: u32 = 1 << 15;
/// Bits of port C: home switches.
const HOMES: [u32; AXES] = [1 << 9, 1 << 12];

/// Bits of port A: the scale has a signal.
const SCALE_SIGNALS: [u32; AXES] = [1 << 3, 1 << 10];
/// The probe.
const PROBE: u32 = 1 << 15;

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

impl Switches {
    /// Reads all inputs.
    pub fn read() -> Self {
        // SAFETY: reading input data has no effect.
        let (a, b, c) = unsafe { (&*pac::GPIOA::ptr(), &*pac::GPIOB::ptr(), &*pac::GPIOC::ptr()) };
        Self { a: a.idr().read().bits(), b: b.idr().read().bits(), c: c.idr().read().bits() }
    }

    /// Whether the enable switch is closed.
    pub const fn enable_switch_closed(self) -> bool {
        self.b & ENABLE_SWITCH != 0
    }

    /// Whether the stop contact is open.
    pub const fn is_stopped(self) -> bool {
        self.b & STOP == 0
    }

    /// Whether the probe is touched, or not connected.
    pub const fn is_probe_touched(self) -> bool {
        self.a & PROBE == 0
    }

    /// Whether the scale of each axis has a signal; one whose signal is not connected is taken to have one.
    pub fn scale_signals(self, table: &[AxisTable; AXES]) -> [bool; AXES] {
        core::array::from_fn(|axis| {
            let is_connected = table.get(axis).is_some_and(|axis| axis.scale_signal);
            !is_connected || SCALE_SIGNALS.get(axis).is_some_and(|bit| self.a & bit != 0)
        })
    }

    /// The switches and the fault input of an axis, of which the table says which are fitted.
    pub fn axis(self, axis: usize, table: &AxisTable) -> AxisInputs {
        let open = |bits: Option<&u32>| bits.is_some_and(|bit| self.b & bit == 0);
        let [negative, positive] = [0, 1].map(|end| open(LIMITS.get(axis).and_then(|ends| ends.get(end))));
        AxisInputs {
            limits: [negative && table.limit_switches, positive && table.limit_switches],
            home: HOMES.get(axis).is_some_and(|bit| self.c & bit != 0),
            drive_fault: table.drive_fault && open(DRIVE_FAULTS.get(axis)),
            ..AxisInputs::NONE
        }
    }
}
