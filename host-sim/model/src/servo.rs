//! Conversion of the controller's keys in the machine file to settings of `shared`.

use shared::config::{
    self, AxisSettings, Brake, GainSchedule, GantrySettings, LowPass, Notch, Notches, ScaleLimits,
    SchedulePoint, ScheduledOver, VelocitySource,
};
use shared::interpolate::Smoothing;

use crate::axis::{
    Controller, Drive, Feedback, Filters, Gantry, Holding, Law, Limits, PerNotch, Schedule, Sensors, Settings,
};
use crate::effects::{
    ComputationDelay, DriveDeadTime, DriveLag, Effect, FeedforwardMismatch, IntegralTimeMismatch, LoopDelay,
    PositionDelay, ServoMismatch, VelocityFilter, VelocityGainMismatch, VelocityLag,
};

/// Following error at which the drives are switched off if the machine file declares no limit, m.
pub const FOLLOWING_ERROR_LIMIT_M: f64 = 0.13;

/// Force limit of an axis that declares none, N.
const UNLIMITED_N: f64 = 1e5;

/// A drive of which the machine file declares only that its velocity, or its position, is commanded. Absent: zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VelocityDrive {
    /// τ, the moved mass divided by the gain of the drive's velocity loop, s.
    pub time_constant_s: f64,
    /// 1/Ti of its integral part, 1/s.
    pub integral_per_s: f64,
    /// Time from the command to the motor, s.
    pub dead_time_s: f64,
    /// Coulomb friction over the moved mass, m/s².
    pub friction_m_per_s2: f64,
}

/// Effects in the controller.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ServoParameters {
    /// Deviation of Kp.
    pub mismatch: ServoMismatch,
    /// Deviation of Kf.
    pub feedforward: FeedforwardMismatch,
    /// Deviation of Kv.
    pub velocity_gain: VelocityGainMismatch,
    /// Deviation of Ti.
    pub integral_time: IntegralTimeMismatch,
    /// Lag of the drive's force.
    pub drive_lag: Option<DriveLag>,
    /// Delay of the velocity reading.
    pub lag: VelocityLag,
    /// Filter of the velocity reading.
    pub velocity_filter: VelocityFilter,
    /// Periods from the readings to the force.
    pub computation_delay: ComputationDelay,
    /// Dead time of the force.
    pub dead_time: DriveDeadTime,
    /// Delay of the velocity command.
    pub loop_delay: LoopDelay,
    /// Delay of the position that the position loop uses.
    pub position_delay: PositionDelay,
    /// When the force acts relative to the reading of the sensors, s; negative: the sensors are read later; positive: time
    /// constant of a first-order lag, without a [`Self::drive_lag`].
    pub drive_late_s: f64,
    /// Semi-implicit step of the controller's filter, s; 0: exact discretization.
    pub filter_step_s: f64,
    /// A drive that is not commanded by a force.
    pub velocity_drive: VelocityDrive,
}

impl ServoParameters {
    /// Selects the effects in the controller from the effects of an axis.
    #[must_use]
    pub fn of(effects: &[Effect]) -> Self {
        let mut parameters = Self::default();
        for effect in effects {
            match effect {
                Effect::ServoMismatch(mismatch) => parameters.mismatch = mismatch.clone(),
                Effect::FeedforwardMismatch(mismatch) => parameters.feedforward = mismatch.clone(),
                Effect::VelocityGainMismatch(mismatch) => parameters.velocity_gain = mismatch.clone(),
                Effect::IntegralTimeMismatch(mismatch) => parameters.integral_time = mismatch.clone(),
                Effect::DriveLag(lag) => parameters.drive_lag = Some(lag.clone()),
                Effect::VelocityLag(lag) => parameters.lag = lag.clone(),
                Effect::VelocityFilter(filter) => parameters.velocity_filter = filter.clone(),
                Effect::DriveDeadTime(delay) => parameters.dead_time = delay.clone(),
                Effect::ComputationDelay(delay) => parameters.computation_delay = delay.clone(),
                Effect::LoopDelay(delay) => parameters.loop_delay = delay.clone(),
                Effect::PositionDelay(delay) => parameters.position_delay = delay.clone(),
                _ => {}
            }
        }
        parameters
    }

    /// Time from the readings of the velocity loop, which has this period (s), until its force acts, s.
    #[must_use]
    pub fn force_late_s(&self, tick_s: f64) -> f64 {
        tick_s * self.computation_delay.periods + self.dead_time.seconds()
    }

