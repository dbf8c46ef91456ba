//! The constants of a machine, in machine units.

use super::error::MachineError;
use super::reference::Reference;
use crate::config::{AxisConfig, AxisSettings, GantryConfig, Rates, Sensors, UNLIMITED};
use crate::control::gain_schedule::Schedule;
use crate::interpolate::Smoothing;
use crate::interpolate::smooth::Filters;
use crate::scalar::Scalar;
use crate::units::Position;

/// The constants of N axes, checked and converted.
// In this order: an instruction reaches what is near the beginning. The schedules are large, and few machines have some.
#[repr(C)]
#[derive(Clone, Debug)]
pub struct MachineConfig<S: Scalar, const N: usize> {
    pub(super) axes: [AxisConfig<S>; N],
    /// Declared soft limits. Those of `axes` are unlimited while an axis is not homed.
    soft_limits: [[Position; 2]; N],
    pub(super) rates: Rates,
    /// Declared sensors of the position loops.
    pub(super) sensors: [Sensors; N],
    /// The axis filters behind the path, as declared and in machine units.
    pub(super) smoothing: [Smoothing; N],
    pub(super) filters: Filters<N>,
    /// Whether an axis has a gain schedule.
    pub(super) is_scheduled: bool,
    /// Whether the positions of each axis are absolute.
    pub(super) are_homed: [bool; N],
    pub(super) schedules: [Option<Schedule<S>>; N],
    /// The gantry of each axis that is the second motor of one.
    pub(super) gantries: [Option<GantryConfig>; N],
}

impl<S: Scalar, const N: usize> MachineConfig<S, N> {
    /// Checks and converts settings.
    ///
    /// # Errors
    /// [`MachineError::Config`] with the axis and the setting, [`MachineError::Path`] for an axis filter behind the path.
    pub fn new(rates: Rates, settings: &[AxisSettings; N]) -> Result<Self, MachineError> {
        let mut axes = heapless::Vec::<_, N>::new();
        let mut schedules = [None; N];
        for (axis, (settings, schedule)) in settings.iter().zip(&mut schedules).enumerate() {
            let rejected = |error| MachineError::Config { axis, error };
            // The capacity is the number of settings.
            let _ = axes.push(AxisConfig::new(settings, rates).map_err(rejected)?);
            *schedule = AxisConfig::schedule(settings, rates).map_err(rejected)?;
        }
        let smoothing = settings.each_ref().map(|axis| axis.smoothing);
        let filters = Filters::new(&smoothing, rates.position_loop_hz())?;
        let sensors = settings.each_ref().map(|axis| axis.sensors);
        let gantries = GantryConfig::of_axes(settings, rates)
            .map_err(|(axis, error)| MachineError::Config { axis, error })?;
        let axes: [AxisConfig<S>; N] = core::array::from_fn(|i| axes[i]);
        let soft_limits = axes.each_ref().map(|axis| axis.monitor.travel);
        let is_scheduled = schedules.iter().any(Option::is_some);
        Ok(Self {
            axes,
            soft_limits,
            rates,
            sensors,
            smoothing,
            filters,
            is_scheduled,
            are_homed: [true; N],
            schedules,
            gantries,
        })
    }

    /// Replaces the constants of an axis.
    pub(super) fn replace(&mut self, axis: usize, config: AxisConfig<S>, reference: Reference) {
        if let (Some(slot), Some(soft_limits)) = (self.axes.get_mut(axis), self.soft_limits.get_mut(axis)) {
            (*slot, *soft_limits) = (config, config.monitor.travel);
        }
        self.set_reference(axis, reference);
    }

    /// Replaces the schedule of an axis.
    pub(super) fn replace_schedule(&mut self, axis: usize, schedule: Option<Schedule<S>>) {
        if let Some(slot) = self.schedules.get_mut(axis) {
            *slot = schedule;
        }
        self.is_scheduled = self.schedules.iter().any(Option::is_some);
    }

    /// Applies the soft limits of an axis that is homed, and no other.
    pub(super) fn set_reference(&mut self, axis: usize, reference: Reference) {
        if let (Some(config), Some(soft_limits)) = (self.axes.get_mut(axis), self.soft_limits.get(axis)) {
            config.monitor.travel = match reference {
                Reference::Relative => UNLIMITED,
                Reference::Homed => *soft_limits,
            };
        }
        if let Some(is_homed) = self.are_homed.get_mut(axis) {
            *is_homed = reference == Reference::Homed;
        }
    }

    /// The axes with soft limits.
    pub(super) fn have_soft_limits(&self) -> [bool; N] {
        self.soft_limits.map(|travel| travel != UNLIMITED)
    }

    /// Least and greatest command of each axis.
    pub(super) fn travel(&self) -> [[Position; 2]; N] {
        self.axes.each_ref().map(|axis| axis.monitor.travel)
    }

    /// Deceleration of a stop along the path, the least of the axes: position units per position tick² with 16 fraction
    /// bits.
    pub(super) fn stop_deceleration(&self) -> u64 {
        self.axes.iter().map(|axis| axis.stop_deceleration).min().unwrap_or(u64::MAX)
    }
}
