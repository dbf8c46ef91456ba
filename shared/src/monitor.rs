//! Monitoring of one axis, tick by tick: which faults there are. [`crate::safety`] defines the reactions.
//!
//! # Example
//!
//! The force may be at its limit for 1 s; a tick later the fault is raised.
//!
//! ```
//! use shared::config::{AxisConfig, AxisSettings, Rates};
//! use shared::monitor::State;
//! use shared::safety::FaultKind;
//! use shared::units::Position;
//!
//! let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
//! let settings = AxisSettings { saturation_time_s: 1.0, ..AxisSettings::default() };
//! let monitor = AxisConfig::<f64>::new(&settings, rates).unwrap().monitor;
//! let mut state = State::at(Position(0), Position(0));
//! let mut saturated = || monitor.velocity(&mut state, 0.0, true);
//! assert!((0..20_000).all(|_| saturated().is_empty()));
//! assert!(saturated().iter().eq([FaultKind::ForceSaturated]));
//! ```

mod band;
mod standing;

pub use band::Band;
pub use standing::Apart;
use standing::{KeptReadings, STANDSTILL_DIVISOR};

use crate::safety::{FaultKind, FaultSet};
use crate::scalar::Scalar;
use crate::units::{PER_NM, Position};

/// Limits of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Monitor<S: Scalar> {
    /// Greatest following error (command − feedback), error units.
    pub following_error: S,
    /// Difference between scale and motor; [`Band::UNLIMITED`]: not monitored.
    pub disagreement: Band,
    /// Greatest motion of the motor reading per tick, increment units; `None`: not monitored.
    pub encoder_step: Option<S>,
    /// Limits of motor and scale of which one stands, of a loop that uses the scale.
    pub apart: Apart,
    /// Detection of a frozen motor encoder; `None`: not monitored.
    pub frozen_encoder: Option<FrozenEncoder<S>>,
    /// Saturation budget in ticks; each unsaturated tick earns back a quarter.
    pub saturation_budget_ticks: u32,
    /// Least and greatest command.
    pub travel: [Position; 2],
}

/// Limits of a motor reading that stands still.
///
/// The encoder is frozen when, since the reading last moved, the command has travelled by `limit` and the integral of
/// the velocity command has exceeded `integral_limit`. Neither alone is sufficient: when the command reverses while the motor is
/// far behind, the command moves although the motor has to stand; and a velocity loop without an integral part
/// commands a velocity that is never reached while it holds a load.
#[derive(Clone, Copy, Debug)]
pub struct FrozenEncoder<S: Scalar> {
    /// Travel of the command, position units.
    pub limit: u64,
    /// Motion of a motor reading that counts as standing: 1/64 of the limit.
    standstill: Band,
    /// The travel of [`Self::limit`] as an integral of the velocity command, error units.
    pub integral_limit: S,
    /// Error units per velocity unit and position tick.
    pub per_tick: S::Gain,
}

impl<S: Scalar> FrozenEncoder<S> {
    /// For a travel in position units, the same as an error signal, and error units per velocity unit and position tick.
    #[must_use]
    pub fn new(limit: u64, error: S, per_tick: S::Gain) -> Self {
        Self { limit, standstill: Band::new(limit / STANDSTILL_DIVISOR), integral_limit: error, per_tick }
    }
}

/// State of the monitoring of an axis.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar> {
    /// Saturated time in quarters of a tick.
    saturated_quarters: u32,
    /// The last command that broke no soft limit.
    allowed_command: Position,
    /// Command and motor reading when the motor reading last moved.
    last_motion: [Position; 2],
    /// Integral of the velocity command since then, error units; it stops one tick beyond its limit.
    velocity_integral: S::Sum,
    /// Motor and scale of the loop when both had last moved.
    kept: KeptReadings,
}

impl<S: Scalar> State<S> {
    /// For an axis that is enabled at a command and a motor reading.
    #[must_use]
    pub const fn at(command: Position, motor: Position) -> Self {
        Self {
            saturated_quarters: 0,
            allowed_command: command,
            last_motion: [command, motor],
            velocity_integral: S::ZERO_SUM,
            kept: KeptReadings::UNKNOWN,
        }
    }
}

impl<S: Scalar> State<S> {
    /// The monitor after command and motor reading have been shifted by these distances, position units. The soft limits apply
    /// from the shifted command on, and motor and scale are compared from their next readings on.
    #[must_use]
    pub fn shifted(self, command: Position, command_shift: i64, motor_shift: i64) -> Self {
        let [last_command, last_motor] = self.last_motion;
        Self {
            allowed_command: command,
            last_motion: [last_command + command_shift, last_motor + motor_shift],
            kept: KeptReadings::UNKNOWN,
            ..self
        }
    }
}

