//! Shear thinning: the friction of a lubricant increases with speed and saturates.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Neighbours, Occurrence, Parameter,
    Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;
use crate::friction_law::exponential_decay;

/// The sliding level is Coulomb friction − force·exp(−|v|/vs), the opposite of the Stribeck effect.
///
/// A part of the declared level is the force that shears the lubricant, whose viscosity decreases with the shear rate.
/// This part is force·(1 − exp(−|v|/vs)): zero at standstill, constant at high speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShearThinning {
    /// Reduction of the level at standstill.
    pub force_n: f64,
    /// vs.
    pub velocity_mm_s: f64,
}

impl Default for ShearThinning {
    fn default() -> Self {
        Self { force_n: 0.0, velocity_mm_s: 10.0 }
    }
}

impl ShearThinning {
    /// Reduction of the sliding level at a velocity, relative to high speed, N.
    #[must_use]
    #[inline]
    pub fn lack_n(&self, velocity_m_per_s: f64) -> f64 {
        if self.force_n == 0.0 {
            return 0.0;
        }
        self.force_n * exponential_decay(1e3 * velocity_m_per_s / self.velocity_mm_s)
    }
}

impl EffectModel for ShearThinning {
    const NAME: &'static str = "shear_thinning";
    const SUMMARY: &'static str =
        "sliding friction is reduced by force·exp(−|v|/vs): friction of the lubricant saturates with speed";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("force_n", Unit::Newton, Range::Signed),
        Parameter::new("velocity_mm_s", Unit::MillimetrePerSecond, Range::Positive),
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
        let speeds: &[f64] = if context.shows_friction_alone() { &[3.0, 12.0, 50.0] } else { &[] };
        speeds.iter().map(|&velocity_mm_s| Self { force_n: 0.0, velocity_mm_s }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::between(self.force_n, 2.0, 0.0, 1e5),
            Coordinate::between(self.velocity_mm_s, 0.05 * self.velocity_mm_s, 0.1, 300.0),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { force_n: x[0], velocity_mm_s: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.force_n, self.velocity_mm_s]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::LUBRICANT
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "sliding friction is {} lower at standstill and saturates with a characteristic velocity of {}",
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }
}
