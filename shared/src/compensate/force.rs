//! Force feed-forward: the force that the commanded motion requires by the model of the machine.
//!
//! ```text
//! table:  F_t = m_t·a + b·v + h·|v| + g(v)·direction + load(x)
//! motor:  F   = share·(m_m·a + g_m(v)·tanh(v/w) + F_t)                w = 0.2 mm/s
//! ```
//!
//! x, v and a are the commanded motion after a first-order low-pass filter of the lag; v and a are its first and second
//! difference per position tick, exact in position units. The direction is that of the bristles ([`super::presliding`]), so
//! that the friction after a reversal follows the distance travelled, or tanh(v/w) without them. Friction over the position
//! and that of a cold machine have the same direction. `F_t` also gives the deflection of the drive (`stretch_m_per_n`).
//!
//! Forces are in fixed point ([`Fixed`], steps of 61 µN) and fractions in integers: the same in every number format.

use super::force_settings::{ForceModel, FrictionWarmUp, TableFriction};
use super::friction_level::Friction;
use super::motion::CommandMotion;
use super::names::stribeck_names;
use super::octave_curve::OctaveCurve;
use super::presliding::{Presliding, upper};
use super::speed_curves::SpeedCurves;
use crate::config::ConfigError;
use crate::config::check::{gain, positive, ranged};
use crate::integer::{mul_high_i32, mul_q32, mul_shift, shifted_signed};
use crate::scalar::{Fixed, Scalar, narrow};
use crate::units::{INCREMENT_M, PER_M, Position};

/// w of the smoothed sign of the velocity, tanh(v/w), m/s, as in the declared model of the machine.
const SIGN_WIDTH_M_PER_S: f64 = 0.2e-3;

/// Acceleration that a signal has to hold, m/s².
const MAX_ACCELERATION_M_PER_S2: f64 = 200.0;

/// Fraction bits that an acceleration in position units per tick² has beyond those of an increment signal.
const MAX_ACCELERATION_BITS: f64 = 10.0;

/// Greatest lag, s.
const MAX_LAG_S: f64 = 1.0;

/// Constants of the feed-forward. Gains have 24 fraction bits and are multiplied by signals of 14.
#[derive(Clone, Copy, Debug)]
pub struct Force {
    /// Fraction of the distance to the command that the filtered position makes up per position tick.
    lag_q32: u32,
    /// Lag in position ticks, 16 fraction bits.
    lag_ticks_q16: i64,
    /// Accelerations in position units per tick² are shifted right by this.
    acceleration_shift: u32,
    table_mass: i32,
    /// `share` times the motor's mass.
    applied_motor_mass: i32,
    /// b − h and b + h.
    viscous: [i32; 2],
    share: i32,
    /// Greatest friction of the table, and of the motor times `share`, steps of 2⁻¹⁴ N.
    table_greatest: i32,
    applied_motor_greatest: i32,
    /// The greatest friction of the table over the least, 16 fraction bits.
    greatest_over_least_q16: i32,
    presliding: Option<Presliding>,
    /// Over the speed:
    ///
    /// 0. friction of the table as a fraction of its greatest: g(v), times tanh(v/w) without presliding
    /// 1. with presliding: the least g over g(v); without: tanh(v/w)
    /// 2. friction of the motor as a fraction of its greatest: g(v)·tanh(v/w)
    curves: SpeedCurves<3>,
    warm_up: Option<(Fixed, OctaveCurve)>,
}

/// State of the feed-forward.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Filtered command.
    position: Position,
    /// Its last change, position units.
    increment: i64,
    /// Friction of the bristles, a fraction of the greatest g: see [`Presliding::step`].
    bristles: i64,
    /// Force to apply, N.
    pub applied: Fixed,
    /// Force on the table, N.
    pub on_table: Fixed,
}

/// What the force depends on besides the motion.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// Load at the position, N.
    pub load: Fixed,
    /// Additional friction at the position and time, N.
    pub friction: Fixed,
}

impl State {
    /// At rest at zero, without force.
    pub const NEW: Self = Self {
        position: Position(0),
        increment: 0,
        bristles: 0,
        applied: Fixed::ZERO,
        on_table: Fixed::ZERO,
    };

    /// At rest at a position, without force.
    pub fn rest_at(&mut self, position: Position) {
        *self = Self { position, ..Self::NEW };
    }

    /// Continues from a shifted origin.
    pub fn shift(&mut self, command: i64) {
        self.position += command;
    }
}

