//! The constants of an axis in machine units.

use super::check::{finite, gain, gain_over_time, positive, ranged, resolved_gain};
use super::error::ConfigError;
use super::schedule::schedule;
use super::settings::{
    AxisSettings, Brake, Law, LowPass, NOTCHES, Notch, Notches, Rates, ScaleLimits, Sensors, VelocitySource,
};
use crate::control::feedforward::Feedforward;
use crate::control::filter::Filter;
use crate::control::gain_schedule::Schedule;
use crate::control::hpc::Hpc;
use crate::control::observer::{self, Observer};
use crate::control::position::PositionControl;
use crate::control::velocity::VelocityControl;
use crate::feedback::dual::Feedback;
use crate::feedback::exponential_decay::ExponentialDecay;
use crate::monitor::{Apart, Band, FrozenEncoder, Monitor};
use crate::scalar::Scalar;
use crate::units::{INCREMENT_M, LENGTH_M, PER_M, Position, TRAVEL_LIMIT_M, VELOCITY_M_PER_S};

/// Lowest rate of the velocity loop, Hz. Far below any real one, it keeps Kp·tick finite.
const MIN_RATE_HZ: f64 = 1.0;

/// Highest rate of the velocity loop, Hz.
const MAX_RATE_HZ: f64 = 1e6;

/// Lowest frequency of a filter over the tick rate: below it, a₃ = (πf/rate)² has fewer than three digits in fixed
/// point.
const MIN_FILTER_RATIO: f64 = 1e-3;

/// Highest frequency of a filter over the tick rate: above it, the bilinear transform distorts the shape of the filter.
const MAX_FILTER_RATIO: f64 = 0.45;

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
    /// Notch filters of the force, in the order in which they act; the first `None` ends them.
    pub notches: [Option<Filter<S>>; NOTCHES],
    /// Low-pass filter of the force, after the notches.
    pub low_pass: Option<Filter<S>>,
    /// Fraction of the bumpless-transfer offset of the velocity command that decays per position tick.
    pub velocity_transfer_decay: S::Gain,
    /// Fraction of the bumpless-transfer offset of the force that decays per tick.
    pub force_transfer_decay: S::Gain,
    /// Limits that are monitored.
    pub monitor: Monitor<S>,
    /// Deceleration of a stop, position units per position tick² with 16 fraction bits.
    pub stop_deceleration: u64,
    /// Times of the holding brake.
    pub brake: Option<BrakeTicks>,
    /// Force with which the drive comes on.
    pub preload: Option<S>,
}

/// The times of a holding brake in whole ticks, not shorter than declared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BrakeTicks {
    /// From the output until the brake is open.
    pub release: u32,
    /// From the output until the brake holds.
    pub engage: u32,
}

/// Longest time of the feed-forward ahead of the command, position ticks.
const MAX_AHEAD: f64 = 8.0;

/// Rates of the loops, checked.
struct LoopRates {
    /// Velocity loop, Hz.
    rate: f64,
    /// Position loop, Hz.
    position_rate: f64,
    /// Period of the velocity loop, s.
    tick: f64,
    /// Period of the position loop, s.
    position_tick: f64,
}

impl LoopRates {
    fn new(rates: Rates) -> Result<Self, ConfigError> {
        let rate = positive("velocity_loop_hz", rates.velocity_loop_hz)?;
        let rate = ranged("velocity_loop_hz", rate, MIN_RATE_HZ, MAX_RATE_HZ)?;
        let divider = positive("position_loop_divider", f64::from(rates.position_loop_divider))?;
        Ok(Self { rate, position_rate: rate / divider, tick: 1.0 / rate, position_tick: divider / rate })
    }
}

impl<S: Scalar> AxisConfig<S> {
    /// Checks and converts the changes of the gains of [`velocity`](AxisConfig::velocity); `None`: they are constant. Apart from the
    /// other constants, which are near each other for the ticks.
    ///
    /// # Errors
    /// [`ConfigError`], as [`AxisConfig::new`] has for these settings.
    pub fn schedule(settings: &AxisSettings, rates: Rates) -> Result<Option<Schedule<S>>, ConfigError> {
        schedule(settings, &velocity_control(settings, &LoopRates::new(rates)?)?, rates)
    }

