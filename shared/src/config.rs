//! SI in, machine units out: settings are checked here, by name, and nowhere else.

use serde::{Deserialize, Serialize};

use crate::control::feedforward::Feedforward;
use crate::control::hpc::Hpc;
use crate::control::position::PositionControl;
use crate::control::velocity::VelocityControl;
use crate::feedback::dual::Feedback;
use crate::feedback::fade::Fade;
use crate::scalar::Scalar;
use crate::units::{INCREMENT_M, LENGTH_M, PER_M, VELOCITY_M_PER_S};

/// How often the loops run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rates {
    /// Velocity loop, and the tick of the machine.
    pub velocity_loop_hz: f64,
    /// Ticks from one command and position loop to the next, at least 1.
    pub position_loop_divider: u32,
}

impl Rates {
    /// Commands and position loops a second.
    #[must_use]
    pub fn position_loop_hz(&self) -> f64 {
        self.velocity_loop_hz / f64::from(self.position_loop_divider)
    }
}

/// Law of the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// Proportional.
    P,
    /// High-order position control.
    Hpc,
}

/// Sensors of the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Sensors {
    /// Motor encoder.
    Motor,
    /// Linear scale.
    Table,
    /// Both, crossing over at the time constant (s).
    Dual {
        /// T.
        time_constant_s: f64,
    },
}

/// One axis in SI, as a person or a file gives it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisSettings {
    /// Law of the position loop.
    pub law: Law,
    /// Kp.
    pub position_gain_per_s: f64,
    /// Kf, 0 to 200.
    pub feedforward_percent: f64,
    /// Kv.
    pub velocity_gain_n_s_per_m: f64,
    /// Ti; `None`: no integral part.
    pub velocity_integral_time_s: Option<f64>,
    /// How much later than a plain difference the velocity reading is; at most one tick.
    pub velocity_lag_s: f64,
    /// Greatest force either way.
    pub force_limit_n: f64,
    /// Sensors of the position loop.
    pub sensors: Sensors,
    /// Time constant with which a linear scale that was lost comes back.
    pub scale_fade_time_s: f64,
    /// Greatest distance between command and feedback before the drives go off.
    pub following_error_limit_m: f64,
}

impl Default for AxisSettings {
    /// A P axis on its motor encoder, gains of a mid-sized machining centre.
    fn default() -> Self {
        Self {
            law: Law::P,
            position_gain_per_s: 33.0,
            feedforward_percent: 0.0,
            velocity_gain_n_s_per_m: 50_000.0,
            velocity_integral_time_s: Some(0.02),
            velocity_lag_s: 0.0,
            force_limit_n: 10_000.0,
            sensors: Sensors::Motor,
            scale_fade_time_s: 0.1,
            following_error_limit_m: 0.05,
        }
    }
}

/// Why settings were refused, with the name of the setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConfigError {
    /// Not a finite number.
    NotFinite(&'static str),
    /// Must be above zero.
    NotPositive(&'static str),
    /// Must lie in a range.
    OutOfRange {
        /// Setting.
        name: &'static str,
        /// Least value.
        least: f64,
        /// Greatest value.
        most: f64,
    },
}

impl core::fmt::Display for ConfigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotFinite(name) => write!(f, "{name}: expected a finite number"),
            Self::NotPositive(name) => write!(f, "{name}: expected a number above 0"),
            Self::OutOfRange { name, least, most } => {
                write!(f, "{name}: expected a number from {least:.4e} to {most:.4e} in this number format")
            }
        }
    }
}

impl core::error::Error for ConfigError {}

/// Slowest velocity loop, Hz: far below any, and Kp·tick stays a number.
const LEAST_RATE_HZ: f64 = 1.0;

/// Fastest velocity loop, Hz.
const MOST_RATE_HZ: f64 = 1e6;

/// One axis in machine units: what a tick computes with.
#[derive(Clone, Copy, Debug)]
pub struct AxisConfig<S: Scalar> {
    /// Sensors of the position loop.
    pub feedback: Feedback<S>,
    /// Velocity feed-forward.
    pub feedforward: Feedforward<S>,
    /// Position loop.
    pub position: PositionControl<S>,
    /// Velocity loop.
    pub velocity: VelocityControl<S>,
    /// Position units.
    pub following_error_limit: u64,
}

