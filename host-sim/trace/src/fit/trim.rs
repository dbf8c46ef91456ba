//! Timing that a machine file does not declare: instants at which channels are read, and discretization of a drive's
//! filters.
//!
//! Timing errors of about a tenth of a sample are normal for any log. They are fitted within bounds, so that they are not
//! explained by an effect, and are not reported. An effect that describes the same timing (`latency`, `velocity_lag`)
//! replaces the trim.

use shared::config::Rates;

use crate::options::ModelOptions;
use model::axis::{Drive, Law};
use model::effects::{Channel, Coordinate, Effect, Stage, Timing};
use model::machine::Axis;
use model::machine::nominal::LogOffsets;
use model::servo::VelocityDrive;
use plant::parameters::AxisParameters;

/// An instant or interval that is trimmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instant {
    /// Reading of the linear scale, relative to the motor's.
    Table,
    /// Reading of the tool-point probe, relative to the scale's.
    Tool,
    /// Reading of the force, relative to the motor's.
    Force,
    /// Age of the velocity in the velocity loop.
    Speed,
    /// Action of the drive's force, relative to the reading of the sensors. Late: a first-order lag of the force.
    Drive,
    /// Step of the filter of high-order control; zero: exact discretization.
    Filter,
    /// Time constant of a drive whose velocity is commanded.
    VelocityTimeConstant,
    /// Rate of the integral part of such a drive, 1/s in place of ms.
    VelocityIntegral,
    /// Coulomb friction over the moved mass, m/s² in place of ms.
    VelocityFriction,
    /// Dead time of a drive whose velocity or position is commanded.
    DeadTime,
}

/// Longest time constant of a drive whose velocity is commanded, s: a bandwidth of 1.6 Hz.
const LONGEST_TIME_CONSTANT_S: f64 = 0.1;

/// Highest rate of the integral part of such a drive, 1/s.
const HIGHEST_INTEGRAL_PER_S: f64 = 1e3;

/// Largest friction over the moved mass, m/s².
const LARGEST_FRICTION_M_PER_S2: f64 = 30.0;

/// Time constant (ms) and integral rate (1/s) with which the fit of such a drive starts: a bandwidth of 50 Hz.
const FIRST_TIME_CONSTANT_MS: f64 = 3.0;
const FIRST_INTEGRAL_PER_S: f64 = 30.0;

/// Other first values of time constant and integral rate: without an integral part, and slower and faster drives.
pub const FIRST_DRIVES: [[f64; 2]; 4] = [[3.0, 0.0], [10.0, 0.0], [10.0, 30.0], [1.0, 0.0]];

/// Longest dead time of a drive whose velocity or position is commanded, in samples.
const LONGEST_DEAD_TIME: f64 = 10.0;

/// Values of all instants.
#[derive(Clone, Debug, Default)]
pub struct Trims {
    /// Each in thousands of the unit of its key: a delay in s, as its key is in ms (negative: early), a rate in 1/ms, an acceleration in km/s².
    values: [f64; 10],
}

impl Instant {
    const ALL: [Self; 10] = [
        Self::Table,
        Self::Tool,
        Self::Force,
        Self::Speed,
        Self::Drive,
        Self::Filter,
        Self::VelocityTimeConstant,
        Self::VelocityIntegral,
        Self::VelocityFriction,
        Self::DeadTime,
    ];

    /// The key in a machine file, ms.
    fn key(self, offsets: &mut LogOffsets) -> &mut Option<f64> {
        match self {
            Self::Table => &mut offsets.table_late_ms,
            Self::Tool => &mut offsets.tool_late_ms,
            Self::Force => &mut offsets.force_late_ms,
            Self::Speed => &mut offsets.speed_late_ms,
            Self::Drive => &mut offsets.drive_late_ms,
            Self::Filter => &mut offsets.filter_step_ms,
            Self::VelocityTimeConstant => &mut offsets.velocity_time_constant_ms,
            Self::VelocityIntegral => &mut offsets.velocity_integral_per_s,
            Self::VelocityFriction => &mut offsets.velocity_friction_m_per_s2,
            Self::DeadTime => &mut offsets.drive_dead_time_ms,
        }
    }