    /// True Kv, N·s/m, of a controller that declares one.
    #[must_use]
    pub fn velocity_gain_n_s_per_m(&self, controller: &Controller) -> Option<f64> {
        controller.velocity_gain_n_s_per_m.map(|gain| self.velocity_gain.factor() * gain)
    }

    /// True Ti, s, of a controller that declares one.
    #[must_use]
    pub fn velocity_integral_time_s(&self, controller: &Controller) -> Option<f64> {
        controller.velocity_integral_time_s.map(|time_s| self.integral_time.factor() * time_s)
    }

    /// The effect that the controller of `shared` cannot have, if the axis has one: signals that only one of its loops receives
    /// late.
    #[must_use]
    pub fn not_in_controller(&self) -> Option<&'static str> {
        let effects = [
            (self.loop_delay.ms, "loop_delay"),
            (self.position_delay.ms, "position_delay"),
            (self.velocity_filter.time_constant_ms, "velocity_lag with time_constant_ms"),
        ];
        effects.into_iter().find(|(size, _)| *size > 0.0).map(|(_, name)| name)
    }

    /// Time constant of the drive's force, s; `otherwise` without a known one.
    #[must_use]
    pub fn drive_time_constant_s(&self, otherwise: f64) -> f64 {
        self.drive_lag.as_ref().map_or(otherwise, DriveLag::time_constant_s)
    }
}

/// Settings of the controller for an axis of a machine file, with the effects in the controller.
///
/// # Errors
/// The missing key.
pub fn settings(axis: &Settings, effects: &ServoParameters) -> Result<AxisSettings, &'static str> {
    let Settings { controller, filters, limits, holding, sensors, .. } = axis;
    if controller.drive != Drive::Torque {
        return Err("drive = \"torque\"");
    }
    let law = match controller.law.ok_or("controller")? {
        Law::P => config::Law::P,
        Law::Hpc => config::Law::Hpc,
    };
    let feedback = feedback(sensors, limits)?;
    let defaults = AxisSettings::default();
    let factor = effects.mismatch.factor();
    Ok(AxisSettings {
        law,
        position_gain_per_s: factor * controller.position_gain_per_s.ok_or("position_gain_per_s")?,
        // The lead (Kf/Kp)·d(command)/dt contains the same Kp, so that the mismatch does not change the feed-forward.
        feedforward_percent: controller.feedforward_percent.unwrap_or(0.0) + effects.feedforward.percent,
        feedforward_ahead_s: controller.feedforward_ahead_s.unwrap_or(0.0),
        velocity_gain_n_s_per_m: effects
            .velocity_gain_n_s_per_m(controller)
            .ok_or("velocity_gain_n_s_per_m")?,
        gain_schedule: gain_schedule(&axis.schedule),
        velocity_integral_time_s: effects.velocity_integral_time_s(controller),
        velocity_source: velocity_source(controller),
        velocity_lag_s: 1e-3 * effects.lag.ms,
        force_limit_n: controller.force_limit_n.unwrap_or(UNLIMITED_N),
        sensors: feedback,
        smoothing: smoothing(filters),
        notches: notches(filters),
        low_pass: low_pass(filters),
        following_error_limit_m: following_error_limit_m(limits),
        fastest_m_per_s: limits.fastest_mm_per_s.map(|mm_per_s| 1e-3 * mm_per_s),
        saturation_time_s: limits.saturation_time_s.unwrap_or(defaults.saturation_time_s),
        travel_m: limits.travel_mm.map(|ends| ends.map(|mm| 1e-3 * mm)),
        stop_deceleration_m_per_s2: limits
            .stop_deceleration_m_per_s2
            .unwrap_or(defaults.stop_deceleration_m_per_s2),
        brake: brake(holding),
        preload_n: holding.preload_n,
        ..defaults
    })
}

/// The gantry of which an axis is the second motor, with the number of the first among the names of the axes.
#[must_use]
pub fn gantry<'n>(axis: &Settings, mut names: impl Iterator<Item = &'n String>) -> Option<GantrySettings> {
    let Gantry { gantry_with, gantry_skew_limit_mm, gantry_offset_mm } = &axis.gantry;
    let first = gantry_with.as_ref()?;
    Some(GantrySettings {
        first: u8::try_from(names.position(|name| *name == first.0)?).ok()?,
        skew_limit_m: 1e-3 * (*gantry_skew_limit_mm)?,
        reference_offset_m: 1e-3 * gantry_offset_mm.unwrap_or(0.0),
    })
}

