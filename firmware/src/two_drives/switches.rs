//! Switches and fault inputs: each port is read once in a tick, so that all inputs are of the same moment.
//!
//! Limit switches, drive faults, the stop and the probe are closed contacts to 3.3 V with pull-downs: a broken wire reads as active. Home
//! switches close when active: with a broken wire no switch is found. The signal of a scale is high while it is there: a broken wire reads
//! as lost.

use shared::drive::AxisInputs;

use crate::setup::{AXES, AxisTable};

/// The pins of the switches: a bit each in the input data of its port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wiring {
    /// Port A, of each axis: its scale has a signal.
    pub scale_signals: [u32; AXES],
    /// Port A: the probe.
    pub probe: u32,
    /// Port B, of each axis: limit switches at the negative and the positive end.
    pub limits: [[u32; 2]; AXES],
    /// Port B, of each axis: drive fault.
    pub drive_faults: [u32; AXES],
    /// Port B: the stop contact.
    pub stop: u32,
    /// Port B: the enable switch.
    pub enable_switch: u32,
    /// Port C, of each axis: home switch.
    pub homes: [u32; AXES],
}

/// Input data of ports A, B and C.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Levels {
    /// Port A.
    pub a: u32,
    /// Port B.
    pub b: u32,
    /// Port C.
    pub c: u32,
}

/// The inputs of a tick. Before the first one all of them are low.
#[derive(Clone, Copy)]
pub struct Switches {
    wiring: &'static Wiring,
    levels: Levels,
}

impl Switches {
    /// By the pins of a chip and what was read of its ports.
    #[must_use]
    pub const fn new(wiring: &'static Wiring, levels: Levels) -> Self {
        Self { wiring, levels }
    }

    /// Whether the enable switch is closed.
    #[must_use]
    pub const fn enable_switch_closed(self) -> bool {
        self.levels.b & self.wiring.enable_switch != 0
    }

    /// Whether the stop contact is open.
    #[must_use]
    pub const fn is_stopped(self) -> bool {
        self.levels.b & self.wiring.stop == 0
    }

    /// Whether the probe is touched, or not connected.
    #[must_use]
    pub const fn is_probe_touched(self) -> bool {
        self.levels.a & self.wiring.probe == 0
    }

    /// Whether the scale of each axis has a signal; one whose signal is not connected is taken to have one.
    #[must_use]
    pub fn scale_signals(self, table: &[AxisTable; AXES]) -> [bool; AXES] {
        core::array::from_fn(|axis| {
            let is_connected = table.get(axis).is_some_and(|axis| axis.scale_signal);
            !is_connected || self.wiring.scale_signals.get(axis).is_some_and(|bit| self.levels.a & bit != 0)
        })
    }

    /// The switches and the fault input of an axis, of which the table says which are fitted.
    #[must_use]
    pub fn axis(self, axis: usize, table: &AxisTable) -> AxisInputs {
        let Self { wiring, levels } = self;
        let open = |bits: Option<&u32>| bits.is_some_and(|bit| levels.b & bit == 0);
        let [negative, positive] =
            [0, 1].map(|end| open(wiring.limits.get(axis).and_then(|ends| ends.get(end))));
        AxisInputs {
            limits: [negative && table.limit_switches, positive && table.limit_switches],
            home: wiring.homes.get(axis).is_some_and(|bit| levels.c & bit != 0),
            drive_fault: table.drive_fault && open(wiring.drive_faults.get(axis)),
            ..AxisInputs::NONE
        }
    }
}
