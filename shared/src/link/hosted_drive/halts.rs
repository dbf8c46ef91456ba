//! What holds, stops or switches off, for the host and for anybody else.

use super::HostedDrive;
use crate::link::halt::Halt;
use crate::safety::Power;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> HostedDrive<'_, S, N> {
    /// Holds the path, and ends a direction check, an excitation and the following of counters, which have none.
    pub fn hold(&mut self) {
        self.system.stop_direction_check();
        self.end_excitation();
        if self.is_at_rest().is_err() {
            self.machine_mut().hold();
        }
    }

    /// Decelerates and discards the rest of the path and of the motion. The override ends.
    pub fn stop(&mut self) {
        (self.blocks_left, self.jog_remaining) = (0, None);
        self.system.stop_sequence();
        self.end_excitation();
        self.system.stop_direction_check();
        self.end_override();
        self.machine_mut().discard_path();
    }

    /// Disables the drives in order, and ends a direction check and an excitation. A fault remains until it is acknowledged.
    pub fn disable(&mut self) {
        self.system.stop_direction_check();
        self.end_excitation();
        if !matches!(self.machine().power(), Power::Faulted(_)) {
            self.machine_mut().disable_in_order();
        }
        if let Power::Disabling(_) = self.machine().power() {
            // The path decelerates: no block follows.
            (self.blocks_left, self.jog_remaining) = (0, None);
        }
    }

    /// Holds, stops or disables for the host.
    pub fn halt(&mut self, halt: Halt) {
        match halt {
            Halt::Hold => self.hold(),
            Halt::Stop => self.stop(),
            Halt::Disable => self.disable(),
        }
    }

    /// Holds, stops or disables for somebody without the session. That is no sign of life of the host, who is told so with its next
    /// request: also if nothing moves, since it may be about to start something. Of several halts the strongest is told.
    pub fn halt_from_outside(&mut self, halt: Halt) {
        // Axes that follow counters are stopped by a hold.
        let stops = halt == Halt::Hold && self.machine().follows();
        let halt = if stops { Halt::Stop } else { halt };
        self.halt(halt);
        self.halted_by_other = self.halted_by_other.max(Some(halt));
    }

    /// What somebody without the session has asked for since the last request of the host. It is told once.
    pub const fn take_halt_by_other(&mut self) -> Option<Halt> {
        self.halted_by_other.take()
    }
}