impl Force {
    /// Checks and converts settings, for a command every 1/`rate_hz` and a velocity loop at `tick_hz`.
    ///
    /// # Errors
    /// [`ConfigError`] with the name of the setting.
    pub fn new(model: &ForceModel, [rate_hz, tick_hz]: [f64; 2], bound_n: f64) -> Result<Self, ConfigError> {
        let TableFriction { viscous_n_s_per_m, half_difference_n_s_per_m, warm_up, .. } = model.friction;
        let not_negative = |name, value| ranged(name, value, 0.0, f64::MAX);
        let lag_ticks = ranged("force.lag_s", model.lag_s, 0.0, MAX_LAG_S)? * rate_hz;
        let unit = INCREMENT_M * rate_hz * rate_hz;
        let bits = libm::floor(libm::log2(Fixed::SIGNAL_LIMIT * unit / MAX_ACCELERATION_M_PER_S2))
            .clamp(0.0, MAX_ACCELERATION_BITS);
        let (force, unit) = (mass_gains(model, unit / libm::exp2(bits))?, INCREMENT_M * rate_hz);
        // Half the range of a gain, so that no sum of products overflows.
        gain::<Fixed>(
            "force.friction.viscous_n_s_per_m",
            not_negative("force.friction.viscous_n_s_per_m", viscous_n_s_per_m)?,
            2.0 * unit,
        )?;
        let sum = viscous_n_s_per_m + half_difference_n_s_per_m.abs();
        gain::<Fixed>("force.friction.half_difference_n_s_per_m", sum, 2.0 * unit)?;
        let viscous = [-1.0, 1.0].map(|sign| viscous_n_s_per_m + sign * half_difference_n_s_per_m);
        let [motor, table] = frictions(model, bound_n, PER_M / rate_hz)?;
        let stiffness = model.friction.presliding_stiffness_n_per_m;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates below 1, 0 to 10"
        )]
        let (lag_q32, acceleration_shift) =
            ((libm::exp2(32.0) / (1.0 + lag_ticks)) as u32, (MAX_ACCELERATION_BITS - bits) as u32);
        #[expect(clippy::cast_possible_truncation, reason = "at most 10⁶ ticks, a ratio below 2³⁰")]
        let (lag_ticks_q16, greatest_over_least_q16) = (
            libm::rint(lag_ticks * 65_536.0) as i64,
            libm::rint(table.greatest_over_least() * 65_536.0) as i32,
        );
        let [table_mass, applied_motor_mass, share] = force;
        Ok(Self {
            lag_q32,
            lag_ticks_q16,
            acceleration_shift,
            table_mass,
            applied_motor_mass,
            viscous: viscous.map(|n_s_per_m| Fixed::gain(n_s_per_m * unit).to_bits()),
            share,
            table_greatest: Fixed::signal(table.greatest_n()).to_bits(),
            applied_motor_greatest: Fixed::signal(model.share * motor.greatest_n()).to_bits(),
            greatest_over_least_q16,
            presliding: stiffness.map(|stiffness| table.presliding(stiffness)).transpose()?,
            curves: curves(motor, table, stiffness.is_some(), SIGN_WIDTH_M_PER_S * PER_M / rate_hz),
            warm_up: warm_up.map(|warm_up| cold(&warm_up, tick_hz, bound_n)).transpose()?,
        })
    }

    /// Sets the state to a motion that has been steady, keeping the friction of the bristles if there is one.
    pub fn start<S: Scalar>(&self, state: &mut State, motion: &CommandMotion<S>) {
        // 1.024 µm are 64 increment units.
        let increment = motion.increment.distance() >> 6;
        // A ramp lags by (1 − f)/f ticks with the fraction f = 1/(1 + lag).
        state.position = motion.position - mul_shift::<16>(increment, self.lag_ticks_q16);
        state.increment = increment;
        if state.bristles == 0 && self.presliding.is_some() {
            let [level_q31, ..] = self.curves.at(increment.unsigned_abs());
            state.bristles = (i64::from(level_q31) << 29) * increment.signum();
        }
    }

    /// Whether there is additional friction of a cold machine.
    #[must_use]
    pub const fn warms_up(&self) -> bool {
        self.warm_up.is_some()
    }

    /// Additional friction of a cold machine after a number of ticks of the velocity loop, N.
    #[must_use]
    pub fn cold_friction(&self, ticks: u64) -> Fixed {
        let remaining = |(force, curve): &(Fixed, OctaveCurve)| Fixed::ZERO.lerp(*force, curve.at(ticks));
        self.warm_up.as_ref().map_or(Fixed::ZERO, remaining)
    }

    /// The forces of the next command, once per position tick.
    pub fn update(&self, state: &mut State, command: Position, at: Surroundings) {
        let increment = mul_q32(command - state.position, self.lag_q32);
        let acceleration = shifted_signed(increment.wrapping_sub(state.increment), self.acceleration_shift);
        (state.position, state.increment) = (state.position + increment, increment);
        let velocity = Fixed::from_increment(increment).to_bits();
        let [level, second, motor] = self.curves.at(increment.unsigned_abs());
        let signed = |magnitude: i32| if increment < 0 { -magnitude } else { magnitude };
        let [backward, forward] = self.viscous;
        let viscous = if increment < 0 { backward } else { forward };
        let mut on_table = product(acceleration, self.table_mass).wrapping_add(product(velocity, viscous));
        // Fractions with 24 bits.
        let direction = if let Some(presliding) = &self.presliding {
            state.bristles = presliding.step(state.bristles, increment, level, second);
            let bristles = upper(state.bristles);
            on_table = on_table.wrapping_add(product(self.table_greatest, bristles >> 4));
            if at.friction == Fixed::ZERO { 0 } else { self.over_level_q24(bristles, second) }
        } else {
            on_table = on_table.wrapping_add(product(self.table_greatest, signed(level) >> 7));
            signed(second) >> 7
        };
        on_table = on_table.wrapping_add(product(at.friction.to_bits(), direction));
        state.on_table = Fixed::from_bits(narrow::<24>(on_table)) + at.load;
        let applied = product(state.on_table.to_bits(), self.share)
            .wrapping_add(product(acceleration, self.applied_motor_mass))
            .wrapping_add(product(self.applied_motor_greatest, signed(motor) >> 7));
        state.applied = Fixed::from_bits(narrow::<24>(applied));
    }

    /// The friction of the bristles (28 fraction bits) over g at the speed, limited to ±1: 24 fraction bits.
    fn over_level_q24(&self, bristles: i32, least_over_level_q31: i32) -> i32 {
        // F/g = F/greatest · greatest/least · least/g, with 27 + 16 fraction bits.
        let of_least = mul_high_i32(bristles, least_over_level_q31);
        let over_level = product(of_least, self.greatest_over_least_q16);
        narrow::<19>(over_level).clamp(-(1 << 24), 1 << 24)
    }
}

