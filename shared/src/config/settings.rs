//! The settings of an axis in SI.

use serde::{Deserialize, Serialize};

use super::gantry_settings::GantrySettings;
pub use crate::control::gain_schedule::{SCHEDULE_POINTS, ScheduledOver};
use crate::interpolate::Smoothing;

/// Rates of the loops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rates {
    /// Rate of the velocity loop, which is the tick rate of the machine.
    pub velocity_loop_hz: f64,
    /// Ticks per command and position loop, at least 1.
    pub position_loop_divider: u32,
}

impl Rates {
    /// Rate of commands and position loops.
    #[must_use]
    pub fn position_loop_hz(&self) -> f64 {
        self.velocity_loop_hz / f64::from(self.position_loop_divider)
    }
}

/// Control law of the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// Proportional.
    P,
    /// High-order position control ([`crate::control::hpc`]).
    Hpc,
}

/// From what the velocity loop has the velocity of the motor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum VelocitySource {
    /// The difference of two readings.
    Difference,
    /// A tracking observer ([`crate::control::observer`]).
    Observer {
        /// ω/2π of its two poles, 0.001 to 0.25 times the rate of the velocity loop.
        bandwidth_hz: f64,
    },
}

impl VelocitySource {
    /// Mean age of the velocity beyond that of the difference, ticks of a velocity loop with this rate: 2r/(1 − r), r = e^(−ωT).
    #[must_use]
    pub fn age_ticks(self, velocity_loop_hz: f64) -> f64 {
        match self {
            Self::Difference => 0.0,
            Self::Observer { bandwidth_hz } => {
                2.0 / libm::expm1(2.0 * core::f64::consts::PI * bandwidth_hz / velocity_loop_hz)
            }
        }
    }
}

/// Sensors that close the position loop, with the limits beyond which their readings switch the drives off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Sensors {
    /// Motor encoder (semi-closed loop). A linear scale is only compared with it.
    Motor {
        /// Greatest difference between motor and scale; `None`: not monitored.
        scale_disagreement_limit_m: Option<f64>,
        /// Distance that both command and velocity command may cover while the motor reading stands still, at most
        /// [`AxisSettings::following_error_limit_m`]; `None`: not monitored.
        frozen_encoder_limit_m: Option<f64>,
    },
    /// Linear scale (full-closed loop).
    Table(ScaleLimits),
    /// Both ([`crate::feedback::dual`]).
    Dual {
        /// Time constant of the crossover from motor to scale, s.
        time_constant_s: f64,
        /// Limits of both readings.
        limits: ScaleLimits,
    },
}

impl Sensors {
    /// The motor encoder, neither compared with a scale nor monitored for standstill.
    pub const MOTOR: Self = Self::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: None };

    /// Greatest difference between motor and scale, m; `None`: not monitored.
    #[must_use]
    pub const fn scale_disagreement_limit_m(&self) -> Option<f64> {
        match *self {
            Self::Motor { scale_disagreement_limit_m, .. } => scale_disagreement_limit_m,
            Self::Table(limits) | Self::Dual { limits, .. } => Some(limits.disagreement_m),
        }
    }

    /// Distance that is demanded while the motor reading stands still, m; `None`: not monitored. With a scale in the loop also
    /// the distance that one of motor and scale moves while the other stands.
    #[must_use]
    pub const fn frozen_encoder_limit_m(&self) -> Option<f64> {
        match *self {
            Self::Motor { frozen_encoder_limit_m, .. } => frozen_encoder_limit_m,
            Self::Table(limits) | Self::Dual { limits, .. } => Some(limits.frozen_m),
        }
    }

    /// Whether a loop on either of both has the same feedback; their limits may differ.
    #[must_use]
    pub fn have_feedback_of(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Motor { .. }, Self::Motor { .. }) | (Self::Table(_), Self::Table(_)) => true,
            (Self::Dual { time_constant_s: a, .. }, Self::Dual { time_constant_s: b, .. }) => {
                a.to_bits() == b.to_bits()
            }
            _ => false,
        }
    }
}

/// Limits of the readings of a loop that uses a linear scale. A loop whose scale stands moves its motor without end: there is no such
/// loop without them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaleLimits {
    /// Greatest difference between motor and scale, m.
    pub disagreement_m: f64,
    /// Distance within which a sensor is noticed that stands while the other moves, and that may be demanded while the motor stands, m;
    /// above 0, at most [`ScaleLimits::MOST_FROZEN_M`] and [`AxisSettings::following_error_limit_m`]. More than 1.4 times the backlash.
    pub frozen_m: f64,
}

