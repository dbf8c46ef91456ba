//! SI in, machine units out: settings are checked here, by name, and nowhere else.

use serde::{Deserialize, Serialize};

use crate::control::feedforward::Feedforward;
use crate::control::filter::Filter;
use crate::control::hpc::Hpc;
use crate::control::position::PositionControl;
use crate::control::velocity::VelocityControl;
use crate::feedback::dual::Feedback;
use crate::feedback::fade::Fade;
use crate::interpolate::Smoothing;
use crate::scalar::Scalar;
use crate::units::{INCREMENT_M, LENGTH_M, PER_M, Position, TRAVEL_LIMIT_M, VELOCITY_M_PER_S};
use crate::watch::{Frozen, Watch};

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

/// A notch on the force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Notch {
    /// Its middle.
    pub frequency_hz: f64,
    /// From −3 dB to −3 dB of a full notch.
    pub width_hz: f64,
    /// 1: nothing is left in the middle; 0.9: a tenth.
    pub depth: f64,
}

/// A second-order low-pass on the force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LowPass {
    /// ω₀/2π.
    pub frequency_hz: f64,
    /// ζ; 0.7 for the flattest.
    pub damping_ratio: f64,
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
    /// Takes a band out of the force.
    pub notch: Option<Notch>,
    /// Takes what is fast out of the force.
    pub low_pass: Option<LowPass>,
    /// Greatest force either way.
    pub force_limit_n: f64,
    /// Sensors of the position loop.
    pub sensors: Sensors,
    /// How the axis is accelerated behind the path.
    pub smoothing: Smoothing,
    /// Time constant with which a linear scale that was lost comes back.
    pub scale_fade_time_s: f64,
    /// Greatest distance between command and feedback before the drives go off.
    pub following_error_limit_m: f64,
    /// Greatest distance between motor and scale before the drives go off; `None`: not watched.
    pub scale_disagreement_limit_m: Option<f64>,
    /// Fastest that the motor can be: a reading that has moved further puts the drives off. `None`: not
    /// watched.
    pub fastest_m_per_s: Option<f64>,
    /// How far command and velocity loop may ask the motor to go while its reading stands before the drives go off, at
    /// most `following_error_limit_m`; `None`: not watched.
    pub frozen_encoder_limit_m: Option<f64>,
    /// How long the force may stand at its limit before the path stops, less a quarter of the time since that it did
    /// not.
    pub saturation_time_s: f64,
    /// Least and greatest command; beyond them the path stops. `None`: the travel of the number format.
    pub travel_m: Option<[f64; 2]>,
    /// Deceleration of a stop; a path stops with the least of its axes.
    pub stop_deceleration_m_per_s2: f64,
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
            notch: None,
            low_pass: None,
            force_limit_n: 10_000.0,
            sensors: Sensors::Motor,
            smoothing: Smoothing::None,
            scale_fade_time_s: 0.1,
            following_error_limit_m: 0.05,
            scale_disagreement_limit_m: None,
            fastest_m_per_s: None,
            frozen_encoder_limit_m: None,
            saturation_time_s: 1.0,
            travel_m: None,
            stop_deceleration_m_per_s2: 2.0,
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
    /// Cannot be changed once the machine has been made.
    NotWhileRunning(&'static str),
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
            Self::NotWhileRunning(name) => write!(f, "{name}: expected what the machine was made with"),
            Self::OutOfRange { name, least, most } => {
                write!(f, "{name}: expected a number from ")?;
                number(f, *least)?;
                f.write_str(" to ")?;
                number(f, *most)?;
                f.write_str(" in this number format")
            }
        }
    }
}

impl core::error::Error for ConfigError {}

/// Four digits of a number, with a power of ten only where it would be long.
fn number(f: &mut core::fmt::Formatter<'_>, value: f64) -> core::fmt::Result {
    if value == 0.0 || !value.is_finite() {
        return write!(f, "{value}");
    }
    if !(1e-3..1e7).contains(&libm::fabs(value)) {
        return write!(f, "{value:.3e}");
    }
    let place = libm::pow(10.0, 3.0 - libm::floor(libm::log10(libm::fabs(value))));
    write!(f, "{}", libm::round(value * place) / place)
}

/// Slowest velocity loop, Hz: far below any, and Kp·tick stays a number.
const LEAST_RATE_HZ: f64 = 1.0;