/// From what the velocity loop has its velocity.
#[must_use]
pub fn velocity_source(controller: &Controller) -> VelocitySource {
    controller
        .velocity_observer_hz
        .map_or(VelocitySource::Difference, |bandwidth_hz| VelocitySource::Observer { bandwidth_hz })
}

fn following_error_limit_m(limits: &Limits) -> f64 {
    limits.following_error_limit_mm.map_or(FOLLOWING_ERROR_LIMIT_M, |mm| 1e-3 * mm)
}

/// The sensors of the position loop. With a scale in it, limits that the machine file does not declare are those of
/// [`ScaleLimits::DEFAULT`].
fn feedback(sensors: &Sensors, limits: &Limits) -> Result<config::Sensors, &'static str> {
    let [disagreement_m, frozen_m] =
        [limits.scale_disagreement_limit_mm, limits.frozen_encoder_limit_mm].map(|mm| mm.map(|mm| 1e-3 * mm));
    let with_scale = ScaleLimits {
        disagreement_m: disagreement_m.unwrap_or(ScaleLimits::DEFAULT.disagreement_m),
        frozen_m: frozen_m.unwrap_or(ScaleLimits::DEFAULT.frozen_m.min(following_error_limit_m(limits))),
    };
    Ok(match sensors.feedback {
        Feedback::Motor => config::Sensors::Motor {
            scale_disagreement_limit_m: disagreement_m,
            frozen_encoder_limit_m: frozen_m,
        },
        Feedback::Table => config::Sensors::Table(with_scale),
        Feedback::Dual => config::Sensors::Dual {
            time_constant_s: sensors.dual_feedback_time_constant_s.ok_or("dual_feedback_time_constant_s")?,
            limits: with_scale,
        },
    })
}

/// The holding brake, if both keys are declared.
fn brake(holding: &Holding) -> Option<Brake> {
    Some(Brake { release_s: holding.brake_release_s?, engage_s: holding.brake_engage_s? })
}

/// The filter of the path.
#[must_use]
pub fn smoothing(filters: &Filters) -> Smoothing {
    match (filters.smoothing_s, filters.smoothing_jerk_s, filters.smoothing_time_constant_s) {
        (_, _, Some(time_constant_s)) => Smoothing::Exponential { time_constant_s },
        (Some(time_s), Some(jerk_time_s), None) => Smoothing::SCurve { time_s, jerk_time_s },
        (Some(time_s), None, None) => Smoothing::Trapezoid { time_s },
        (None, _, None) => Smoothing::None,
    }
}

/// The gain schedule, if its keys are declared with as many numbers each.
#[must_use]
pub fn gain_schedule(schedule: &Schedule) -> Option<GainSchedule> {
    let (over, places) = match (&schedule.position_mm, &schedule.speed_mm_per_s) {
        (Some(positions_mm), _) => (ScheduledOver::Position, positions_mm),
        (None, Some(speeds_mm_per_s)) => (ScheduledOver::Speed, speeds_mm_per_s),
        (None, None) => return None,
    };
    let points = places.0.iter().zip(&schedule.ratio.as_ref()?.0);
    GainSchedule::of(over, points.map(|(&at, &ratio)| SchedulePoint { at: 1e-3 * at, ratio }))
}

/// The notches on the force of which all three numbers are declared.
#[must_use]
pub fn notches(filters: &Filters) -> Notches {
    let mut notches = Notches::NONE;
    let keys = [&filters.notch_frequency_hz, &filters.notch_width_hz, &filters.notch_depth];
    if let [Some(frequencies_hz), Some(widths_hz), Some(depths)] = keys {
        let declared = PerNotch::notches([frequencies_hz, widths_hz, depths]);
        for (notch, declared) in notches.0.iter_mut().zip(declared) {
            *notch = Some(declared);
        }
    }
    notches
}

impl Filters {
    /// These filters with other notches.
    #[must_use]
    pub fn with_notches(&self, notches: &[Notch]) -> Self {
        let numbers = PerNotch::of_notches(notches);
        let [notch_frequency_hz, notch_width_hz, notch_depth] =
            numbers.map(|numbers| (!notches.is_empty()).then_some(numbers));
        Self { notch_frequency_hz, notch_width_hz, notch_depth, ..self.clone() }
    }
}

/// The low-pass on the force, if both keys are declared.
#[must_use]
pub fn low_pass(filters: &Filters) -> Option<LowPass> {
    Some(LowPass {
        frequency_hz: filters.low_pass_frequency_hz?,
        damping_ratio: filters.low_pass_damping_ratio?,
    })
}
