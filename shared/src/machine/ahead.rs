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
//! The present command ([`State::commands`]) is that of the loops until the position tick, and a path is done when the loops follow its
//! last command.

use super::config::MachineConfig;
use super::state::State;
use crate::axis::AxisState;
use crate::safety::Power;
use crate::scalar::Scalar;
use crate::units::Position;

/// What is computed for the next position tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// Nothing: path and corrections are those of the position loops.
    Nothing,
    /// The command.
    Command,
    /// The command and its corrections.
    Corrections,
}

/// What is computed for the next position tick, and what the loops follow until then.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead<const N: usize> {
    stage: Stage,
    /// The commands that the loops follow, unless nothing is computed.
    followed: [Position; N],
}

impl<const N: usize> Ahead<N> {
    /// Nothing is computed.
    pub const NOTHING: Self = Self { stage: Stage::Nothing, followed: [Position(0); N] };

    /// Discards what is computed.
    pub const fn discard(&mut self) {
        self.stage = Stage::Nothing;
    }

    /// The origins are shifted, at rest: the loops follow these commands, which are also the next ones.
    pub const fn shift_to(&mut self, commands: &[Position; N]) {
        self.followed = *commands;
    }
}

impl<S: Scalar, const N: usize> State<S, N> {
    /// The commands that the position loops follow.
    #[inline]
    pub const fn commands(&self) -> [Position; N] {
        match self.ahead.stage {
            Stage::Nothing => self.path.command(),
            Stage::Command | Stage::Corrections => self.ahead.followed,
        }
    }

    /// These commands with their corrections.
    pub fn corrected_commands(&self) -> [Position; N] {
        if self.ahead.stage == Stage::Corrections {
            return self.axes.each_ref().map(AxisState::corrected_command);
        }
        let mut commands = self.commands();
        for (command, correction) in commands.iter_mut().zip(self.compensation.active_corrections()) {
            *command += correction.total.distance();
        }
        commands
    }

    /// Whether every block has ended and the loops follow its end.
    #[inline]
    pub fn is_done(&self) -> bool {
        self.path.is_done()
            && (self.ahead.stage == Stage::Nothing || self.ahead.followed == self.path.command())
    }

    /// Whether the path is done and does not stop.
    pub fn is_at_rest(&self) -> bool {
        self.is_done() && !self.path.is_braking()
    }

    /// Computes what is missing for the loops of this tick, which follow the next commands from here on.
    #[inline]
    pub fn complete_commands(&mut self) {
        if self.ahead.stage == Stage::Nothing {
            self.advance_path();
        }
        if self.ahead.stage != Stage::Corrections {
            self.correct_commands(0);
        }
        self.ahead.stage = Stage::Nothing;
    }

    /// Advances the path by a command. A path that waits does so until the brakes are open.
    fn advance_path(&mut self) {
        if !matches!(self.power, Power::Enabling) {
            self.path.advance();
        }
    }

    /// Computes the corrections of the commands of the path, which are due in a number of ticks, and the forces of their motion.
    #[inline]
    fn correct_commands(&mut self, due_in: u8) {
        let is_at_segment_end = self.path.take_segment_end();
        self.compensation.advance(&self.path.command(), is_at_segment_end, due_in);
        for axis in 0..N {
            self.compensation.command(axis);
        }
    }
}

impl<S: Scalar, const N: usize> MachineConfig<S, N> {
    /// What can be computed for the next position tick after a tick.
    #[inline]
    pub(super) fn prepare(&self, state: &mut State<S, N>) {
        let due_in = state.until_position_tick + 1;
        // While the brakes open, it is known in the position tick only whether the path moves.
        let is_waiting = !state.power.is_on() || matches!(state.power, Power::Enabling);
        if due_in > 2 || due_in >= self.rates.position_loop_divider || is_waiting {
            return;
        }
        if state.ahead.stage == Stage::Nothing {
            state.ahead = Ahead { stage: Stage::Command, followed: state.path.command() };
            state.advance_path();
        }
        if due_in == 1 && state.ahead.stage == Stage::Command {
            state.correct_commands(1);
            state.ahead.stage = Stage::Corrections;
        }
    }
}
