//! A mode of the tool whose damping took the place of a late reading.
//!
//! Far below its frequency ω a mode delays by 2ζ/ω. If the reading of the tool is late as well, the fit of the mode alone ends at a
//! damping ratio that is too high, from where no latency improves it. Once all effects are found, such a mode is tried with little
//! damping and a latency.

use super::replacement::better;
use crate::fit::fit_data::FitData;
use crate::fit::least_squares::Fitted;
use crate::fit::scope::Scope;
use model::effects::{Channel, Effect, Latency, Resonance};

/// Damping ratio from which the fit starts, as structures have it.
const START: f64 = 0.04;

/// The fit with a mode and a late reading in place of a mode with more damping, if that explains the logs better.
#[must_use]
pub fn with_delayed_mode(data: &FitData<'_>, base: Fitted, scope: &Scope) -> Fitted {
    let is_late = |effect: &Effect| matches!(effect, Effect::Latency(late) if late.channel == Channel::Tool);
    let mode = base.model.found().iter().enumerate().find_map(|(index, effect)| match effect {
        Effect::Resonance(mode) if scope.holds(effect) && mode.damping_ratio > 2.0 * START => {
            Some((index, mode))
        }
        _ => None,
    });
    let Some((index, mode)) = mode.filter(|_| !base.model.axis.effect.iter().any(is_late)) else {
        return base;
    };
    let omega = std::f64::consts::TAU * mode.frequency_hz;
    let late_ms = 1e3 * 2.0 * (mode.damping_ratio - START) / omega;
    let less_damped = Effect::Resonance(Resonance { damping_ratio: START, ..mode.clone() });
    let late = Effect::Latency(Latency { channel: Channel::Tool, ms: late_ms });
    let start = base.model.without(index).with(late).with(less_damped);
    better(data, base, &start, scope)
}