/// Fastest velocity loop, Hz.
const MOST_RATE_HZ: f64 = 1e6;

/// Least and greatest frequency of a filter of the force, of the tick rate.
const LEAST_FILTER: f64 = 1e-3;
/// See there.
const MOST_FILTER: f64 = 0.45;

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
    /// Filters of the force.
    pub notch: Option<Filter<S>>,
    /// Behind the notch.
    pub low_pass: Option<Filter<S>>,
    /// How much of an offset at a change of gains fades in a position tick.
    pub velocity_fades: S::Gain,
    /// The same in a tick.
    pub force_fades: S::Gain,
    /// What is watched.
    pub watch: Watch<S>,
    /// Of a stop, position units per position tick² with 16 fraction bits.
    pub stop_deceleration: u64,
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
        let gain_of_position = exact_gain::<S>("position_gain_per_s", kp, LENGTH_M / VELOCITY_M_PER_S)?;
        let percent = ranged("feedforward_percent", settings.feedforward_percent, 0.0, 200.0)?;
        let kv = positive("velocity_gain_n_s_per_m", settings.velocity_gain_n_s_per_m)?;
        let proportional = exact_gain::<S>("velocity_gain_n_s_per_m", kv, VELOCITY_M_PER_S)?;
        let integral = match settings.velocity_integral_time_s {
            Some(time) => {
                let name = "velocity_integral_time_s";
                gain_over_time::<S>(name, kv * tick / positive(name, time)? * VELOCITY_M_PER_S, time)?
            }
            None => S::gain(0.0),
        };
        let lag = ranged("velocity_lag_s", settings.velocity_lag_s, 0.0, tick * (1.0 + 1e-9))?;
        let limit = positive("force_limit_n", settings.force_limit_n)?;

        let fade = positive("scale_fade_time_s", settings.scale_fade_time_s)?;
        let fade = Fade::new(fade * position_rate);
        let feedback = match settings.sensors {
            Sensors::Motor => Feedback::Motor,
            Sensors::Table => Feedback::Table { fade },
            Sensors::Dual { time_constant_s } => {
                let time = positive("dual_feedback_time_constant_s", time_constant_s)?;
                let share = -libm::expm1(-1.0 / (position_rate * time));
                Feedback::Dual {
                    share: gain_over_time::<S>("dual_feedback_time_constant_s", share, time)?,
                    fade,
                }
            }
        };
        Ok(Self {
            feedback,
            feedforward: Feedforward {
                gain: gain::<S>(
                    "feedforward_percent",
                    percent,
                    position_rate / (100.0 * kp) * INCREMENT_M / LENGTH_M,
                )?,
            },
            position: PositionControl {
                gain: gain_of_position,
                hpc: matches!(settings.law, Law::Hpc).then(|| Hpc::new(kp / position_rate)),
            },
            velocity: VelocityControl {
                rate: gain::<S>(
                    "velocity_loop_hz",
                    rate * (1.0 - lag * rate),
                    INCREMENT_M / VELOCITY_M_PER_S,
                )?,
                rate_before: gain::<S>("velocity_lag_s", rate * lag * rate, INCREMENT_M / VELOCITY_M_PER_S)?,
                proportional,
                integral,
                integrates: settings.velocity_integral_time_s.is_some(),
                force_limit: S::signal(ranged("force_limit_n", limit, 0.0, S::SIGNAL_LIMIT)?),
            },
            notch: settings.notch.map(|notch| make_notch(&notch, rate)).transpose()?,
            low_pass: settings.low_pass.map(|low_pass| make_low_pass(&low_pass, rate)).transpose()?,
            velocity_fades: S::gain(-libm::expm1(-kp / position_rate)),
            force_fades: S::gain(-libm::expm1(-kp * tick)),
            watch: watch(settings, tick, divider / rate)?,
            stop_deceleration: per_tick(
                "stop_deceleration_m_per_s2",
                settings.stop_deceleration_m_per_s2 / (position_rate * position_rate),
            )?,
        })
    }
}

/// tan(πf/rate) of a filter's frequency.
fn warped(name: &'static str, frequency_hz: f64, rate_hz: f64) -> Result<f64, ConfigError> {
    let frequency = positive(name, frequency_hz)?;
    // Below, a₃ = (πf/rate)² has less than three digits in fixed point; above, little is left of the shape.
    let frequency = ranged(name, frequency, rate_hz * LEAST_FILTER, rate_hz * MOST_FILTER)?;
    Ok(libm::tan(core::f64::consts::PI * frequency / rate_hz))
}