    /// Checks and converts settings.
    ///
    /// # Errors
    /// [`ConfigError`] for the first setting that is not finite, has the wrong sign, or exceeds the range of the number
    /// format `S`.
    pub fn new(settings: &AxisSettings, rates: Rates) -> Result<Self, ConfigError> {
        let declared = rates;
        let rates = LoopRates::new(rates)?;
        let kp = positive("position_gain_per_s", settings.position_gain_per_s)?;
        let position_gain = resolved_gain::<S>("position_gain_per_s", kp, LENGTH_M / VELOCITY_M_PER_S)?;
        let feedforward = feedforward(settings, kp, &rates)?;
        let velocity = velocity_control(settings, &rates)?;
        schedule(settings, &velocity, declared)?;
        let feedback = feedback(settings, &rates)?;
        let deceleration = settings.stop_deceleration_m_per_s2 / (rates.position_rate * rates.position_rate);
        Ok(Self {
            feedback,
            feedforward,
            position: PositionControl {
                gain: position_gain,
                hpc: matches!(settings.law, Law::Hpc).then(|| Hpc::new(kp / rates.position_rate)),
            },
            velocity,
            notches: notch_filters(&settings.notches, rates.rate)?,
            low_pass: settings.low_pass.map(|low_pass| low_pass_filter(&low_pass, rates.rate)).transpose()?,
            velocity_transfer_decay: S::gain(-libm::expm1(-kp / rates.position_rate)),
            force_transfer_decay: S::gain(-libm::expm1(-kp * rates.tick)),
            monitor: monitor(settings, &rates)?,
            stop_deceleration: per_tick("stop_deceleration_m_per_s2", deceleration)?,
            brake: settings.brake.map(|brake| brake_ticks(&brake, rates.rate)).transpose()?,
            preload: settings.preload_n.map(|n| preload(n, settings.force_limit_n)).transpose()?,
        })
    }
}

/// The feed-forward for a position gain kp.
fn feedforward<S: Scalar>(
    settings: &AxisSettings,
    kp: f64,
    rates: &LoopRates,
) -> Result<Feedforward<S>, ConfigError> {
    let percent = ranged("feedforward_percent", settings.feedforward_percent, 0.0, 200.0)?;
    let unit = rates.position_rate / (100.0 * kp) * INCREMENT_M / LENGTH_M;
    gain::<S>("feedforward_percent", percent, unit)?;
    let lead = percent * unit;
    // The sum of the two terms is a gain.
    let longest = MAX_AHEAD.min(0.999 * S::GAIN_LIMIT / lead - 1.0) * rates.position_tick;
    let ahead = ranged("feedforward_ahead_s", settings.feedforward_ahead_s, 0.0, longest.max(0.0))?;
    let previous = lead * ahead * rates.position_rate;
    Ok(Feedforward {
        present: S::gain(lead + previous),
        previous: (previous > 0.0).then(|| S::gain(previous)),
    })
}

fn velocity_control<S: Scalar>(
    settings: &AxisSettings,
    rates: &LoopRates,
) -> Result<VelocityControl<S>, ConfigError> {
    let &LoopRates { rate, tick, .. } = rates;
    let kv = positive("velocity_gain_n_s_per_m", settings.velocity_gain_n_s_per_m)?;
    let proportional = resolved_gain::<S>("velocity_gain_n_s_per_m", kv, VELOCITY_M_PER_S)?;
    let integral = match settings.velocity_integral_time_s {
        Some(time) => {
            let name = "velocity_integral_time_s";
            gain_over_time::<S>(name, kv * tick / positive(name, time)? * VELOCITY_M_PER_S, time)?
        }
        None => S::gain(0.0),
    };
    let lag = ranged("velocity_lag_s", settings.velocity_lag_s, -tick * (1.0 + 1e-9), tick * (1.0 + 1e-9))?;
    let limit = positive("force_limit_n", settings.force_limit_n)?;
    let unit = INCREMENT_M / VELOCITY_M_PER_S;
    Ok(VelocityControl {
        rate: gain::<S>("velocity_loop_hz", rate * (1.0 - lag * rate), unit)?,
        previous_rate: gain::<S>("velocity_lag_s", rate * lag * rate, unit)?,
        proportional,
        integral,
        has_integral: settings.velocity_integral_time_s.is_some(),
        force_limit: S::signal(ranged("force_limit_n", limit, 0.0, S::SIGNAL_LIMIT)?),
        observer: observer(settings.velocity_source, rate)?,
    })
}