/// A product of 64 bits.
fn product(a: i32, b: i32) -> i64 {
    i64::from(a).wrapping_mul(i64::from(b))
}

/// The gains of the table's mass, of `share` times the motor's mass, and of `share`, for accelerations in `unit`.
fn mass_gains(model: &ForceModel, unit: f64) -> Result<[i32; 3], ConfigError> {
    let checked = |name, value| {
        // Half the range of a gain, so that no sum of products overflows.
        gain::<Fixed>(name, ranged(name, value, 0.0, f64::MAX)?, 2.0 * unit)
    };
    checked("force.table_mass_kg", model.table_mass_kg)?;
    checked("force.motor_mass_kg", model.motor_mass_kg)?;
    let share = ranged("force.share", model.share, 0.0, 1.0)?;
    let gains = [model.table_mass_kg * unit, share * model.motor_mass_kg * unit, share];
    Ok(gains.map(|value| Fixed::gain(value).to_bits()))
}

/// The friction of motor and table, for `units_per_m_s` position units per position tick.
fn frictions(model: &ForceModel, bound_n: f64, units_per_m_s: f64) -> Result<[Friction; 2], ConfigError> {
    let bound = |name, value| ranged(name, value, 0.0, bound_n);
    let motor_coulomb = bound("force.motor_coulomb_n", model.motor_coulomb_n)?;
    let table_coulomb = bound("force.friction.coulomb_n", model.friction.coulomb_n)?;
    let motor_stribeck = (model.motor_stribeck, stribeck_names!("force.motor_stribeck"));
    let table_stribeck = (model.friction.stribeck, stribeck_names!("force.friction.stribeck"));
    Ok([
        Friction::new(motor_coulomb, motor_stribeck, bound_n, units_per_m_s)?,
        Friction::new(table_coulomb, table_stribeck, bound_n, units_per_m_s)?,
    ])
}

/// The curves over the speed: see [`Force`]. `sign_width` is w in position units per position tick.
fn curves(motor: Friction, table: Friction, presliding: bool, sign_width: f64) -> SpeedCurves<3> {
    let widths = [motor.width(), table.width()];
    let greatest = widths.into_iter().flatten().fold(sign_width, f64::max);
    SpeedCurves::new(4.0 * greatest, |speed| {
        let sign = libm::tanh(speed / sign_width);
        let motor = motor.over_greatest(speed) * sign;
        if presliding {
            [table.over_greatest(speed), table.least_over_level(speed), motor]
        } else {
            [table.over_greatest(speed) * sign, sign, motor]
        }
    })
}

/// Additional friction of a cold machine, and what remains of it over the ticks of the velocity loop.
fn cold(warm_up: &FrictionWarmUp, tick_hz: f64, bound_n: f64) -> Result<(Fixed, OctaveCurve), ConfigError> {
    let force = ranged("force.friction.warm_up.force_n", warm_up.force_n, -bound_n, bound_n)?;
    let ticks = positive("force.friction.warm_up.time_constant_s", warm_up.time_constant_s)? * tick_hz;
    Ok((Fixed::signal(force), OctaveCurve::new(8.0 * ticks, |elapsed| libm::exp(-elapsed / ticks))))
}

#[cfg(test)]
mod tests;
