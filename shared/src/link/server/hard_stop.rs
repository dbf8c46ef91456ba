//! Homing to a hard stop, within the settings of the axis.

use super::super::port::SharedDrive;
use super::super::refusal::{Refusal, SettingProblem};
use super::state::ServerState;
use crate::homing::{HardStopSettings, HomingError};
use crate::scalar::Scalar;

/// The part of the limits of following error and frozen encoder that the command may move on while the axis stands: the rest is for the
/// time in which the force rises.
const SHARE: f64 = 0.5;

impl<const N: usize> ServerState<N> {
    /// Checks a homing to a hard stop against the monitors of the axis, and starts it. The force limit of the axis is within the envelope.
    #[inline(never)]
    pub(super) fn home_to_stop<'m, S: Scalar>(
        &self,
        axis: u8,
        stop: &HardStopSettings,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let settings = self.settings.axes.get(usize::from(axis)).ok_or(Refusal::NoSuchAxis)?;
        stop.check().map_err(|error: HomingError| Refusal::Homing(error.into()))?;
        let way_m = stop.speed_m_per_s * stop.standstill_s;
        let frozen_m = settings.sensors.frozen_encoder_limit_m().unwrap_or(f64::INFINITY);
        let limits = [
            ("force_limit_n", libm::fabs(stop.force_n), settings.force_limit_n),
            ("saturation_time_s", stop.standstill_s, settings.saturation_time_s),
            ("following_error_limit_m", way_m, SHARE * settings.following_error_limit_m),
            ("frozen_encoder_limit_m", way_m, SHARE * frozen_m),
        ];
        for (name, value, ceiling) in limits {
            if value > ceiling {
                let problem = SettingProblem::AboveCeiling { value, ceiling };
                return Err(Refusal::Setting { axis, name: name.chars().collect(), problem });
            }
        }
        drive.with(|drive| drive.home_to_stop(usize::from(axis), stop))
    }
}