    /// The stage from which the trim is determined.
    fn stage(self) -> Stage {
        match self {
            Self::Table => Stage::Table,
            Self::Tool => Stage::Tool,
            Self::Force => Stage::Force,
            Self::Speed
            | Self::Drive
            | Self::Filter
            | Self::VelocityTimeConstant
            | Self::VelocityIntegral
            | Self::VelocityFriction
            | Self::DeadTime => Stage::Motor,
        }
    }

    /// Whether an axis has such a parameter.
    fn is_of(self, axis: &Axis) -> bool {
        let drive = axis.settings.controller.drive;
        match self {
            Self::Table | Self::Tool | Self::Force => true,
            Self::Speed | Self::Drive => drive == Drive::Torque,
            Self::Filter => drive == Drive::Torque && axis.settings.controller.law == Some(Law::Hpc),
            Self::VelocityTimeConstant | Self::VelocityIntegral | Self::VelocityFriction => {
                drive == Drive::Velocity
            }
            Self::DeadTime => drive != Drive::Torque,
        }
    }

    /// Smallest and largest value, in the unit of [`Trims`]: of a delay, s. The motor of a stepper may be its command, from which table and tool are as late as its dead time.
    fn bounds(self, drive: Drive, rates: Rates, options: &ModelOptions) -> [f64; 2] {
        let tick_s = 1.0 / rates.velocity_loop_hz;
        let sample_s = tick_s * f64::from(rates.position_loop_divider);
        let dead_time_s = LONGEST_DEAD_TIME * sample_s;
        match self {
            Self::Table | Self::Tool if drive == Drive::Stepper => [-dead_time_s, dead_time_s],
            Self::VelocityTimeConstant => [0.0, LONGEST_TIME_CONSTANT_S],
            Self::VelocityIntegral => [0.0, 1e-3 * HIGHEST_INTEGRAL_PER_S],
            Self::VelocityFriction => [0.0, 1e-3 * LARGEST_FRICTION_M_PER_S2],
            Self::DeadTime => [0.0, dead_time_s],
            Self::Table | Self::Tool => [-options.position_trim * sample_s, options.position_trim * sample_s],
            // Force and position have different bounds: a force is a mean over an interval, a position belongs to an instant.
            Self::Force => [-options.force_trim * sample_s, options.force_trim * sample_s],
            Self::Speed => [-options.velocity_trim * tick_s, options.velocity_trim * tick_s],
            Self::Drive => [-options.drive_trim * tick_s, longest_drive_lag_s(tick_s, options)],
            Self::Filter => [0.0, options.position_trim * sample_s],
        }
    }

    /// The value with which a fit starts if the machine file has none; zero in a file that a fit wrote.
    const fn first_ms(self, was_fitted: bool) -> f64 {
        match self {
            Self::VelocityTimeConstant if !was_fitted => FIRST_TIME_CONSTANT_MS,
            Self::VelocityIntegral if !was_fitted => FIRST_INTEGRAL_PER_S,
            _ => 0.0,
        }
    }

    /// Step of the difference quotients, from the bound, ms. The motor is far from linear in the values of a drive whose velocity is
    /// commanded: 0.1 ms, 1 1/s, 0.02 m/s².
    fn step_ms(self, bound_ms: f64) -> f64 {
        match self {
            Self::VelocityTimeConstant => 0.1,
            Self::VelocityIntegral => 1.0,
            Self::VelocityFriction => 0.02,
            _ => 0.02 * bound_ms,
        }
    }

    /// Whether an effect describes the same timing.
    fn is_replaced_by(self, effect: &Effect) -> bool {
        match effect.timing() {
            Some(Timing::Reading { channel, .. }) => match channel {
                Channel::Table => self == Self::Table,
                Channel::Tool => self == Self::Tool,
                Channel::Force => self == Self::Force,
                Channel::Command => false,
            },
            Some(Timing::VelocityAge) => self == Self::Speed,
            Some(Timing::DriveLag) | None => false,
        }
    }
}

