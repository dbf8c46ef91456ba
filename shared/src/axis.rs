//! One axis, one tick: read from top to bottom in the order of the signal.

use crate::config::AxisConfig;
use crate::control::bump::Bump;
use crate::control::{feedforward, filter, position, velocity};
use crate::feedback::dual;
use crate::safety::Hazards;
use crate::scalar::Scalar;
use crate::units::{Position, VELOCITY_M_PER_S};
use crate::watch::{self, Seen};

/// What the sensors of an axis show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Reading {
    /// Motor encoder or resolver, in table units.
    pub motor: Position,
    /// Linear scale, where there is one.
    pub table: Option<Position>,
}

/// What an axis remembers from tick to tick.
#[derive(Clone, Copy, Debug)]
pub struct AxisState<S: Scalar> {
    feedback: dual::State,
    feedforward: feedforward::State,
    position: position::State<S>,
    velocity: velocity::State<S>,
    notch: filter::State<S>,
    low_pass: filter::State<S>,
    /// What the loops gave last, and what keeps it from jumping when they are changed.
    velocity_command: S,
    shaped_force: S,
    velocity_bump: Bump<S>,
    force_bump: Bump<S>,
    /// Settle the filters of the force on what the changed loop makes: what is between is the bump's.
    resettle: bool,
    watch: watch::State<S>,
}

impl<S: Scalar> AxisState<S> {
    /// At rest: nothing integrated, nothing asked for.
    #[must_use]
    pub const fn at_rest(command: Position, reading: Reading) -> Self {
        Self {
            feedback: dual::State::settled(reading.motor, reading.table),
            feedforward: feedforward::State::at(command),
            position: position::State::AT_REST,
            velocity: velocity::State::at(reading.motor),
            notch: filter::State::AT_REST,
            low_pass: filter::State::AT_REST,
            velocity_command: S::ZERO,
            shaped_force: S::ZERO,
            velocity_bump: Bump::NONE,
            force_bump: Bump::NONE,
            resettle: false,
            watch: watch::State::at(command, reading.motor),
        }
    }

    /// The same with a correction (position units) that stands on the command already.
    #[must_use]
    pub const fn corrected(self, correction: i64) -> Self {
        Self { feedforward: self.feedforward.corrected(correction), ..self }
    }

    /// What the velocity loop is asked for, m/s.
    #[must_use]
    pub fn velocity_command_m_per_s(&self) -> f64 {
        self.velocity_command.value() * VELOCITY_M_PER_S
    }

    /// Goes over to other constants while it moves: neither velocity command nor force jumps.
    pub fn change(&mut self, from: &AxisConfig<S>, to: &AxisConfig<S>) {
        if from.position.hpc.is_none() {
            self.position.settle();
        }
        if to.velocity.has_no_integral() {
            self.velocity.forget_integral();
        }
        self.resettle = true;
        self.velocity_bump.change(self.velocity_command);
        self.force_bump.change(self.shaped_force);
    }

    /// The position loop, once per command, which `correction` (position units) is added to.
    pub fn position_tick(
        &mut self,
        config: &AxisConfig<S>,
        command: Position,
        correction: i64,
        reading: Reading,
    ) -> Hazards {
        let asked = command;
        let command = asked + correction;
        let feedback = config.feedback.position(&mut self.feedback, reading.motor, reading.table);
        let following_error = S::from_distance(command - feedback);
        let lead = config.feedforward.lead(&mut self.feedforward, command);
        let made = config.position.velocity(&mut self.position, following_error + lead);
        self.velocity_command = self.velocity_bump.smooth(config.velocity_fades, made);
        let seen = Seen {
            following_error,
            command: asked,
            velocity_command: self.velocity_command,
            motor: reading.motor,
            table: reading.table,
            needs_table: config.feedback.needs_table(),
        };
        config.watch.position(&mut self.watch, &seen)
    }

    /// The velocity loop, every tick, to whose force `added` is added. Returns the force to apply until the next
    /// one.
    pub fn velocity_tick(&mut self, config: &AxisConfig<S>, reading: Reading, added: S) -> (S, Hazards) {
        let wanted = config.velocity.wanted(&mut self.velocity, self.velocity_command, reading.motor);
        let mut shaped = wanted.force;
        if core::mem::take(&mut self.resettle) {
            (self.notch, self.low_pass) = (filter::State::settled(shaped), filter::State::settled(shaped));
        }
        if let Some(notch) = &config.notch {
            shaped = notch.step(&mut self.notch, shaped);
        }
        if let Some(low_pass) = &config.low_pass {
            shaped = low_pass.step(&mut self.low_pass, shaped);
        }
        self.shaped_force = self.force_bump.smooth(config.force_fades, shaped);
        let asked = self.shaped_force + added;
        let (force, limited) = config.velocity.limited(&mut self.velocity, &wanted, asked);
        (force, config.watch.velocity(&mut self.watch, self.velocity.increment(), limited))
    }
}