impl ScaleLimits {
    /// Greatest [`ScaleLimits::frozen_m`]: 0.5 mm.
    pub const MOST_FROZEN_M: f64 = 0.5e-3;

    /// Limits of a machine that declares none: readings that differ by 0.5 mm, and 0.4 mm with one of them standing.
    pub const DEFAULT: Self = Self { disagreement_m: 0.5e-3, frozen_m: 0.4e-3 };
}

/// The times of a holding brake, which is released by an output of the board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Brake {
    /// Time from the output until the brake is open, s, 0 to [`Brake::LONGEST_S`]. The axis is held by its drive meanwhile, and moves
    /// afterwards only.
    pub release_s: f64,
    /// Time from the output until the brake holds the axis, s, 0 to [`Brake::LONGEST_S`]. The drive stays on for it.
    pub engage_s: f64,
}

impl Brake {
    /// Longest time of a brake: 2 s.
    pub const LONGEST_S: f64 = 2.0;
}

/// Greatest number of notch filters of an axis.
pub const NOTCHES: usize = 4;

/// A notch filter of the force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Notch {
    /// Centre frequency.
    pub frequency_hz: f64,
    /// Width between the −3 dB frequencies of a notch of depth 1.
    pub width_hz: f64,
    /// 1 − gain at the centre frequency: 1 removes it, 0.9 leaves a tenth.
    pub depth: f64,
}

/// The notch filters of an axis, in the order in which they act. A type of its own: the compiler (1.95) fails at a closure that takes an
/// array out of settings that it has captured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Notches(pub [Option<Notch>; NOTCHES]);

impl Notches {
    /// No notch.
    pub const NONE: Self = Self([None; NOTCHES]);

    /// The declared notches, in their order.
    pub fn iter(&self) -> impl Iterator<Item = &Notch> {
        self.0.iter().flatten()
    }
}

/// A second-order low-pass filter of the force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LowPass {
    /// Natural frequency, ω₀/2π.
    pub frequency_hz: f64,
    /// Damping ratio ζ; 0.7 gives the flattest response.
    pub damping_ratio: f64,
}

/// A point of a gain schedule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SchedulePoint {
    /// Command, m, or speed, m/s and not negative; ascending, with at least [`GainSchedule::LEAST_SPACING`] in between.
    pub at: f64,
    /// Velocity gain there over [`AxisSettings::velocity_gain_n_s_per_m`], within [`GainSchedule::RATIOS`].
    pub ratio: f64,
}

/// The velocity gain over the command of an axis or its speed ([`crate::control::gain_schedule`]).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GainSchedule {
    /// What the points are places of.
    pub over: ScheduledOver,
    /// At least two points. The first `None` ends them.
    pub points: [Option<SchedulePoint>; SCHEDULE_POINTS],
}

impl GainSchedule {
    /// Least and greatest ratio. The range is that of the program: no upload and no record in flash has a greater one.
    pub const RATIOS: [f64; 2] = [0.25, 4.0];

    /// Least distance of two points, m or m/s.
    pub const LEAST_SPACING: f64 = 1e-3;

    /// A schedule of points; `None`: there are more than [`SCHEDULE_POINTS`].
    pub fn of(over: ScheduledOver, points: impl IntoIterator<Item = SchedulePoint>) -> Option<Self> {
        let mut schedule = Self { over, points: [None; SCHEDULE_POINTS] };
        let mut places = schedule.points.iter_mut();
        for point in points {
            *places.next()? = Some(point);
        }
        Some(schedule)
    }

    /// The declared points, in their order.
    pub fn iter(&self) -> impl Iterator<Item = &SchedulePoint> {
        self.points.iter().map_while(Option::as_ref)
    }
}