fn observer<S: Scalar>(source: VelocitySource, rate_hz: f64) -> Result<Option<Observer<S>>, ConfigError> {
    let VelocitySource::Observer { bandwidth_hz } = source else { return Ok(None) };
    let [least_hz, greatest_hz] =
        [observer::LEAST_RATIO, observer::GREATEST_RATIO].map(|ratio| ratio * rate_hz);
    let bandwidth_hz = ranged("velocity_observer_hz", bandwidth_hz, least_hz, greatest_hz)?;
    Ok(Some(Observer::new(bandwidth_hz / rate_hz)))
}

fn feedback<S: Scalar>(settings: &AxisSettings, rates: &LoopRates) -> Result<Feedback<S>, ConfigError> {
    let fade_time = positive("scale_fade_time_s", settings.scale_fade_time_s)?;
    let fade = ExponentialDecay::new(fade_time * rates.position_rate);
    Ok(match settings.sensors {
        Sensors::Motor { .. } => Feedback::Motor,
        Sensors::Table(_) => Feedback::Table { fade },
        Sensors::Dual { time_constant_s, .. } => {
            let time = positive("dual_feedback_time_constant_s", time_constant_s)?;
            let fraction = -libm::expm1(-1.0 / (rates.position_rate * time));
            Feedback::Dual {
                fraction: gain_over_time::<S>("dual_feedback_time_constant_s", fraction, time)?,
                fade,
            }
        }
    })
}

/// g = tan(πf/rate) of a filter at frequency f.
fn prewarped(name: &'static str, frequency_hz: f64, rate_hz: f64) -> Result<f64, ConfigError> {
    let frequency = positive(name, frequency_hz)?;
    let frequency = ranged(name, frequency, rate_hz * MIN_FILTER_RATIO, rate_hz * MAX_FILTER_RATIO)?;
    Ok(libm::tan(core::f64::consts::PI * frequency / rate_hz))
}

/// The notch filters that are declared, without gaps: a tick ends at the first that is missing.
fn notch_filters<S: Scalar>(
    notches: &Notches,
    rate_hz: f64,
) -> Result<[Option<Filter<S>>; NOTCHES], ConfigError> {
    let mut filters = [None; NOTCHES];
    for (filter, notch) in filters.iter_mut().zip(notches.iter()) {
        *filter = Some(notch_filter(notch, rate_hz)?);
    }
    Ok(filters)
}

fn notch_filter<S: Scalar>(notch: &Notch, rate_hz: f64) -> Result<Filter<S>, ConfigError> {
    let g = prewarped("notch_frequency_hz", notch.frequency_hz, rate_hz)?;
    let width = positive("notch_width_hz", notch.width_hz)?;
    let width = ranged("notch_width_hz", width, 0.0, 4.0 * notch.frequency_hz)?;
    let depth = ranged("notch_depth", notch.depth, 0.0, 1.0)?;
    Ok(Filter::notch(g, width / notch.frequency_hz, depth))
}

fn low_pass_filter<S: Scalar>(low_pass: &LowPass, rate_hz: f64) -> Result<Filter<S>, ConfigError> {
    let g = prewarped("low_pass_frequency_hz", low_pass.frequency_hz, rate_hz)?;
    let damping = ranged("low_pass_damping_ratio", low_pass.damping_ratio, 0.05, 10.0)?;
    Ok(Filter::low_pass(g, 2.0 * damping))
}

fn monitor<S: Scalar>(settings: &AxisSettings, rates: &LoopRates) -> Result<Monitor<S>, ConfigError> {
    let signal = |name, value: f64, unit: f64| {
        let value = positive(name, value)?;
        // A signal saturates to within 0.2 % of its range, and has to exceed the limit then.
        Ok(S::signal(ranged(name, value, 0.0, 0.99 * S::SIGNAL_LIMIT * unit)? / unit))
    };
    let ticks = positive("saturation_time_s", settings.saturation_time_s)? / rates.tick;
    let sensors = &settings.sensors;
    Ok(Monitor {
        following_error: signal("following_error_limit_m", settings.following_error_limit_m, LENGTH_M)?,
        disagreement: match sensors.scale_disagreement_limit_m() {
            Some(m) => Band::new(distance("scale_disagreement_limit_m", m, TRAVEL_LIMIT_M)?),
            None => Band::UNLIMITED,
        },
        apart: match sensors {
            Sensors::Motor { .. } => Apart::NOT_MONITORED,
            Sensors::Table(_) | Sensors::Dual { .. } => {
                frozen_limit(settings)?.map_or(Apart::NOT_MONITORED, Apart::new)
            }
        },
        frozen_encoder: frozen_limit(settings)?.map(|limit| {
            let per_tick = S::gain(VELOCITY_M_PER_S / LENGTH_M * rates.position_tick);
            FrozenEncoder::new(limit, S::signal(limit as f64 / PER_M / LENGTH_M), per_tick)
        }),
        encoder_step: match settings.fastest_m_per_s {
            Some(m_per_s) => Some(signal("fastest_m_per_s", m_per_s, INCREMENT_M / rates.tick)?),
            None => None,
        },
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        saturation_budget_ticks: (ticks as u32).min(u32::MAX / 4 - 1),
        travel: travel(settings)?,
    })
}

