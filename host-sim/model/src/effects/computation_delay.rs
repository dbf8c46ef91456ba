//! Computation delay: the force is output some periods after the readings from which it is computed.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext,
    Occurrence, Parameter, Range, Stage, Unit, Wording,
};
use crate::axis::{Drive, Settings};

/// What the velocity loop computes in one period is output at the start of the next one, or later. The logged force is the one that is
/// output, and acts at once; where it is logged as computed, the delay is a [`DriveDeadTime`](super::DriveDeadTime).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComputationDelay {
    /// Whole periods of the velocity loop from its readings to its output.
    pub periods: f64,
}

const DEAD_TIME: Imitation = Imitation {
    name: "drive_dead_time",
    clause: "the drive applies its force this time after the command",
    decided_by: "a force channel",
};

impl EffectModel for ComputationDelay {
    const NAME: &'static str = "computation_delay";
    const SUMMARY: &'static str = "the velocity loop outputs its force whole periods after its readings; the logged force is the output";
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("periods", Unit::One, Range::UpTo(8.0))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];
    const DRIVES: &'static [Drive] = &[Drive::Torque];

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    /// It is no candidate of a round: see [`Self::assumed`].
    fn initial_guesses(_context: &EffectContext<'_>) -> Vec<Self> {
        Vec::new()
    }

    /// The number of periods is not fitted.
    fn coordinates(&self) -> Vec<Coordinate> {
        Vec::new()
    }

    fn at(&self, _x: &[f64]) -> Self {
        self.clone()
    }

    /// While a period T accelerates the axis, the proportional force changes by Kv·T per acceleration, as that of a mass does.
    fn assumed() -> Vec<Self> {
        vec![Self { periods: 1.0 }, Self { periods: 2.0 }]
    }

    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.periods > 0.0
    }

    /// Only the force tells whether it is logged as computed or as output.
    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        if context.has(Stage::Force) { Vec::new() } else { vec![DEAD_TIME] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.periods]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::DELAY
    }

    fn sentence(&self, _wording: &Wording) -> String {
        let plural = if self.periods.to_bits() == 1f64.to_bits() { "" } else { "s" };
        format!("the velocity loop outputs its force {} period{plural} after its readings", self.periods)
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
