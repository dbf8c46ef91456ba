//! One axis: its loops in the order of the signal.

use crate::compensate::Correction;
use crate::config::{AxisConfig, NOTCHES};
use crate::control::bumpless_transfer::BumplessTransfer;
use crate::control::velocity::PiOutput;
use crate::control::{feedforward, filter, gain_schedule, position, velocity};
use crate::feedback::OriginShift;
pub use crate::feedback::Reading;
use crate::feedback::dual;
use crate::monitor::{self, MonitorInput};
use crate::safety::FaultSet;
use crate::scalar::Scalar;
use crate::units::{Position, VELOCITY_M_PER_S};

/// What an axis keeps from tick to tick.
#[derive(Clone, Copy, Debug)]
pub struct AxisState<S: Scalar> {
    feedback: dual::State,
    feedforward: feedforward::State<S>,
    position: position::State<S>,
    velocity: velocity::State<S>,
    notches: [filter::State<S>; NOTCHES],
    low_pass: filter::State<S>,
    /// Last output of the position loop, velocity units.
    velocity_command: S,
    /// Last force after the filters, before compensation and limit.
    filtered_force: S,
    velocity_transfer: BumplessTransfer<S>,
    force_transfer: BumplessTransfer<S>,
    /// Settle the filters at the next output of the velocity loop, which has been changed. The difference to the last
    /// output is left to the bumpless transfer.
    settle_filters: bool,
    /// Whether the last tick has found that the velocity loop has no observer and that nothing is to be settled. One test for all of
    /// this: most axes have neither.
    is_usual: bool,
    monitor: monitor::State<S>,
}

impl<S: Scalar> AxisState<S> {
    /// At rest: integral, velocity command and force are zero.
    #[must_use]
    pub const fn at_rest(command: Position, reading: Reading) -> Self {
        Self {
            feedback: dual::State::settled(reading.motor, reading.table),
            feedforward: feedforward::State::at(command),
            position: position::State::AT_REST,
            velocity: velocity::State::at(reading.motor),
            notches: [filter::State::AT_REST; NOTCHES],
            low_pass: filter::State::AT_REST,
            velocity_command: S::ZERO,
            filtered_force: S::ZERO,
            velocity_transfer: BumplessTransfer::INACTIVE,
            force_transfer: BumplessTransfer::INACTIVE,
            settle_filters: false,
            is_usual: false,
            monitor: monitor::State::at(command, reading.motor),
        }
    }

    /// This motion where a correction (position units) is already added to the command.
    #[must_use]
    pub const fn corrected(self, correction: i64) -> Self {
        Self { feedforward: self.feedforward.corrected(correction), ..self }
    }

    /// This motion at a constant velocity, m/s, for an observer of the velocity. The readings before were those of this velocity.
    #[must_use]
    pub fn moving(self, m_per_s: f64) -> Self {
        Self { velocity: self.velocity.observing(S::signal(m_per_s / VELOCITY_M_PER_S)), ..self }
    }

    /// Lets the force of the loops, before compensation, begin with a force, N, from which it continues without a step: the integral
    /// and the filters of an axis at rest start with it.
    pub fn preload(&mut self, force: S) {
        self.velocity.preload(force);
        self.settle_filters_at(force);
    }

    fn settle_filters_at(&mut self, force: S) {
        self.notches = [filter::State::settled(force); NOTCHES];
        self.low_pass = filter::State::settled(force);
    }

    /// The axis after the readings of motor and table have been shifted by `origin`, and the command with them to `command`: the
    /// loops continue without a step.
    #[must_use]
    pub fn shifted(self, command: Position, command_shift: i64, origin: OriginShift) -> Self {
        Self {
            feedback: self.feedback.shifted(origin.motor, origin.table),
            feedforward: self.feedforward.corrected(command_shift),
            velocity: self.velocity.shifted(origin.motor),
            monitor: self.monitor.shifted(command, command_shift, origin.motor),
            ..self
        }
    }

