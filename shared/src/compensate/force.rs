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

use super::force_settings::{ForceModel, FrictionWarmUp, TableFriction};
use super::friction_level::{Friction, Level};
use super::motion::CommandMotion;
use super::octave_curve::OctaveCurve;
use super::presliding::{ONE, Presliding};
use crate::config::ConfigError;
use crate::config::check::{gain, positive, ranged};
use crate::integer::{mul_q32, mul_shift};
use crate::scalar::Scalar;
use crate::units::{INCREMENT_M, PER_M, Position};

/// w of the smoothed sign of the velocity, tanh(v/w), m/s, as in the declared model of the machine.
const SIGN_WIDTH_M_PER_S: f64 = 0.2e-3;

/// Acceleration that a signal has to hold, m/s².
const MAX_ACCELERATION_M_PER_S2: f64 = 200.0;

/// Greatest lag, s.
const MAX_LAG_S: f64 = 1.0;

/// Constants of the feed-forward.
#[derive(Clone, Copy, Debug)]
pub struct Force<S: Scalar> {
    /// Fraction of the distance to the command that the filtered position makes up per position tick.
    lag_q32: u32,
    /// Lag in position ticks, 16 fraction bits.
    lag_ticks_q16: i64,
    /// Accelerations are shifted left by this before they become an increment signal, for resolution.
    acceleration_shift: u32,
    motor_mass: S::Gain,
    table_mass: S::Gain,
    viscous: S::Gain,
    half_difference: S::Gain,
    /// tanh(v/w) of a speed in position units per position tick.
    sign: OctaveCurve,
    motor_friction: Level<S>,
    table_friction: Level<S>,
    presliding: Option<Presliding>,
    /// The greatest g over the least, 16 fraction bits.
    greatest_over_least_q16: i64,
    warm_up: Option<(S, OctaveCurve)>,
    share: S::Gain,
}

/// State of the feed-forward.
#[derive(Clone, Copy, Debug)]
pub struct State<S: Scalar> {
    /// Filtered command.
    position: Position,
    /// Its last change, position units.
    increment: i64,
    /// Friction of the bristles, a fraction of the greatest g with 31 fraction bits.
    bristles: i64,
    /// Force to apply, N.
    pub applied: S,
    /// Force on the table, N.
    pub on_table: S,
}

/// What the force depends on besides the motion.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<S> {
    /// Load at the position, N.
    pub load: S,
    /// Additional friction at the position and time, N.
    pub friction: S,
}

impl<S: Scalar> State<S> {
    /// At rest at zero, without force.
    pub const NEW: Self =
        Self { position: Position(0), increment: 0, bristles: 0, applied: S::ZERO, on_table: S::ZERO };

    /// At rest at a position, without force.
    pub fn rest_at(&mut self, position: Position) {
        *self = Self { position, ..Self::NEW };
    }

    /// Continues from a shifted origin.
    pub fn shift(&mut self, command: i64) {
        self.position += command;
    }
}

impl<S: Scalar> Force<S> {
    /// Checks and converts settings, for a command every 1/`rate_hz` and a velocity loop at `tick_hz`.
    ///
    /// # Errors
    /// [`ConfigError`] with the name of the setting.
    pub fn new(model: &ForceModel, [rate_hz, tick_hz]: [f64; 2], bound_n: f64) -> Result<Self, ConfigError> {
        let not_negative = |name, value| ranged(name, value, 0.0, f64::MAX);
        let TableFriction { viscous_n_s_per_m, half_difference_n_s_per_m, warm_up, .. } = model.friction;
        let lag_ticks = ranged("force_lag_s", model.lag_s, 0.0, MAX_LAG_S)? * rate_hz;
        let unit = INCREMENT_M * rate_hz * rate_hz;
        let shift =
            libm::floor(libm::log2(S::SIGNAL_LIMIT.min(131_072.0) * unit / MAX_ACCELERATION_M_PER_S2));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 10")]
        let acceleration_shift = shift.clamp(0.0, 10.0) as u32;
        let unit = unit / libm::exp2(f64::from(acceleration_shift));
        let units_per_m_s = PER_M / rate_hz;
        let width = SIGN_WIDTH_M_PER_S * units_per_m_s;
        let bound = |name, value| ranged(name, value, 0.0, bound_n);
        let motor_coulomb = bound("motor_coulomb_n", model.motor_coulomb_n)?;
        let table_coulomb = bound("coulomb_n", model.friction.coulomb_n)?;
        let [motor, table] =
            [(motor_coulomb, model.motor_stribeck), (table_coulomb, model.friction.stribeck)]
                .map(|(coulomb_n, stribeck)| Friction::new(coulomb_n, stribeck, bound_n, units_per_m_s));
        let (motor, table) = (motor?, table?);
        let stiffness = model.friction.presliding_stiffness_n_per_m;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates below 1")]
        let lag_q32 = (libm::exp2(32.0) / (1.0 + lag_ticks)) as u32;
        #[expect(clippy::cast_possible_truncation, reason = "at most 10⁶ ticks, a ratio below 2³⁰")]
        let (lag_ticks_q16, greatest_over_least_q16) = (
            libm::rint(lag_ticks * 65_536.0) as i64,
            libm::rint(table.greatest_over_least() * 65_536.0) as i64,
        );
        Ok(Self {
            lag_q32,
            lag_ticks_q16,
            acceleration_shift,
            motor_mass: gain::<S>(
                "motor_mass_kg",
                not_negative("motor_mass_kg", model.motor_mass_kg)?,
                unit,
            )?,
            table_mass: gain::<S>(
                "table_mass_kg",
                not_negative("table_mass_kg", model.table_mass_kg)?,
                unit,
            )?,
            viscous: gain::<S>(
                "viscous_n_s_per_m",
                not_negative("viscous_n_s_per_m", viscous_n_s_per_m)?,
                INCREMENT_M * rate_hz,
            )?,
            half_difference: gain::<S>(
                "half_difference_n_s_per_m",
                half_difference_n_s_per_m,
                INCREMENT_M * rate_hz,
            )?,
            sign: OctaveCurve::new(4.0 * width, |speed| libm::tanh(speed / width)),
            motor_friction: motor.level(),
            table_friction: table.level(),
            presliding: stiffness.map(|stiffness| table.presliding(stiffness)).transpose()?,
            greatest_over_least_q16,
            warm_up: warm_up.map(|warm_up| cold(&warm_up, tick_hz, bound_n)).transpose()?,
            share: gain::<S>("force_share", ranged("force_share", model.share, 0.0, 1.0)?, 1.0)?,
        })
    }

