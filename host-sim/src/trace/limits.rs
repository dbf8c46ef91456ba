//! Parameters that a fit drove to the limit of their search.
//!
//! The value that fits best then lies beyond the range, or the effect is another one than the log's. Either way the limit
//! is none of the machine's figures: the effect is not taken.

use shared::config::Rates;

use super::model::AxisModel;
use super::search::Round;
use crate::effects::Effect;

/// An effect of which a parameter stands at a limit of its search.
#[derive(Clone, Debug, PartialEq)]
pub struct AtLimit {
    /// The effect as it was fitted.
    pub effect: Effect,
    /// Name of the parameter, as in [`Effect::parameters`].
    pub parameter: &'static str,
    /// Its value, in the unit of its name.
    pub value: f64,
    /// The limit, in the same unit.
    pub limit: f64,
}

/// The first parameter of an effect that stands at a limit, on an axis with these loops.
#[must_use]
pub fn of(effect: &Effect, rates: Rates) -> Option<AtLimit> {
    let coordinates = effect.searched(rates);
    let at = coordinates.iter().enumerate().find_map(|(j, coordinate)| Some((j, coordinate.limit()?)));
    let (j, limit) = at?;
    // A coordinate is not always a parameter: of those it shapes the first is told.
    let moved = |to: f64| {
        let mut values: Vec<f64> = coordinates.iter().map(|coordinate| coordinate.value).collect();
        values[j] = to;
        effect.at(&values).parameters()
    };
    let inside = coordinates[j].value - coordinates[j].step.copysign(limit);
    let [there, elsewhere] = [limit, inside].map(moved);
    let is_shaped = |i: &usize| there[*i].1.to_bits() != elsewhere[*i].1.to_bits();
    let shaped = (0..there.len()).find(is_shaped)?;
    let (parameter, value) = effect.parameters()[shaped];
    Some(AtLimit { effect: effect.clone(), parameter, value, limit: there[shaped].1 })
}

/// The effects that the last round of a search would have taken, were it not for a limit.
#[must_use]
pub fn refused(rounds: &[Round]) -> Vec<AtLimit> {
    let last = rounds.iter().filter(|round| round.added.is_none());
    let candidates = last.flat_map(|round| &round.candidates).filter(|candidate| candidate.stands_out());
    candidates.filter_map(|candidate| candidate.limit.clone()).collect()
}

/// The first found effect of a model that stands at a limit: its index and the limit.
#[must_use]
pub fn first(model: &AxisModel) -> Option<(usize, AtLimit)> {
    (0..model.found().len()).find_map(|index| Some((index, model.at_limit(index)?)))
}