impl<S: Scalar> AxisConfig<S> {
    /// Converts settings.
    ///
    /// # Errors
    /// The [`ConfigError`] that names the first setting which is not finite, has the wrong sign, or
    /// does not fit the number format `S`.
    pub fn new(settings: &AxisSettings, rates: Rates) -> Result<Self, ConfigError> {
        let rate = positive("velocity_loop_hz", rates.velocity_loop_hz)?;
        let rate = ranged("velocity_loop_hz", rate, LEAST_RATE_HZ, MOST_RATE_HZ)?;
        let divider = positive("position_loop_divider", f64::from(rates.position_loop_divider))?;
        let (tick, position_rate) = (1.0 / rate, rate / divider);

        let kp = positive("position_gain_per_s", settings.position_gain_per_s)?;
        let kf = ranged("feedforward_percent", settings.feedforward_percent, 0.0, 200.0)? / 100.0;
        let kv = positive("velocity_gain_n_s_per_m", settings.velocity_gain_n_s_per_m)?;
        let ki = match settings.velocity_integral_time_s {
            Some(time) => kv * tick / positive("velocity_integral_time_s", time)?,
            None => 0.0,
        };
        let lag = ranged("velocity_lag_s", settings.velocity_lag_s, 0.0, tick * (1.0 + 1e-9))?;
        let limit = positive("force_limit_n", settings.force_limit_n)?;
        let following = positive("following_error_limit_m", settings.following_error_limit_m)?;
        let following = ranged("following_error_limit_m", following, 0.0, 100.0)?;

        let fade = positive("scale_fade_time_s", settings.scale_fade_time_s)?;
        let fade = Fade::new(fade * position_rate);
        let feedback = match settings.sensors {
            Sensors::Motor => Feedback::Motor,
            Sensors::Table => Feedback::Table { fade },
            Sensors::Dual { time_constant_s } => {
                let time = positive("dual_feedback_time_constant_s", time_constant_s)?;
                let share = -libm::expm1(-1.0 / (position_rate * time));
                Feedback::Dual { share: gain::<S>("dual_feedback_time_constant_s", share, 1.0)?, fade }
            }
        };
        let kp_unit = LENGTH_M / VELOCITY_M_PER_S;
        Ok(Self {
            feedback,
            feedforward: Feedforward {
                gain: gain::<S>("feedforward_percent", kf / kp * position_rate, INCREMENT_M / LENGTH_M)?,
            },
            position: PositionControl {
                gain: gain::<S>("position_gain_per_s", kp, kp_unit)?,
                hpc: matches!(settings.law, Law::Hpc).then(|| Hpc::new(kp / position_rate)),
            },
            velocity: VelocityControl {
                rate: gain::<S>("velocity_loop_hz", rate, INCREMENT_M / VELOCITY_M_PER_S)?,
                lag: gain::<S>("velocity_lag_s", lag * rate, 1.0)?,
                proportional: gain::<S>("velocity_gain_n_s_per_m", kv, VELOCITY_M_PER_S)?,
                integral: gain::<S>("velocity_integral_time_s", ki, VELOCITY_M_PER_S)?,
                force_limit: S::signal(ranged("force_limit_n", limit, 0.0, S::SIGNAL_LIMIT)?),
            },
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 < limit ≤ 100 m")]
            following_error_limit: (following * PER_M) as u64,
        })
    }
}

fn finite(name: &'static str, value: f64) -> Result<f64, ConfigError> {
    if value.is_finite() { Ok(value) } else { Err(ConfigError::NotFinite(name)) }
}

fn positive(name: &'static str, value: f64) -> Result<f64, ConfigError> {
    if finite(name, value)? > 0.0 { Ok(value) } else { Err(ConfigError::NotPositive(name)) }
}

fn ranged(name: &'static str, value: f64, least: f64, most: f64) -> Result<f64, ConfigError> {
    if (least..=most).contains(&finite(name, value)?) {
        Ok(value)
    } else {
        Err(ConfigError::OutOfRange { name, least, most })
    }
}

/// `si·unit` as a gain, refused with the range in SI where the format does not hold it.
fn gain<S: Scalar>(name: &'static str, si: f64, unit: f64) -> Result<S::Gain, ConfigError> {
    let most = S::GAIN_LIMIT / unit;
    if finite(name, si)?.abs() < most {
        Ok(S::gain(si * unit))
    } else {
        Err(ConfigError::OutOfRange { name, least: 0.0, most })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;

    const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };

    fn refusal(change: impl Fn(&mut AxisSettings)) -> ConfigError {
        let mut settings = AxisSettings::default();
        change(&mut settings);
        AxisConfig::<Fixed>::new(&settings, RATES).unwrap_err()
    }

    #[test]
    fn names_what_it_refuses() {
        assert_eq!(refusal(|s| s.position_gain_per_s = 0.0), ConfigError::NotPositive("position_gain_per_s"));
        assert_eq!(
            refusal(|s| s.position_gain_per_s = f64::NAN),
            ConfigError::NotFinite("position_gain_per_s")
        );
        assert_eq!(
            refusal(|s| s.velocity_integral_time_s = Some(-1.0)),
            ConfigError::NotPositive("velocity_integral_time_s")
        );
        assert_eq!(refusal(|s| s.scale_fade_time_s = 0.0), ConfigError::NotPositive("scale_fade_time_s"));
        assert_eq!(
            refusal(|s| s.force_limit_n = 1e6),
            ConfigError::OutOfRange { name: "force_limit_n", least: 0.0, most: 131_072.0 }
        );
        assert!(matches!(refusal(|s| s.velocity_gain_n_s_per_m = 1e7),
            ConfigError::OutOfRange { name: "velocity_gain_n_s_per_m", most, .. } if (7.8e6..7.82e6).contains(&most)));
    }

    #[test]
    fn refuses_a_rate_of_zero() {
        let rates = Rates { velocity_loop_hz: 0.0, ..RATES };
        let error = AxisConfig::<f64>::new(&AxisSettings::default(), rates).unwrap_err();
        assert_eq!(error, ConfigError::NotPositive("velocity_loop_hz"));
    }
}
