//! Frictional memory: friction follows a change of speed late.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectContext, EffectModel, Neighbours, Occurrence, Parameter, Prerequisite, Range,
    Stage, Unit, Wording,
};
use crate::axis::Settings;

/// A part c of viscous friction goes with the speed of before (the lubricant's film takes time):
/// c·(m − |v|) on top of the sliding level, where m follows |v| with a time constant. At a speed that
/// stays it is nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionMemory {
    /// c.
    pub viscous_n_s_per_m: f64,
    /// Of m.
    pub time_constant_s: f64,
}

impl Default for FrictionMemory {
    fn default() -> Self {
        Self { viscous_n_s_per_m: 0.0, time_constant_s: 0.1 }
    }
}

impl FrictionMemory {
    /// Whether there is any.
    #[must_use]
    #[inline]
    pub fn remembers(&self) -> bool {
        self.viscous_n_s_per_m != 0.0
    }

    /// Change of the sliding level (N) at a velocity, when it has lately been a speed (m/s).
    #[must_use]
    #[inline]
    pub fn rise_n(&self, velocity: f64, lately: f64) -> f64 {
        self.viscous_n_s_per_m * (lately - velocity.abs())
    }

    /// Share by which the memory comes up to the present speed in a step.
    #[must_use]
    pub fn share(&self, step_s: f64) -> f64 {
        if self.remembers() { -(-step_s / self.time_constant_s).exp_m1() } else { 0.0 }
    }
}

impl EffectModel for FrictionMemory {
    const NAME: &'static str = "friction_memory";
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
            // Far from here the derivative is another one: no step goes beyond a factor of two.
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

    fn sentence(&self, wording: &Wording) -> String {
        let how = wording.by_sign("behind", "ahead of");
        format!("{} of viscous friction are {how} the speed, by {}", wording.size(0), wording.value(1))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
