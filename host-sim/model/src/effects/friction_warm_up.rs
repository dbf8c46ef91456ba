//! Friction warm-up: friction is higher after the start and falls while lubricant and bearings warm up.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Neighbours, Occurrence, Parameter,
    Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Adds force·exp(−t/τ) to the sliding level of the guideway, where t is the time on the session clock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionWarmUp {
    /// Change of friction at time zero of the session; positive: friction falls.
    pub force_n: f64,
    /// τ.
    pub time_constant_s: f64,
}

impl Default for FrictionWarmUp {
    /// No change; the time constant is that of a short warm-up.
    fn default() -> Self {
        Self { force_n: 0.0, time_constant_s: 30.0 }
    }
}

impl FrictionWarmUp {
    /// Whether the force is not zero.
    #[must_use]
    #[inline]
    pub fn changes(&self) -> bool {
        self.force_n != 0.0
    }

    /// Change of the sliding level, N, at a time on the session clock.
    #[must_use]
    #[inline]
    pub fn rise_n(&self, time_s: f64) -> f64 {
        self.force_n * libm::exp(-time_s / self.time_constant_s)
    }
}

impl EffectModel for FrictionWarmUp {
    const NAME: &'static str = "friction_warm_up";
    const SUMMARY: &'static str = "friction is higher by force·exp(−t/τ), t on the session clock";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("force_n", Unit::Newton, Range::Signed),
        Parameter::new("time_constant_s", Unit::Second, Range::Positive),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force, Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::masses(axis)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let times_s: &[f64] = if context.axis.has_mass() { &[6.0, 30.0, 150.0] } else { &[] };
        times_s.iter().map(|&time_constant_s| Self { force_n: 0.0, time_constant_s }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.force_n, 1.0, 1e5), Coordinate::scale(self.time_constant_s, 0.5, 5e3)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { force_n: x[0], time_constant_s: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.force_n, self.time_constant_s]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::FRICTION
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "friction is {} {} at the start of the session and approaches its declared value with a time constant of {}",
            wording.size(0),
            wording.by_sign("higher", "lower"),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Time
    }
}