/// Tolerance of the soft limits, position units: 1 pm. The axis filters settle at the end of a path from a unit or two
/// beyond it.
const SOFT_LIMIT_TOLERANCE: i64 = PER_NM / 1000;

/// Input of the monitoring in a position tick.
#[derive(Clone, Copy, Debug)]
pub struct MonitorInput<S> {
    /// Command − feedback, error units.
    pub following_error: S,
    /// Command, without corrections.
    pub command: Position,
    /// Velocity command, velocity units.
    pub velocity_command: S,
    /// Motor reading.
    pub motor: Position,
    /// Reading of the linear scale.
    pub table: Option<Position>,
    /// Whether the position loop uses the scale.
    pub uses_scale: bool,
}

impl<S: Scalar> Monitor<S> {
    /// The faults of a position tick.
    #[must_use]
    #[inline]
    pub fn position(&self, state: &mut State<S>, input: &MonitorInput<S>) -> FaultSet {
        let frozen = self.is_frozen(state, input);
        let [min, max] = self.travel;
        // The usual case. An overflow of a difference gives the other sign.
        if !frozen
            && (input.command - min) | (max - input.command) >= 0
            && !input.following_error.exceeds(self.following_error)
            && self.scale_is_usual(state, input)
        {
            state.allowed_command = input.command;
            return FaultSet::NONE;
        }
        let standing = self.apart.standing_sensor(&mut state.kept, input.motor, input.table);
        FaultSet::NONE
            .with(FaultKind::FollowingError, input.following_error.exceeds(self.following_error))
            .with(FaultKind::Disagreement, self.disagree(input))
            .with(FaultKind::EncoderFrozen, frozen || standing == Some(FaultKind::EncoderFrozen))
            .with(FaultKind::ScaleFrozen, standing == Some(FaultKind::ScaleFrozen))
            .with(FaultKind::SoftLimit, self.leaves_travel(state, input.command))
            .with(FaultKind::ScaleLost, Self::is_lost(input))
    }

    /// Whether the scale is read where the loop uses it, with a difference from the motor that is within its limit and has not changed.
    #[inline]
    fn scale_is_usual(&self, state: &State<S>, input: &MonitorInput<S>) -> bool {
        let Some(table) = input.table else { return !input.uses_scale };
        let difference = table - input.motor;
        self.disagreement.contains(difference) && !self.apart.has_changed(state.kept, difference)
    }

    /// Whether scale and motor disagree.
    fn disagree(&self, input: &MonitorInput<S>) -> bool {
        input.table.is_some_and(|table| !self.disagreement.contains(table - input.motor))
    }

    /// Whether the scale of the loop has no reading.
    #[inline]
    const fn is_lost(input: &MonitorInput<S>) -> bool {
        input.uses_scale && input.table.is_none()
    }

    /// Whether the command moves outwards beyond the travel. An axis that was enabled outside its travel may stay and move
    /// inwards; the limit follows it.
    fn leaves_travel(&self, state: &mut State<S>, command: Position) -> bool {
        let [min, max] = self.travel;
        let [min, max] = [min.min(state.allowed_command), max.max(state.allowed_command)];
        let leaves = command < min - SOFT_LIMIT_TOLERANCE || command > max + SOFT_LIMIT_TOLERANCE;
        if !leaves {
            state.allowed_command = command.clamp(min, max);
        }
        leaves
    }

    /// Whether the motor reading is frozen: see [`FrozenEncoder`].
    fn is_frozen(&self, state: &mut State<S>, input: &MonitorInput<S>) -> bool {
        let Some(frozen) = &self.frozen_encoder else { return false };
        let [command, motor] = state.last_motion;
        if !frozen.standstill.contains(input.motor - motor) {
            (state.last_motion, state.velocity_integral) = ([input.command, input.motor], S::ZERO_SUM);
            return false;
        }
        if !S::sum_exceeds(state.velocity_integral, frozen.integral_limit) {
            state.velocity_integral += input.velocity_command * frozen.per_tick;
            return false;
        }
        (input.command - command).unsigned_abs() > frozen.limit
    }

    /// The faults of a tick, from the motion of the motor since the previous tick and whether the force is at its limit.
    #[must_use]
    #[inline]
    pub fn velocity(&self, state: &mut State<S>, increment: S, saturated: bool) -> FaultSet {
        let too_far = self.encoder_step.is_some_and(|max| increment.exceeds(max));
        // The usual case.
        if !(saturated || too_far || state.saturated_quarters != 0) {
            return FaultSet::NONE;
        }
        FaultSet::NONE
            .with(FaultKind::EncoderStep, too_far)
            .with(FaultKind::ForceSaturated, self.is_saturated_too_long(state, saturated))
    }

