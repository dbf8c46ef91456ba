//! An axis that follows a counter, within the settings of the axis.

use super::super::port::SharedDrive;
use super::super::refusal::Refusal;
use super::block_limits::SPEED_SHARE;
use super::state::ServerState;
use crate::interpolate::following::FollowSettings;
use crate::scalar::Scalar;

impl<const N: usize> ServerState<N> {
    /// Checks the speed against that of the axis, which is within the envelope, and starts to follow.
    #[inline(never)]
    pub(super) fn follow<'m, S: Scalar>(
        &self,
        axis: u8,
        following: &FollowSettings,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let settings = self.settings.axes.get(usize::from(axis)).ok_or(Refusal::NoSuchAxis)?;
        if let Some(limit_m_per_s) = settings.fastest_m_per_s.map(|fastest| SPEED_SHARE * fastest)
            && following.speed_m_per_s > limit_m_per_s
        {
            return Err(Refusal::TooFast { block: 0, axis, limit_m_per_s });
        }
        drive.with(|drive| drive.follow(usize::from(axis), following))
    }
}
