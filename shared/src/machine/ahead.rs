//! What depends on commands only, computed before the position tick that uses it.
//!
//! With at least three ticks per position tick, the path is advanced two ticks before the position tick, and the corrections of its
//! command are computed one tick before it, each after the velocity loops: the position tick itself has readings, loops and monitors
//! only, and no tick has all of these. With two ticks per position tick both are computed one tick before it, with one in the
//! position tick itself.
//!
//! | ticks until the position tick | path | corrections, forces of the commanded motion |
//! |---|---|---|
//! | 2 | next command | |
//! | 1 | | of the next command |
//! | 0, the position tick | the loops follow the command | added to the command; the force acts from here on |
//!
//! Commands, corrections and forces are those of a machine that computes everything in the position tick, to the last bit. An event
//! between the advance of the path and the position tick acts on the path as it does right after the position tick:
//!
//! | event in between | what happens |
//! |---|---|
//! | feed hold, halt, stop by a fault, discarded path, override, another block | the path is one command further: the event acts from the command after on |
//! | disable, a fault that switches the drives off, new configuration | at once, as ever: the computed command is discarded |
//! | compensation replaced or switched, reference lost or set | forces at once; corrections from the next command on whose corrections are not computed yet |
//! | other gains of an axis, force limit, excitation | in the next tick, as ever |
//! | origin set | the computed command is shifted with the present one; the axes are at rest |
//!
//! The present command (`State::commands`) is that of the loops until the position tick, and a path is done when the loops follow its
//! last command.

use super::config::MachineConfig;
use super::state::{Ahead, State};
use crate::safety::Power;
use crate::scalar::Scalar;

impl<S: Scalar, const N: usize> State<S, N> {
    /// The loops follow the next commands from here on. What is missing of them is computed.
    #[inline]
    pub fn follow_next(&mut self) {
        if self.ahead == Ahead::Nothing {
            self.advance_path();
            self.correct_commands();
        } else {
            self.complete();
        }
        self.commands = self.path_commands();
    }

    /// Computes what is missing of the next commands.
    // A function of its own: a tick without anything ahead then tests once.
    #[inline(never)]
    fn complete(&mut self) {
        if self.ahead == Ahead::Command {
            self.correct_commands();
        }
        self.ahead = Ahead::Nothing;
    }

    /// Advances the path by a command. A path that waits does so until the brakes are open.
    #[inline]
    fn advance_path(&mut self) {
        if !matches!(self.power, Power::Enabling) {
            self.path.advance();
            if self.has_gantry {
                self.gantries.advance();
            }
        }
    }

    /// Computes the corrections of the commands of the path and the forces of their motion.
    #[inline]
    fn correct_commands(&mut self) {
        let is_at_segment_end = self.path.take_segment_end();
        self.compensation.advance(&self.path_commands(), is_at_segment_end);
        self.compensation.correct_commands();
    }
}

impl<S: Scalar, const N: usize> MachineConfig<S, N> {
    /// What can be computed for the next position tick after a tick.
    #[inline]
    pub(super) fn prepare(&self, state: &mut State<S, N>) {
        let due_in = state.until_position_tick + 1;
        // While the brakes open, only the position tick knows whether the path moves.
        let is_waiting = !state.power.is_on() || matches!(state.power, Power::Enabling);
        if due_in > 2 || due_in >= self.rates.position_loop_divider || is_waiting {
            return;
        }
        if state.ahead == Ahead::Nothing {
            state.was_done = state.path.is_done();
            state.advance_path();
            state.ahead = Ahead::Command;
        }
        if due_in == 1 && state.ahead == Ahead::Command {
            // At the time at which the commands are due.
            state.compensation.turn_clock(1);
            state.correct_commands();
            state.compensation.turn_clock(-1);
            state.ahead = Ahead::Corrections;
        }
    }
}
