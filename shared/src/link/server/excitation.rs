//! The force of a frequency response, within the envelope.

use super::super::port::SharedDrive;
use super::super::refusal::{Refusal, SettingProblem};
use super::state::ServerState;
use crate::excitation::{Excitation, ExcitationSettings};
use crate::scalar::Scalar;

/// The name of the limit of the envelope.
const LIMIT: &str = "excitation_limit_n";

impl<const N: usize> ServerState<N> {
    /// Checks a force and starts it.
    #[inline(never)]
    pub(super) fn excite<'m, S: Scalar>(
        &self,
        settings: &ExcitationSettings,
        drive: &mut impl SharedDrive<'m, S, N>,
    ) -> Result<(), Refusal> {
        let ExcitationSettings { axis, force_n, .. } = *settings;
        let envelope = self.identity.envelope.axes.get(usize::from(axis)).ok_or(Refusal::NoSuchAxis)?;
        let ceiling = envelope.excitation_limit_n;
        if force_n > ceiling {
            let problem = SettingProblem::AboveCeiling { value: force_n, ceiling };
            return Err(Refusal::Setting { axis, name: LIMIT.chars().collect(), problem });
        }
        let excitation = Excitation::new(settings).map_err(Refusal::Excitation)?;
        drive.with(|drive| drive.start_excitation(excitation, force_n))
    }
}