    /// Counts the saturated time. Whether it exceeds its budget.
    #[inline(never)]
    fn is_saturated_too_long(&self, state: &mut State<S>, saturated: bool) -> bool {
        // An unstable loop drives the force from limit to limit: an unsaturated tick in between must not reset the count.
        state.saturated_quarters = if saturated {
            state.saturated_quarters.saturating_add(4)
        } else {
            state.saturated_quarters.saturating_sub(1)
        };
        saturated && state.saturated_quarters / 4 > self.saturation_budget_ticks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{AxisConfig, AxisSettings, Rates, Sensors};
    use crate::scalar::Fixed;
    use crate::units::VELOCITY_M_PER_S;

    const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };

    fn monitor<S: Scalar>(settings: &AxisSettings) -> Monitor<S> {
        AxisConfig::new(settings, RATES).unwrap().monitor
    }

    fn input<S: Scalar>(command: Position, motor: Position, velocity_m_per_s: f64) -> MonitorInput<S> {
        MonitorInput {
            following_error: S::ZERO,
            command,
            velocity_command: S::signal(velocity_m_per_s / VELOCITY_M_PER_S),
            motor,
            table: None,
            uses_scale: false,
        }
    }

    /// The tick in which a motor that stands is reported: the command moves by 10 µm in each. In one of the ticks the origin may be
    /// shifted, by distances of metres that differ for command and motor.
    fn frozen_after<S: Scalar>(shifted_at: Option<i64>) -> Option<i64> {
        let settings = AxisSettings {
            sensors: Sensors::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: Some(1e-3) },
            ..AxisSettings::default()
        };
        let monitor = monitor::<S>(&settings);
        let (mut command, mut motor) = (Position(0), Position(0));
        let mut state = State::at(command, motor);
        for tick in 1..200 {
            command += 10_000 * PER_NM;
            if shifted_at == Some(tick) {
                let [command_shift, motor_shift] = [3_141_592_653_589_793, -271_828_182_845_904];
                (command, motor) = (command + command_shift, motor + motor_shift);
                state = state.shifted(command, command_shift, motor_shift);
            }
            // Twice the speed of the command: the integral leaves its limits half-way.
            let faults = monitor.position(&mut state, &input(command, motor, 0.4));
            if !faults.is_empty() {
                assert!(faults.iter().eq([FaultKind::EncoderFrozen]));
                return Some(tick);
            }
        }
        None
    }

    /// 100 ticks of 10 µm are the limit of 1 mm, and the next exceeds it. An origin that is set meanwhile is no motion: before or
    /// after the integral of the velocity command has left its limits, it neither delays the fault nor causes it.
    #[test]
    fn an_origin_that_is_set_does_not_move_a_frozen_encoder() {
        for shifted_at in [None, Some(2), Some(30), Some(70), Some(99)] {
            assert_eq!(frozen_after::<Fixed>(shifted_at), Some(101), "{shifted_at:?}");
            assert_eq!(frozen_after::<f32>(shifted_at), Some(101), "{shifted_at:?}");
            assert_eq!(frozen_after::<f64>(shifted_at), Some(101), "{shifted_at:?}");
        }
    }

    /// An origin that puts the axis 3 mm outwards of an end of its travel: it may stay there and move inwards, and not further out
    /// by more than the tolerance.
    #[test]
    fn the_soft_limits_apply_from_the_shifted_command_on() {
        let settings = AxisSettings { travel_m: Some([-1e-3, 1e-3]), ..AxisSettings::default() };
        let monitor = monitor::<Fixed>(&settings);
        for sign in [1, -1] {
            let outside = Position(sign * 4_000_000 * PER_NM);
            let faults = |distance: i64| {
                let mut state = State::at(Position(0), Position(0)).shifted(outside, outside.0, 0);
                let command = outside + sign * distance;
                let faults = monitor.position(&mut state, &input(command, Position(0), 0.0));
                faults.iter().eq([FaultKind::SoftLimit])
            };
            for (distance, expected) in [
                (-PER_NM, false),
                (0, false),
                (SOFT_LIMIT_TOLERANCE, false),
                (SOFT_LIMIT_TOLERANCE + 1, true),
            ] {
                assert_eq!(faults(distance), expected, "{distance} units outwards");
            }
        }
    }

    /// The ends of the range of positions are outside of any travel, although the distance to its other end overflows there.
    #[test]
    fn the_ends_of_the_range_of_positions_are_outside_of_the_travel() {
        let settings = AxisSettings { travel_m: Some([-0.02, 0.03]), ..AxisSettings::default() };
        let monitor = monitor::<Fixed>(&settings);
        for units in [i64::MIN, i64::MIN + 1, i64::MAX - 1, i64::MAX] {
            let mut state = State::at(Position(0), Position(0));
            let faults = monitor.position(&mut state, &input(Position(units), Position(0), 0.0));
            assert!(faults.iter().eq([FaultKind::SoftLimit]), "{units}");
        }
    }
}
