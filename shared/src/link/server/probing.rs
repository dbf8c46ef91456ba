//! Probing, within the settings of the axis.

use super::super::port::SharedDrive;
use super::super::refusal::{Refusal, SettingProblem};
use super::block_limits::SPEED_SHARE;
use super::state::ServerState;
use crate::probing::ProbeSettings;
use crate::scalar::Scalar;

impl<const N: usize> ServerState<N> {
    /// Checks the speed and the distance of a probing against the settings of the axis, which are within the envelope, and starts it.
    #[inline(never)]
    pub(super) fn probe<'m, S: Scalar>(
        &self,
        axis: u8,
        probing: &ProbeSettings,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let settings = self.settings.axes.get(usize::from(axis)).ok_or(Refusal::NoSuchAxis)?;
        probing.check().map_err(Refusal::Probe)?;
        if let Some(limit_m_per_s) = settings.fastest_m_per_s.map(|fastest| SPEED_SHARE * fastest)
            && probing.speed_m_per_s > limit_m_per_s
        {
            return Err(Refusal::TooFast { block: 0, axis, limit_m_per_s });
        }
        // An axis that is not homed has no soft limits, but no longer a travel than one that is.
        let value = libm::fabs(probing.distance_m);
        if let Some(ceiling) = settings.travel_m.map(|[least_m, greatest_m]| greatest_m - least_m)
            && value > ceiling
        {
            let problem = SettingProblem::AboveCeiling { value, ceiling };
            return Err(Refusal::Setting { axis, name: "travel_m".chars().collect(), problem });
        }
        drive.with(|drive| drive.probe(usize::from(axis), probing))
    }
}
