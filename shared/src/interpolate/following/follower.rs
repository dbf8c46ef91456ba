//! An axis that follows a counter: the command of each position tick, within speed, acceleration, lag and travel.

use super::gear::{Gear, GearState};
use super::settings::{FollowError, FollowSettings};
use super::{CATCH_UP_PER_S, TRACKING_PER_S};
use crate::integer::mul_q32;
use crate::units::{PER_M, Position};

/// Fraction bits of velocities and accelerations, as in the path.
const BITS: u32 = 16;

/// Greatest difference that is corrected as a whole in a tick, position units: 33 mm.
const DIFFERENCE: i64 = 1 << 45;

/// Greatest remaining way that matters for a stop, position units: 275 m.
const FAR: u64 = 1 << 58;

/// Why an axis follows no longer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The setpoint is further from the command than declared.
    Lag,
    /// It could not stop within the travel if it went on.
    Travel,
}

/// The constants, in machine units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Config {
    gear: Gear,
    /// Position units per tick with 16 fraction bits.
    speed: i64,
    /// Position units per tick² with 16 fraction bits.
    acceleration: i64,
    /// Deceleration of a stop.
    deceleration: i64,
    /// Greatest speed beside that of the setpoint.
    catch_up: i64,
    /// Position units.
    lag: u64,
    /// 2α − α², α² and β, 32 fraction bits.
    gains_q32: [u32; 3],
}

/// An axis that follows a counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Follower {
    config: Config,
    input: u8,
    gear: GearState,
    setpoint: Position,
    /// Setpoint and its velocity, as the observer has them.
    observed: Position,
    observed_velocity: i64,
    velocity: i64,
    /// Parts of a position unit by which observer and command are behind, 16 fraction bits.
    observed_part: i64,
    part: i64,
    is_stopping: bool,
}

/// A number of SI in machine units with 16 fraction bits; `None` unless it is at least 1 of these and within its range.
fn machine_units(value: f64, range: core::ops::RangeInclusive<f64>, per_tick: f64) -> Option<i64> {
    let units = value * per_tick * f64::from(1 << BITS);
    #[expect(clippy::cast_possible_truncation, reason = "within the range, below 2⁶⁰ at 1 kHz")]
    let units = (range.contains(&value) && (1.0..=1.2e18).contains(&units)).then_some(units as i64);
    units
}

/// A fraction from 0 to 1 as 32 fraction bits.
fn q32(fraction: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 0.75·2³²")]
    let bits = (fraction * 4_294_967_296.0) as u32;
    bits
}

impl Config {
    fn new(settings: &FollowSettings, rate_hz: f64, deceleration: u64) -> Result<Self, FollowError> {
        let distance = Position::from_m(settings.distance_m).ok_or(FollowError::Ratio)?;
        // 1 pm is 1049 units.
        let is_valid = distance.0.unsigned_abs() >= 1049;
        let gear = Gear::new(distance.0, settings.counts).filter(|_| is_valid);
        let per_tick = PER_M / rate_hz;
        let speed = machine_units(settings.speed_m_per_s, 1e-9..=10.0, per_tick);
        let acceleration = machine_units(settings.acceleration_m_per_s2, 1e-6..=1e3, per_tick / rate_hz);
        let lag_m = Some(settings.lag_m).filter(|lag_m| (1e-6..=0.1).contains(lag_m));
        let lag = lag_m.and_then(Position::from_m).ok_or(FollowError::Lag)?;
        let (alpha, beta) = ((TRACKING_PER_S / rate_hz).min(0.5), (CATCH_UP_PER_S / rate_hz).min(0.25));
        let acceleration = acceleration.ok_or(FollowError::Acceleration)?;
        #[expect(clippy::cast_possible_truncation, reason = "saturates")]
        let catch_up = (0.5 * acceleration as f64 / beta) as i64;
        Ok(Self {
            gear: gear.ok_or(FollowError::Ratio)?,
            speed: speed.ok_or(FollowError::Speed)?,
            acceleration,
            deceleration: i64::try_from(deceleration).unwrap_or(i64::MAX).clamp(1, 1 << 60),
            catch_up: catch_up.clamp(1, 1 << 60),
            lag: lag.0.unsigned_abs(),
            gains_q32: [2.0 * alpha - alpha * alpha, alpha * alpha, beta].map(q32),
        })
    }
}

