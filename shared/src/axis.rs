//! One axis, one tick: read from top to bottom in the order of the signal.

use crate::config::AxisConfig;
use crate::control::{feedforward, position, velocity};
use crate::feedback::dual;
use crate::scalar::Scalar;
use crate::units::Position;

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
    velocity_command: S,
}

impl<S: Scalar> AxisState<S> {
    /// At rest: nothing integrated, nothing asked for.
    #[must_use]
    pub fn at_rest(command: Position, reading: Reading) -> Self {
        Self {
            feedback: dual::State::settled(reading.motor, reading.table),
            feedforward: feedforward::State::at(command),
            position: position::State::default(),
            velocity: velocity::State::at(reading.motor),
            velocity_command: S::default(),
        }
    }

    /// The position loop, once per command. Returns command − feedback in position units.
    pub fn position_tick(&mut self, config: &AxisConfig<S>, command: Position, reading: Reading) -> i64 {
        let feedback = config.feedback.position(&mut self.feedback, reading.motor, reading.table);
        let following_error = command.beyond(feedback);
        let lead = config.feedforward.lead(&mut self.feedforward, command);
        let error = S::from_distance(following_error).plus(lead);
        self.velocity_command = config.position.velocity(&mut self.position, error);
        following_error
    }

    /// The velocity loop, every tick. Returns the force to apply until the next one.
    pub fn velocity_tick(&mut self, config: &AxisConfig<S>, reading: Reading) -> S {
        config.velocity.force(&mut self.velocity, self.velocity_command, reading.motor)
    }
}