    /// The velocity command, m/s.
    #[must_use]
    pub fn velocity_command_m_per_s(&self) -> f64 {
        self.velocity_command.value() * VELOCITY_M_PER_S
    }

    /// The command that the position loop follows, with its correction.
    pub(crate) const fn corrected_command(&self) -> Position {
        self.feedforward.command()
    }

    /// The magnitude of the last change of the corrected command, as [`gain_schedule::speed`] gives it.
    pub(crate) fn command_speed(&self) -> i64 {
        gain_schedule::speed(self.feedforward.increment())
    }

    /// Prepares a change of the constants during motion, without a jump of velocity command or force.
    pub fn change(&mut self, from: &AxisConfig<S>, to: &AxisConfig<S>) {
        if from.position.hpc.is_none() {
            self.position.settle_filter();
        }
        if !to.velocity.has_integral {
            self.velocity.reset_integral();
        }
        if from.velocity.observer.is_none() {
            // An observer that begins in motion; one with another bandwidth continues.
            self.velocity = self.velocity.observing(to.velocity.last_difference(&self.velocity));
        }
        (self.settle_filters, self.is_usual) = (true, false);
        self.velocity_transfer.start(self.velocity_command);
        self.force_transfer.start(self.filtered_force);
    }

    /// The position loop, once per command. The correction is added to the command; its part for errors between motor and
    /// scale also to the scale's reading (see [`crate::compensate`]).
    #[inline(never)]
    pub fn position_tick(
        &mut self,
        config: &AxisConfig<S>,
        command: Position,
        correction: Correction<S>,
        reading: Reading,
    ) -> FaultSet {
        let corrected = command + correction.total.distance();
        let scale = reading.table.map(|table| table + correction.screw.distance());
        let feedback = config.feedback.position(&mut self.feedback, reading.motor, scale);
        let following_error = S::from_distance(corrected - feedback);
        let lead = config.feedforward.lead(&mut self.feedforward, corrected);
        let velocity = config.position.velocity(&mut self.position, following_error + lead);
        self.velocity_command = self.velocity_transfer.apply(config.velocity_transfer_decay, velocity);
        let input = MonitorInput {
            following_error,
            command,
            velocity_command: self.velocity_command,
            motor: reading.motor,
            table: reading.table,
            uses_scale: config.feedback.uses_scale(),
        };
        config.monitor.position(&mut self.monitor, &input)
    }

    /// The PI law of an axis with an observer, and in the first tick after a start or a change.
    #[cold]
    #[inline(never)]
    fn unusual_pi(&mut self, config: &AxisConfig<S>, motor: Position) -> PiOutput<S> {
        let pi = config.velocity.pi_output(&mut self.velocity, self.velocity_command, motor);
        if self.settle_filters {
            self.settle_filters = false;
            self.settle_filters_at(pi.force);
        }
        self.is_usual = config.velocity.observer.is_none();
        pi
    }

    /// The velocity loop, once per tick. `compensation` is added to its force. Returns the force until the next tick.
    #[inline(never)]
    pub fn velocity_tick(
        &mut self,
        config: &AxisConfig<S>,
        reading: Reading,
        compensation: S,
    ) -> (S, FaultSet) {
        let pi = if self.is_usual {
            config.velocity.pi_by_difference(&mut self.velocity, self.velocity_command, reading.motor)
        } else {
            self.unusual_pi(config, reading.motor)
        };
        let mut filtered = pi.force;
        for (notch, state) in config.notches.iter().map_while(Option::as_ref).zip(&mut self.notches) {
            filtered = notch.step(state, filtered);
        }
        if let Some(low_pass) = &config.low_pass {
            filtered = low_pass.step(&mut self.low_pass, filtered);
        }
        self.filtered_force = self.force_transfer.apply(config.force_transfer_decay, filtered);
        let unlimited = self.filtered_force + compensation;
        let (force, limited) = config.velocity.limit(&mut self.velocity, &pi, unlimited);
        (force, config.monitor.velocity(&mut self.monitor, self.velocity.increment(), limited))
    }
}