impl Follower {
    /// Follows a counter from a count and a command at rest on, with `rate_hz` position ticks a second. `deceleration` is that of a stop, per
    /// tick² with 16 fraction bits.
    ///
    /// # Errors
    /// [`FollowError::Ratio`], [`FollowError::Speed`], [`FollowError::Acceleration`], [`FollowError::Lag`].
    pub fn new(
        settings: &FollowSettings,
        count: u32,
        command: Position,
        rate_hz: f64,
        deceleration: u64,
    ) -> Result<Self, FollowError> {
        Ok(Self {
            config: Config::new(settings, rate_hz, deceleration)?,
            input: settings.input,
            gear: GearState::at(count),
            setpoint: command,
            observed: command,
            observed_velocity: 0,
            velocity: 0,
            observed_part: 0,
            part: 0,
            is_stopping: false,
        })
    }

    /// Input of its counter.
    #[must_use]
    pub const fn input(&self) -> u8 {
        self.input
    }

    /// Distance from a command to the setpoint, position units.
    #[must_use]
    pub fn lag(&self, command: Position) -> i64 {
        self.setpoint - command
    }

    /// Decelerates from here on, and follows no longer.
    pub const fn stop(&mut self) {
        self.is_stopping = true;
    }

    /// Whether it has stopped.
    #[must_use]
    pub const fn has_stopped(&self) -> bool {
        self.is_stopping && self.velocity == 0
    }

    /// The command of a position tick, for the count at it. If it ends the following, the axis decelerates from this tick on.
    pub fn step(&mut self, count: u32, command: &mut Position, travel: [Position; 2]) -> Option<Ending> {
        let ending = if self.is_stopping { None } else { self.follow(count, *command, travel) };
        if ending.is_some() {
            self.stop();
        }
        if self.is_stopping {
            self.velocity = towards(self.velocity, 0, self.config.deceleration);
        }
        *command += advance(self.velocity, &mut self.part);
        ending
    }

    /// The velocity of a tick, unless it ends the following.
    fn follow(&mut self, count: u32, command: Position, travel: [Position; 2]) -> Option<Ending> {
        let moved = self.config.gear.step(&mut self.gear, count);
        self.setpoint.0 = self.setpoint.0.saturating_add(moved);
        self.observe();
        if self.setpoint.0.abs_diff(command.0) > self.config.lag {
            return Some(Ending::Lag);
        }
        let [_, _, beta] = self.config.gains_q32;
        let behind = self.observed.0.saturating_sub(command.0).clamp(-DIFFERENCE, DIFFERENCE) << BITS;
        let behind = behind.saturating_sub(self.observed_velocity);
        let catch_up = limited(mul_q32(behind, beta), self.config.catch_up);
        let wanted = limited(self.observed_velocity.saturating_add(catch_up), self.config.speed);
        let velocity = towards(self.velocity, wanted, self.config.acceleration);
        if !self.can_stop(velocity, command, travel) {
            return Some(Ending::Travel);
        }
        self.velocity = velocity;
        None
    }

    /// The observer of the setpoint.
    fn observe(&mut self) {
        let [position, velocity, _] = self.config.gains_q32;
        let predicted = self.observed + advance(self.observed_velocity, &mut self.observed_part);
        let error = self.setpoint.0.saturating_sub(predicted.0).clamp(-DIFFERENCE, DIFFERENCE);
        self.observed = predicted + mul_q32(error, position);
        self.observed_velocity =
            limited(self.observed_velocity.saturating_add(mul_q32(error << BITS, velocity)), 1 << 60);
    }

    /// Whether the axis could stop within its travel after a tick at a velocity: v²/(2·deceleration) is at most what remains then. Inwards it
    /// always can.
    fn can_stop(&self, velocity: i64, command: Position, [least, greatest]: [Position; 2]) -> bool {
        // One unit for what a tick leaves in `part`.
        let after = command.0.saturating_add((velocity >> BITS) + 1);
        let remaining = match velocity {
            1.. => greatest.0.saturating_sub(after),
            0 => return true,
            _ => after.saturating_sub(least.0).saturating_sub(1),
        };
        let Ok(remaining) = u64::try_from(remaining) else { return false };
        let square = u128::from(velocity.unsigned_abs()) * u128::from(velocity.unsigned_abs());
        let way = u128::from(remaining.min(FAR)) * u128::from(self.config.deceleration.unsigned_abs());
        square >> (BITS + 1) <= way
    }
}

/// The way of a tick at a velocity, in whole units; what is left of it is kept.
const fn advance(velocity: i64, part: &mut i64) -> i64 {
    let way = velocity.wrapping_add(*part);
    *part = way & ((1 << BITS) - 1);
    way >> BITS
}

/// A value within ± `limit`, which is positive; `clamp` could panic.
fn limited(value: i64, limit: i64) -> i64 {
    value.min(limit).max(-limit)
}

/// A velocity that changes by at most `step` towards another one.
fn towards(from: i64, to: i64, step: i64) -> i64 {
    from.saturating_add(limited(to.saturating_sub(from), step))
}

#[cfg(test)]
mod tests;