/// A distance in position units.
fn distance(name: &'static str, m: f64, max_m: f64) -> Result<u64, ConfigError> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 100 m")]
    Ok((ranged(name, m, 0.0, max_m)? * PER_M) as u64)
}

/// [`Sensors::frozen_encoder_limit_m`] in position units.
fn frozen_limit(settings: &AxisSettings) -> Result<Option<u64>, ConfigError> {
    let name = "frozen_encoder_limit_m";
    let Some(limit_m) = settings.sensors.frozen_encoder_limit_m() else { return Ok(None) };
    let max_m = match settings.sensors {
        Sensors::Motor { .. } => TRAVEL_LIMIT_M,
        Sensors::Table(_) | Sensors::Dual { .. } => {
            positive(name, limit_m)?;
            ScaleLimits::MOST_FROZEN_M
        }
    };
    distance(name, limit_m, settings.following_error_limit_m.min(max_m)).map(Some)
}

/// The travel of an axis without soft limits: ±[`TRAVEL_LIMIT_M`].
pub const UNLIMITED: [Position; 2] = {
    #[expect(clippy::cast_possible_truncation, reason = "a whole number, 1.05e17")]
    let limit = (TRAVEL_LIMIT_M * PER_M) as i64;
    [Position(-limit), Position(limit)]
};

/// Least and greatest command. The soft limits of a beam are those of its first motor, and the second has none.
fn travel(settings: &AxisSettings) -> Result<[Position; 2], ConfigError> {
    let name = "travel_m";
    let out_of_range = ConfigError::OutOfRange { name, min: -TRAVEL_LIMIT_M, max: TRAVEL_LIMIT_M };
    let end = |m| Position::from_m(finite(name, m)?).ok_or(out_of_range);
    let Some([min_m, max_m]) = settings.travel_m else { return Ok(UNLIMITED) };
    let [min, max] = [end(min_m)?, end(max_m)?];
    if min >= max {
        return Err(ConfigError::NotPositive(name));
    }
    Ok(if settings.gantry.is_some() { UNLIMITED } else { [min, max] })
}

fn brake_ticks(brake: &Brake, rate_hz: f64) -> Result<BrakeTicks, ConfigError> {
    let ticks = |name, time_s| {
        let time_s = ranged(name, time_s, 0.0, Brake::LONGEST_S)?;
        // A time of whole ticks is not made longer by its rounding error.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 2e6")]
        Ok(libm::ceil(time_s * rate_hz * (1.0 - 1e-12)) as u32)
    };
    Ok(BrakeTicks {
        release: ticks("brake_release_s", brake.release_s)?,
        engage: ticks("brake_engage_s", brake.engage_s)?,
    })
}

fn preload<S: Scalar>(preload_n: f64, force_limit_n: f64) -> Result<S, ConfigError> {
    Ok(S::signal(ranged("preload_n", preload_n, -force_limit_n, force_limit_n)?))
}

