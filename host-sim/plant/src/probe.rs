//! The tool-point probe.

use model::effects::{ProbeGain, ProbeRotation};

/// The alignment of the tool-point probe.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Probe {
    /// Its angle about the third axis.
    pub rotation: ProbeRotation,
    /// Its error in proportion to the position.
    pub gain: ProbeGain,
}
