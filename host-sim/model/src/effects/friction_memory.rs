//! Frictional memory: friction follows a change of speed with a delay.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Neighbours, Occurrence, Parameter,
    Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Adds c·(m − |v|) to the sliding level, where m is |v| after a first-order low-pass: a part c of viscous friction
/// depends on the previous speed, as the film of the lubricant builds up with a delay. The term is zero at constant speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionMemory {
    /// c.
    pub viscous_n_s_per_m: f64,
    /// Time constant of m.
    pub time_constant_s: f64,
}

impl Default for FrictionMemory {
    fn default() -> Self {
        Self { viscous_n_s_per_m: 0.0, time_constant_s: 0.1 }
    }
}

impl FrictionMemory {
    /// Whether c is not zero.
    #[must_use]
    #[inline]
    pub fn remembers(&self) -> bool {
        self.viscous_n_s_per_m != 0.0
    }

    /// Change of the sliding level, N, at a velocity and a filtered speed m, m/s.
    #[must_use]
    #[inline]
    pub fn rise_n(&self, velocity: f64, filtered_speed: f64) -> f64 {
        self.viscous_n_s_per_m * (filtered_speed - velocity.abs())
    }

    /// Fraction 1 − exp(−step/τ) of the difference |v| − m by which m changes in a step.
    #[must_use]
    pub fn share(&self, step_s: f64) -> f64 {
        if self.remembers() { -libm::expm1(-step_s / self.time_constant_s) } else { 0.0 }
    }
}

impl EffectModel for FrictionMemory {
    const NAME: &'static str = "friction_memory";
    const SUMMARY: &'static str =
        "friction changes by c·(m − |v|), where m follows |v| with the time constant";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("viscous_n_s_per_m", Unit::NewtonSecondPerMetre, Range::Signed),
        Parameter::new("time_constant_s", Unit::Second, Range::Positive),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];

    fn prerequisite(_axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::WITHOUT_TABLE
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let times_s: &[f64] = if context.shows_friction_alone() { &[0.01, 0.1, 0.5] } else { &[] };
        times_s.iter().map(|&time_constant_s| Self { viscous_n_s_per_m: 0.0, time_constant_s }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::signed(self.viscous_n_s_per_m, 5.0, 1e5),
            // The derivative depends strongly on the time constant: one step changes it by a factor of at most two.
            Coordinate::between(
                self.time_constant_s,
                0.05 * self.time_constant_s,
                0.5 * self.time_constant_s,
                2.0 * self.time_constant_s,
            )
            .stepwise(),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { viscous_n_s_per_m: x[0], time_constant_s: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.viscous_n_s_per_m, self.time_constant_s]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::LUBRICANT
    }

    fn sentence(&self, wording: &Wording) -> String {
        let relation = wording.by_sign("lag behind", "lead");
        format!(
            "{} of viscous friction {relation} the speed with a time constant of {}",
            wording.size(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
