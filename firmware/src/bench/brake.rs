//! The holding brake of a simulated axis: it follows its output late.

use crate::setup::TICK_HZ;

/// Time from the output until the brake is open, and until it is closed, ticks: 40 and 20 ms.
const RELEASE: u32 = TICK_HZ / 25;
const ENGAGE: u32 = TICK_HZ / 50;

/// A brake.
#[derive(Clone, Copy, Debug)]
pub struct Brake {
    is_closed: bool,
    /// Whether the output opens it.
    output: bool,
    /// Ticks for which the output has asked for what the brake is not yet.
    late: u32,
}

impl Brake {
    /// Without supply.
    pub const CLOSED: Self = Self { is_closed: true, output: false, late: 0 };

    /// Sets the output.
    pub const fn set_open(&mut self, open: bool) {
        self.output = open;
    }

    /// Whether the brake holds the axis.
    pub const fn is_closed(self) -> bool {
        self.is_closed
    }

    /// The time of a tick.
    pub const fn step(&mut self) {
        if self.output != self.is_closed {
            self.late = 0;
            return;
        }
        self.late += 1;
        if self.late >= if self.output { RELEASE } else { ENGAGE } {
            (self.is_closed, self.late) = (!self.output, 0);
        }
    }
}