    /// Sets the state to a motion that has been steady, keeping the friction of the bristles if there is one.
    pub fn start(&self, state: &mut State<S>, motion: &CommandMotion<S>) {
        let increment = motion.increment_units;
        // A ramp lags by (1 − f)/f ticks with the fraction f = 1/(1 + lag).
        state.position = motion.position - mul_shift::<16>(increment, self.lag_ticks_q16);
        state.increment = increment;
        if state.bristles == 0 {
            state.bristles = self.level_q31(increment.unsigned_abs()) * increment.signum();
        }
    }

    /// Whether there is additional friction of a cold machine.
    #[must_use]
    pub const fn warms_up(&self) -> bool {
        self.warm_up.is_some()
    }

    /// Additional friction of a cold machine after a number of ticks of the velocity loop, N.
    #[must_use]
    pub fn cold_friction(&self, ticks: u64) -> S {
        self.warm_up.as_ref().map_or(S::ZERO, |(force, remaining)| S::ZERO.lerp(*force, remaining.at(ticks)))
    }

    /// The forces of the next command, once per position tick.
    pub fn update(&self, state: &mut State<S>, command: Position, at: Surroundings<S>) {
        let increment = mul_q32(command - state.position, self.lag_q32);
        let acceleration = increment.wrapping_sub(state.increment) << self.acceleration_shift;
        (state.position, state.increment) = (state.position + increment, increment);
        let acceleration = S::from_increment(acceleration);
        let velocity = S::from_increment(increment);
        let speed = increment.unsigned_abs();
        let magnitude = if increment < 0 { -velocity } else { velocity };
        let sign = i64::from(self.sign.at(speed) >> 1) * increment.signum();
        state.on_table = S::round(acceleration * self.table_mass)
            + S::round(velocity * self.viscous)
            + S::round(magnitude * self.half_difference)
            + self.table_friction(state, sign, at.friction)
            + at.load;
        let motor_fraction = mul_q32(sign, self.motor_friction.fraction_q32(speed));
        let on_motor =
            S::round(acceleration * self.motor_mass) + scaled(self.motor_friction.greatest, motor_fraction);
        state.applied = S::round((state.on_table + on_motor) * self.share);
    }

    /// Friction of the table with the `additional` friction at this position and time, N. `sign` is tanh(v/w) with 31
    /// fraction bits.
    fn table_friction(&self, state: &mut State<S>, sign: i64, additional: S) -> S {
        let speed = state.increment.unsigned_abs();
        let Some(presliding) = &self.presliding else {
            let fraction = mul_q32(sign, self.table_friction.fraction_q32(speed));
            return scaled(self.table_friction.greatest, fraction) + scaled(additional, sign);
        };
        let least_over_level = presliding.least_over_level(speed);
        let level = self.level_q31(speed);
        state.bristles = presliding.step(state.bristles, state.increment, level, least_over_level);
        let friction = scaled(self.table_friction.greatest, state.bristles);
        if additional == S::ZERO {
            return friction;
        }
        // The fraction of g at this speed: F/g = F/greatest · greatest/least · least/g.
        let of_least = mul_q32(state.bristles, least_over_level);
        let direction = ((of_least * self.greatest_over_least_q16) >> 16).clamp(-ONE, ONE);
        friction + scaled(additional, direction)
    }

    /// g of the table at a speed as a fraction of the greatest, 31 fraction bits.
    fn level_q31(&self, speed: u64) -> i64 {
        i64::from(self.table_friction.fraction_q32(speed) >> 1)
    }
}

/// Additional friction of a cold machine, and what remains of it over the ticks of the velocity loop.
fn cold<S: Scalar>(
    warm_up: &FrictionWarmUp,
    tick_hz: f64,
    bound_n: f64,
) -> Result<(S, OctaveCurve), ConfigError> {
    let force = ranged("warm_up_force_n", warm_up.force_n, -bound_n, bound_n)?;
    let ticks = positive("warm_up_time_constant_s", warm_up.time_constant_s)? * tick_hz;
    Ok((S::signal(force), OctaveCurve::new(8.0 * ticks, |elapsed| libm::exp(-elapsed / ticks))))
}

/// `value` times a fraction from −1 to 1 with 31 fraction bits.
fn scaled<S: Scalar>(value: S, fraction_q31: i64) -> S {
    let from_minus_one = u32::try_from(fraction_q31 + ONE).unwrap_or(u32::MAX);
    (-value).lerp(value, from_minus_one)
}