fn make_notch<S: Scalar>(notch: &Notch, rate_hz: f64) -> Result<Filter<S>, ConfigError> {
    let g = warped("notch_frequency_hz", notch.frequency_hz, rate_hz)?;
    let width = positive("notch_width_hz", notch.width_hz)?;
    let width = ranged("notch_width_hz", width, 0.0, 4.0 * notch.frequency_hz)?;
    let depth = ranged("notch_depth", notch.depth, 0.0, 1.0)?;
    Ok(Filter::notch(g, width / notch.frequency_hz, depth))
}

fn make_low_pass<S: Scalar>(low_pass: &LowPass, rate_hz: f64) -> Result<Filter<S>, ConfigError> {
    let g = warped("low_pass_frequency_hz", low_pass.frequency_hz, rate_hz)?;
    let damping = ranged("low_pass_damping_ratio", low_pass.damping_ratio, 0.05, 10.0)?;
    Ok(Filter::low_pass(g, 2.0 * damping))
}

fn watch<S: Scalar>(settings: &AxisSettings, tick: f64, position_tick: f64) -> Result<Watch<S>, ConfigError> {
    let signal = |name, value: f64, unit: f64| {
        let value = positive(name, value)?;
        Ok(S::signal(ranged(name, value, 0.0, S::SIGNAL_LIMIT * unit)? / unit))
    };
    let ticks = positive("saturation_time_s", settings.saturation_time_s)? / tick;
    let place = |name, m| Position::from_m(finite(name, m)?).ok_or(out_of_travel(name));
    let distance = |name, m: Option<f64>, most_m| match m {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 100 m")]
        Some(m) => Ok(Some((ranged(name, m, 0.0, most_m)? * PER_M) as u64)),
        None => Ok(None),
    };
    let most_frozen_m = settings.following_error_limit_m.min(TRAVEL_LIMIT_M);
    Ok(Watch {
        following_error: signal("following_error_limit_m", settings.following_error_limit_m, LENGTH_M)?,
        disagreement: distance(
            "scale_disagreement_limit_m",
            settings.scale_disagreement_limit_m,
            TRAVEL_LIMIT_M,
        )?,
        frozen: distance("frozen_encoder_limit_m", settings.frozen_encoder_limit_m, most_frozen_m)?.map(
            |limit| {
                let asked = S::signal(limit as f64 / PER_M / LENGTH_M).widen();
                let per_tick = S::gain(VELOCITY_M_PER_S / LENGTH_M * position_tick);
                Frozen { limit, asked: [S::ZERO_SUM - asked, asked], per_tick }
            },
        ),
        encoder_step: match settings.fastest_m_per_s {
            Some(m_per_s) => Some(signal("fastest_m_per_s", m_per_s, INCREMENT_M / tick)?),
            None => None,
        },
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        saturated_ticks: (ticks as u32).min(u32::MAX / 4 - 1),
        travel: match settings.travel_m {
            Some([least, greatest]) => {
                let [least, greatest] = [place("travel_m", least)?, place("travel_m", greatest)?];
                if least >= greatest {
                    return Err(ConfigError::NotPositive("travel_m"));
                }
                [least, greatest]
            }
            None => [place("travel_m", -TRAVEL_LIMIT_M)?, place("travel_m", TRAVEL_LIMIT_M)?],
        },
    })
}

fn out_of_travel(name: &'static str) -> ConfigError {
    ConfigError::OutOfRange { name, least: -TRAVEL_LIMIT_M, most: TRAVEL_LIMIT_M }
}

/// Metres per tick (or tick²) in position units with 16 fraction bits.
fn per_tick(name: &'static str, value: f64) -> Result<u64, ConfigError> {
    let units = positive(name, value)? * PER_M * 65_536.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    Ok((units as u64).max(1))
}

