//! When two entries of effects are the same effect.

use model::effects::Effect;

/// Whether two entries are the same effect with other parameters: equal name, and equal source or channel where it has
/// one.
#[must_use]
pub fn is_same(a: &Effect, b: &Effect) -> bool {
    match (a, b) {
        (Effect::Crosstalk(a), Effect::Crosstalk(b)) => a.source == b.source,
        (Effect::Straightness(a), Effect::Straightness(b)) => a.source == b.source,
        (Effect::Latency(a), Effect::Latency(b)) => a.channel == b.channel,
        _ => a.name() == b.name(),
    }
}
