//! Velocity filter: the velocity of the velocity loop passes a first-order filter.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Found, Occurrence, Parameter,
    Range, Stage, Substitute, Timing, Unit, Wording,
};

use crate::axis::{Drive, Settings};

/// The velocity loop uses the backward difference behind a first-order low-pass, as drives have it against the noise of their
/// encoders. The kind of [`super::VelocityLag`] that is longer than a period of the loop.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VelocityFilter {
    /// τ of the low-pass 1/(τs + 1).
    pub time_constant_ms: f64,
}

/// Longest time constant, ms.
const LONGEST_MS: f64 = 20.0;

/// Smallest mean age of the velocity, in periods of the loop.
const MIN_AGE: f64 = 0.7;

impl VelocityFilter {
    /// τ, s. Finite differences at zero evaluate a negative one, which counts as none.
    #[must_use]
    pub fn time_constant_s(&self) -> f64 {
        1e-3 * self.time_constant_ms.max(0.0)
    }

    /// The filter with a mean age of the velocity, in periods of the loop, which are of this length: the inverse of
    /// [`Self::exceeds_tolerance`]'s equation.
    fn of_age(age: f64, tick_ms: f64) -> Self {
        Self { time_constant_ms: tick_ms / libm::log((1.0 + age) / age) }
    }
}

impl EffectModel for VelocityFilter {
    const NAME: &'static str = "velocity_lag";
    const SUMMARY: &'static str = "first-order filter of the velocity that the velocity loop uses";
    const DISTINGUISHING_KEY: Option<&'static str> = Some("time_constant_ms");
    const SPECIAL_FORM_OF: Option<&'static str> = Some("velocity_lag");
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("time_constant_ms", Unit::Millisecond, Range::UpTo(LONGEST_MS))];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];
    const DRIVES: &'static [Drive] = &[Drive::Torque];

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let times_ms: &[f64] = if context.has(Stage::Motor) { &[0.4, 1.5] } else { &[] };
        times_ms.iter().map(|&time_constant_ms| Self { time_constant_ms }).collect()
    }

    /// Beside a delay of the loop, the fit of an age alone ends where the delay is too short, from where the filter differs little.
    fn in_place_of(found: &Found<'_>) -> Option<Substitute<Self>> {
        let older_ms = found.value("ms").filter(|ms| found.name == Self::NAME && *ms > 0.0)?;
        Some(Substitute::alone(Self::of_age((older_ms / found.tick_ms()).max(MIN_AGE), found.tick_ms())))
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::between(self.time_constant_ms, 0.02, 0.0, LONGEST_MS)]
    }

    /// Mean age T·q/(1 − q) with q = e^(−T/τ), from which the filter is told from a mean of two readings, which is half a period T
    /// old: that is a [`super::VelocityLag`].
    fn exceeds_tolerance(&self, _declared: &Settings, rates: Rates) -> bool {
        let left = libm::exp(-1.0 / (rates.velocity_loop_hz * self.time_constant_s()));
        left / (1.0 - left) > MIN_AGE
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { time_constant_ms: x[0] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.time_constant_ms]
    }

    fn timing(&self) -> Option<Timing> {
        Some(Timing::VelocityAge)
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::VELOCITY_READING
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the velocity of the velocity loop passes a filter with a time constant of {}",
            wording.value(0)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp behind y += (1 − q)·(x − y), with q = e^(−T/τ), is q/(1 − q) periods T late.
    #[test]
    fn a_filter_has_the_age_with_which_it_is_made() {
        for age in [0.7, 1.2, 5.0] {
            let left = (-0.25 / VelocityFilter::of_age(age, 0.25).time_constant_ms).exp();
            assert!((left / (1.0 - left) / age - 1.0).abs() < 1e-12, "{age}");
        }
    }
}