/// Metres per tick (or tick²) as position units with 16 fraction bits.
fn per_tick(name: &'static str, value: f64) -> Result<u64, ConfigError> {
    let units = positive(name, value)? * PER_M * 65_536.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    Ok((units as u64).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;

    const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };

    fn error_of(change: impl Fn(&mut AxisSettings)) -> ConfigError {
        let mut settings = AxisSettings::default();
        change(&mut settings);
        AxisConfig::<Fixed>::new(&settings, RATES).unwrap_err()
    }

    #[test]
    fn rejected_settings_are_named() {
        assert_eq!(
            error_of(|s| s.position_gain_per_s = 0.0),
            ConfigError::NotPositive("position_gain_per_s")
        );
        assert_eq!(
            error_of(|s| s.position_gain_per_s = f64::NAN),
            ConfigError::NotFinite("position_gain_per_s")
        );
        assert_eq!(
            error_of(|s| s.velocity_integral_time_s = Some(-1.0)),
            ConfigError::NotPositive("velocity_integral_time_s")
        );
        assert_eq!(error_of(|s| s.scale_fade_time_s = 0.0), ConfigError::NotPositive("scale_fade_time_s"));
        assert_eq!(
            error_of(|s| s.force_limit_n = 1e6),
            ConfigError::OutOfRange { name: "force_limit_n", min: 0.0, max: 131_072.0 }
        );
        assert!(matches!(error_of(|s| s.velocity_gain_n_s_per_m = 1e7),
            ConfigError::OutOfRange { name: "velocity_gain_n_s_per_m", max, .. } if (7.8e6..7.82e6).contains(&max)));
    }

    #[test]
    fn settings_below_the_resolution_of_fixed_point_are_rejected_with_their_range() {
        let slow = error_of(|s| s.velocity_integral_time_s = Some(1e6));
        let ConfigError::OutOfRange { name: "velocity_integral_time_s", min, max } = slow else {
            panic!("{slow:?}");
        };
        let mut settings =
            AxisSettings { velocity_integral_time_s: Some(max * 0.999), ..AxisSettings::default() };
        assert!(AxisConfig::<Fixed>::new(&settings, RATES).is_ok());
        settings.velocity_integral_time_s = Some(min * 1.001);
        assert!(AxisConfig::<Fixed>::new(&settings, RATES).is_ok());
        settings.velocity_integral_time_s = Some(min * 0.999);
        assert!(AxisConfig::<Fixed>::new(&settings, RATES).is_err());
        settings.velocity_integral_time_s = Some(1e6);
        assert!(AxisConfig::<f32>::new(&settings, RATES).is_ok());

        let slow = error_of(|s| {
            s.sensors = Sensors::Dual { time_constant_s: 1e4, limits: ScaleLimits::DEFAULT };
        });
        // The gain 1/(rate·T) must be at least 50·2⁻²⁴: T ≤ 16.8 s at 20 kHz.
        assert!(matches!(slow, ConfigError::OutOfRange { name: "dual_feedback_time_constant_s", max, .. }
            if (16.7..16.8).contains(&max)));
    }

    /// 50 ms are 1000 ticks of 20 kHz; a tenth of a tick more is another one.
    #[test]
    fn the_times_of_a_brake_are_whole_ticks_and_not_shorter() {
        for (release_s, engage_s, release, engage) in
            [(0.05, 0.15, 1000, 3000), (0.0, 2.0, 0, 40_000), (0.050_005, 1e-9, 1001, 1)]
        {
            let brake = Some(Brake { release_s, engage_s });
            let axis =
                AxisConfig::<Fixed>::new(&AxisSettings { brake, ..AxisSettings::default() }, RATES).unwrap();
            assert_eq!(axis.brake, Some(BrakeTicks { release, engage }));
        }
        for time_s in [-1e-9, 2.1, f64::NAN] {
            let of = |release_s, engage_s| error_of(|s| s.brake = Some(Brake { release_s, engage_s }));
            assert_eq!(of(time_s, 0.1).name(), "brake_release_s");
            assert_eq!(of(0.1, time_s).name(), "brake_engage_s");
        }
    }

    #[test]
    fn a_preload_is_at_most_the_force_limit() {
        let limits = ConfigError::OutOfRange { name: "preload_n", min: -10_000.0, max: 10_000.0 };
        assert_eq!(error_of(|s| s.preload_n = Some(10_000.1)), limits);
        assert_eq!(error_of(|s| s.preload_n = Some(-10_000.1)), limits);
        let settings = AxisSettings { preload_n: Some(-10_000.0), ..AxisSettings::default() };
        assert_eq!(
            AxisConfig::<Fixed>::new(&settings, RATES).unwrap().preload,
            Some(Fixed::signal(-10_000.0))
        );
    }

    #[test]
    fn a_rate_of_zero_is_rejected() {
        let rates = Rates { velocity_loop_hz: 0.0, ..RATES };
        let error = AxisConfig::<f64>::new(&AxisSettings::default(), rates).unwrap_err();
        assert_eq!(error, ConfigError::NotPositive("velocity_loop_hz"));
    }
}