/// The settings of one axis, as a person or a file declares them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisSettings {
    /// Control law of the position loop.
    pub law: Law,
    /// Position gain Kp.
    pub position_gain_per_s: f64,
    /// Velocity feed-forward Kf, 0 to 200 %.
    pub feedforward_percent: f64,
    /// Time by which the velocity feed-forward is ahead of the command, 0 to 8 position ticks. The loops and the drive delay
    /// the velocity by about one position tick, which is an error of a·t² while the command accelerates.
    pub feedforward_ahead_s: f64,
    /// Velocity gain Kv.
    pub velocity_gain_n_s_per_m: f64,
    /// Changes of the velocity gain over command or speed; `None`: it is constant.
    pub gain_schedule: Option<GainSchedule>,
    /// Integral time Ti of the velocity loop; `None`: no integral part.
    pub velocity_integral_time_s: Option<f64>,
    /// From what the velocity loop has its velocity.
    pub velocity_source: VelocitySource,
    /// Delay of the velocity reading beyond that of a plain difference, 0 to one tick. An observer has its own in addition.
    pub velocity_lag_s: f64,
    /// Notch filters of the force, which act in this order.
    pub notches: Notches,
    /// Low-pass filter of the force, after the notches.
    pub low_pass: Option<LowPass>,
    /// Limit of the force in both directions.
    pub force_limit_n: f64,
    /// Sensors that close the position loop.
    pub sensors: Sensors,
    /// Filter of the axis behind the interpolated path.
    pub smoothing: Smoothing,
    /// Time constant with which the offset of a linear scale that has returned fades out.
    pub scale_fade_time_s: f64,
    /// Following error above which the drives are switched off.
    pub following_error_limit_m: f64,
    /// Greatest speed of the motor: a reading that has moved faster switches the drives off; `None`: not monitored.
    pub fastest_m_per_s: Option<f64>,
    /// Time that the force may be at its limit before the path stops; unsaturated time earns back a quarter.
    pub saturation_time_s: f64,
    /// Least and greatest command: the soft limits; `None`: ±100 m.
    pub travel_m: Option<[f64; 2]>,
    /// Deceleration of a stop along the path; a path uses the least of its axes.
    pub stop_deceleration_m_per_s2: f64,
    /// Holding brake; `None`: the axis has none, or none that the board operates.
    pub brake: Option<Brake>,
    /// Force with which the drive comes on, N, signed as the force of the controller, at most
    /// [`force_limit_n`](AxisSettings::force_limit_n): the weight of a vertical axis. `None`: not known; the force starts from zero.
    pub preload_n: Option<f64>,
    /// The gantry of which the axis is the second motor; `None`: it has a command of its own.
    pub gantry: Option<GantrySettings>,
}

impl Default for AxisSettings {
    /// P control on the motor encoder, with the gains of a mid-sized machining centre.
    fn default() -> Self {
        Self {
            law: Law::P,
            position_gain_per_s: 33.0,
            feedforward_percent: 0.0,
            feedforward_ahead_s: 0.0,
            velocity_gain_n_s_per_m: 50_000.0,
            gain_schedule: None,
            velocity_integral_time_s: Some(0.02),
            velocity_source: VelocitySource::Difference,
            velocity_lag_s: 0.0,
            notches: Notches::NONE,
            low_pass: None,
            force_limit_n: 10_000.0,
            sensors: Sensors::MOTOR,
            smoothing: Smoothing::None,
            scale_fade_time_s: 0.1,
            following_error_limit_m: 0.05,
            fastest_m_per_s: None,
            saturation_time_s: 1.0,
            travel_m: None,
            stop_deceleration_m_per_s2: 2.0,
            brake: None,
            preload_n: None,
            gantry: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An observer is the difference behind two stages of (1 − r)/(1 − r/z): of a unit of velocity, (n + 1)·(1 − r)²·rⁿ appears n ticks later,
    /// and the mean age is the sum of n times these.
    #[test]
    fn the_age_of_an_observer_is_the_mean_of_its_response() {
        assert!(VelocitySource::Difference.age_ticks(20_000.0).abs() < 1e-12);
        for bandwidth_hz in [100.0, 1000.0, 5000.0] {
            let r = (-core::f64::consts::TAU * bandwidth_hz / 20_000.0).exp();
            let mean: f64 =
                (0..4000).map(|n| f64::from(n) * f64::from(n + 1) * (1.0 - r).powi(2) * r.powi(n)).sum();
            let age = VelocitySource::Observer { bandwidth_hz }.age_ticks(20_000.0);
            assert!((age - mean).abs() < 1e-9 * mean, "{bandwidth_hz} Hz: {age}, {mean}");
        }
    }
}