pub(crate) fn finite(name: &'static str, value: f64) -> Result<f64, ConfigError> {
    if value.is_finite() { Ok(value) } else { Err(ConfigError::NotFinite(name)) }
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, ConfigError> {
    if finite(name, value)? > 0.0 { Ok(value) } else { Err(ConfigError::NotPositive(name)) }
}

pub(crate) fn ranged(name: &'static str, value: f64, least: f64, most: f64) -> Result<f64, ConfigError> {
    if (least..=most).contains(&finite(name, value)?) {
        Ok(value)
    } else {
        Err(ConfigError::OutOfRange { name, least, most })
    }
}

/// `si·unit` as a gain, refused with the range in SI where the format does not hold it.
pub(crate) fn gain<S: Scalar>(name: &'static str, si: f64, unit: f64) -> Result<S::Gain, ConfigError> {
    let most = S::GAIN_LIMIT / unit;
    if finite(name, si)?.abs() < most {
        Ok(S::gain(si * unit))
    } else {
        Err(ConfigError::OutOfRange { name, least: 0.0, most })
    }
}

/// Steps of the format that a gain has to hold: it is then met to 1 %.
const GAIN_STEPS: f64 = 50.0;

/// `si·unit` as a gain above zero that the format holds to 1 %, refused with the range in SI.
fn exact_gain<S: Scalar>(name: &'static str, si: f64, unit: f64) -> Result<S::Gain, ConfigError> {
    let least = GAIN_STEPS * S::GAIN_STEP / unit;
    match gain::<S>(name, si, unit) {
        Ok(gain) if si >= least => Ok(gain),
        Ok(_) | Err(ConfigError::OutOfRange { .. }) => {
            Err(ConfigError::OutOfRange { name, least, most: S::GAIN_LIMIT / unit })
        }
        Err(error) => Err(error),
    }
}

/// A gain that falls as one over a time, held to 1 %, refused with the range of the time.
fn gain_over_time<S: Scalar>(name: &'static str, value: f64, time_s: f64) -> Result<S::Gain, ConfigError> {
    let time_at = |gain: f64| time_s * value / gain;
    exact_gain::<S>(name, value, 1.0).map_err(|error| match error {
        ConfigError::OutOfRange { name, least, most } => {
            ConfigError::OutOfRange { name, least: time_at(most), most: time_at(least) }
        }
        other => other,
    })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::string::ToString;

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
    fn refuses_what_rounds_away_in_fixed_point_with_the_range_of_the_setting() {
        let slow = refusal(|s| s.velocity_integral_time_s = Some(1e6));
        let ConfigError::OutOfRange { name: "velocity_integral_time_s", least, most } = slow else {
            panic!("{slow:?}");
        };
        let mut settings =
            AxisSettings { velocity_integral_time_s: Some(most * 0.999), ..AxisSettings::default() };
        assert!(AxisConfig::<Fixed>::new(&settings, RATES).is_ok());
        settings.velocity_integral_time_s = Some(least * 1.001);
        assert!(AxisConfig::<Fixed>::new(&settings, RATES).is_ok());
        settings.velocity_integral_time_s = Some(least * 0.999);
        assert!(AxisConfig::<Fixed>::new(&settings, RATES).is_err());
        settings.velocity_integral_time_s = Some(1e6);
        assert!(AxisConfig::<f32>::new(&settings, RATES).is_ok());

        let slow = refusal(|s| s.sensors = Sensors::Dual { time_constant_s: 1e4 });
        // 1/(rate·T) of 50·2⁻²⁴ at 20 kHz.
        assert!(matches!(slow, ConfigError::OutOfRange { name: "dual_feedback_time_constant_s", most, .. }
            if (16.7..16.8).contains(&most)));
    }

    #[test]
    fn says_a_range_in_few_digits() {
        let said = |least, most| {
            let error = ConfigError::OutOfRange { name: "a", least, most };
            error.to_string()
        };
        assert_eq!(said(0.0, 2048.0), "a: expected a number from 0 to 2048 in this number format");
        assert_eq!(
            said(-0.123_456, 7_812_499.9),
            "a: expected a number from -0.1235 to 7812000 in this number format"
        );
        assert_eq!(
            said(4.768_37e-5, 1e18),
            "a: expected a number from 4.768e-5 to 1.000e18 in this number format"
        );
    }

    #[test]
    fn refuses_a_rate_of_zero() {
        let rates = Rates { velocity_loop_hz: 0.0, ..RATES };
        let error = AxisConfig::<f64>::new(&AxisSettings::default(), rates).unwrap_err();
        assert_eq!(error, ConfigError::NotPositive("velocity_loop_hz"));
    }
}