/// Largest time constant of the drive's force that is fitted, s. With a long tick the age of the velocity may be as large: both
/// delay the reaction of the loop, no log tells them apart, and only the age is fitted.
fn longest_drive_lag_s(tick_s: f64, options: &ModelOptions) -> f64 {
    let lag_s = 1e-3 * options.drive_lag_trim_ms;
    if options.velocity_trim * tick_s < lag_s { lag_s } else { 0.0 }
}

impl Trims {
    /// The trims of an axis's machine file, limited to their bounds.
    #[must_use]
    pub fn of(axis: &Axis, rates: Rates, options: &ModelOptions) -> Self {
        let mut offsets = axis.log_offsets.unwrap_or_default();
        let mut trims = Self::default();
        for instant in Instant::ALL {
            let [lower, upper] = instant.bounds(axis.settings.controller.drive, rates, options);
            let ms = instant.key(&mut offsets).unwrap_or(instant.first_ms(axis.log_offsets.is_some()));
            trims.values[instant as usize] = (1e-3 * ms).clamp(lower, upper);
        }
        trims
    }

    /// Writes the trims that are not zero and not replaced by an effect.
    pub fn write(&self, axis: &Axis, offsets: &mut LogOffsets) {
        for instant in Instant::ALL {
            let ms = 1e3 * self.values[instant as usize];
            let is_replaced = axis.effect.iter().any(|effect| instant.is_replaced_by(effect));
            *instant.key(offsets) = (ms != 0.0 && !is_replaced).then_some(ms);
        }
    }

    /// The trims of these stages, with their coordinate (ms) and the standard deviation of their prior. A trim that an effect
    /// replaces is fixed at zero, so that the model has the same free parameters with and without the effect.
    #[must_use]
    pub fn coordinates(
        &self,
        stages: &[Stage],
        axis: &Axis,
        rates: Rates,
        options: &ModelOptions,
    ) -> Vec<(Instant, Coordinate, f64)> {
        let coordinate = |instant: Instant| {
            let drive = axis.settings.controller.drive;
            let [lower, upper] = instant.bounds(drive, rates, options).map(|s| 1e3 * s);
            let bound = upper.max(-lower);
            // The effect is the lag itself; that the force acts early is not part of it.
            let is_lag =
                |effect: &Effect| instant == Instant::Drive && effect.timing() == Some(Timing::DriveLag);
            let upper = if axis.effect.iter().any(is_lag) { 0.0 } else { upper };
            let step = instant.step_ms(bound);
            let coordinate = if axis.effect.iter().any(|effect| instant.is_replaced_by(effect)) {
                Coordinate::between(0.0, step, 0.0, 0.0)
            } else {
                Coordinate::between((1e3 * self.values[instant as usize]).min(upper), step, lower, upper)
            };
            (instant, coordinate, options.trim_prior * bound)
        };
        let of_stages = Instant::ALL.into_iter();
        let of_stages = of_stages.filter(|instant| stages.contains(&instant.stage()) && instant.is_of(axis));
        of_stages.map(coordinate).collect()
    }

    /// These trims with time constant (ms) and integral rate (1/s) of a drive whose velocity is commanded, and no dead time.
    #[must_use]
    pub fn with_velocity_drive(&self, [time_constant_ms, integral_per_s]: [f64; 2]) -> Self {
        let mut trims = self.clone();
        trims.set_ms(Instant::VelocityTimeConstant, time_constant_ms);
        trims.set_ms(Instant::VelocityIntegral, integral_per_s);
        trims.set_ms(Instant::DeadTime, 0.0);
        trims
    }

    /// Sets the delay of an instant, ms.
    pub fn set_ms(&mut self, instant: Instant, ms: f64) {
        self.values[instant as usize] = 1e-3 * ms;
    }

    /// The simulation parameters of an axis with these trims.
    #[must_use]
    pub fn applied(&self, mut parameters: AxisParameters, effects: &[Effect]) -> AxisParameters {
        let open = |instant: Instant| !effects.iter().any(|effect| instant.is_replaced_by(effect));
        let channels = [
            (Instant::Table, Channel::Table),
            (Instant::Tool, Channel::Tool),
            (Instant::Force, Channel::Force),
        ];
        for (instant, channel) in channels {
            if open(instant) {
                parameters.add_latency(channel, self.values[instant as usize]);
            }
        }
        if open(Instant::Speed) {
            parameters.servo.lag.ms += 1e3 * self.values[Instant::Speed as usize];
        }
        parameters.servo.drive_late_s += self.values[Instant::Drive as usize];
        parameters.servo.filter_step_s = self.values[Instant::Filter as usize];
        parameters.servo.velocity_drive = VelocityDrive {
            time_constant_s: self.values[Instant::VelocityTimeConstant as usize],
            integral_per_s: 1e3 * self.values[Instant::VelocityIntegral as usize],
            dead_time_s: self.values[Instant::DeadTime as usize],
            friction_m_per_s2: 1e3 * self.values[Instant::VelocityFriction as usize],
        };
        parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::{DriveLag, VelocityLag};

    const RATES: Rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 4 };

    #[test]
    fn an_effect_replaces_a_trim() {
        let mut trims = Trims::default();
        trims.set_ms(Instant::Speed, 0.05);
        let stages = [Stage::Motor, Stage::Tool];
        let of = |effects: &[Effect], law| {
            let mut axis = Axis { effect: effects.to_vec(), ..Axis::default() };
            axis.settings.controller.law = Some(law);
            let trimmed = trims.coordinates(&stages, &axis, RATES, &ModelOptions::default());
            trimmed.into_iter().map(|(instant, c, _)| (instant, c.value, c.upper)).collect::<Vec<_>>()
        };
        // Upper bounds: a tenth of 1 ms; a quarter of 0.25 ms; the lag of a current loop.
        let [tool, drive] = [(Instant::Tool, 0.0, 0.1), (Instant::Drive, 0.0, 0.15)];
        assert_eq!(of(&[], Law::P), [tool, (Instant::Speed, 0.05, 0.0625), drive]);
        let lag = [Effect::VelocityLag(VelocityLag { ms: 0.1 })];
        assert_eq!(of(&lag, Law::P), [tool, (Instant::Speed, 0.0, 0.0), drive]);
        // The effect is the lag itself; only an early action remains beside it.
        let drive_lag = [Effect::DriveLag(DriveLag { ms: 0.4 })];
        assert_eq!(of(&drive_lag, Law::P)[2], (Instant::Drive, 0.0, 0.0));
        // Only high-order control has a filter.
        assert_eq!(of(&lag, Law::Hpc)[3], (Instant::Filter, 0.0, 0.1));
        let mut parameters = AxisParameters::default();
        parameters.servo.lag.ms = 0.1;
        // 0.1 ms of the effect, or 0.15 ms with the trim if no effect replaces the trim.
        assert!((trims.applied(parameters.clone(), &lag).servo.lag.ms - 0.1).abs() < 1e-12);
        assert!((trims.applied(parameters, &[]).servo.lag.ms - 0.15).abs() < 1e-12);
    }

    /// A quarter of a tick of 0.6 ms is 0.15 ms.
    #[test]
    fn the_lag_of_the_drive_is_fitted_only_if_it_may_exceed_the_age_of_the_velocity() {
        let upper_s = |tick_s: f64| {
            let rates = Rates { velocity_loop_hz: 1.0 / tick_s, position_loop_divider: 1 };
            Instant::Drive.bounds(Drive::Torque, rates, &ModelOptions::default())[1]
        };
        assert_eq!(
            [0.59e-3, 0.61e-3].map(|tick_s| upper_s(tick_s).to_bits()),
            [0.15e-3_f64, 0.0].map(f64::to_bits)
        );
    }
}
