//! Parts are taken one by one, each the one that gains most in its time.

use model::machine::Machine;
use motion::{Block, Motion};
use rayon::prelude::*;

use crate::candidates::{self, Candidate};
use crate::information::Information;
use crate::unknowns::Unknowns;
use crate::{ExpectedPair, ExpectedValue, Limits, Plan};

/// A pair is decided from this many standard deviations on: neighbouring samples share what the model does not describe, which the noise of
/// the sensors does not have.
const DECIDED: f64 = 15.0;

/// Up to this many standard deviations it is worth moving longer.
const WANTED: f64 = 2.0 * DECIDED;

/// An interval that is this many times as wide as the value tells nothing of it.
const TELLS_NOTHING: f64 = 10.0;

/// The parts are run this often, so that a log has laps to fit and one to hold out.
const LAPS: u8 = 2;

/// Greatest number of times that a part is taken.
const MAX_TAKEN: usize = 4;

/// What gains less than this of what is wanted is not worth its time.
const LEAST_GAIN: f64 = 1e-3;

/// Rest at the start, s.
const START_REST_S: f64 = 0.5;

/// The motion that decides what is open in a model. Values whose interval in the model is wider than `within` of them, on either side, are to
/// be narrowed to it.
#[must_use]
pub fn plan(model: &Machine, limits: &Limits, within: f64) -> Plan {
    let unknowns = Unknowns::of(model);
    let known = Information::known(&unknowns);
    let values = Values::of(model, within);
    let nothing = values.wanted().next().is_none() && unknowns.pairs.is_empty();
    let candidates = if nothing { Vec::new() } else { candidates::all(limits) };
    let told: Vec<(&Candidate, Information)> = candidates
        .par_iter()
        .filter_map(|candidate| Some((candidate, Information::of(model, &unknowns, candidate)?)))
        .collect();
    let goal = Goal { model, unknowns: &unknowns, values: &values };
    let open = goal.open_axes();
    let is_first = |part: &Candidate| part.whole_travel_of.as_ref().is_some_and(|axis| open.contains(axis));
    let first: Vec<usize> = (0..told.len()).filter(|index| is_first(told[*index].0)).collect();
    let (taken, information) = greedy(&told, first, known, &goal, limits.seconds);
    let parts: Vec<&Candidate> = taken.iter().map(|index| told[*index].0).collect();
    let seconds = START_REST_S + f64::from(LAPS) * parts.iter().map(|part| part.seconds).sum::<f64>();
    Plan {
        motion: motion(&parts),
        seconds: if parts.is_empty() { 0.0 } else { seconds },
        parts: parts.iter().map(|part| part.name.clone()).collect(),
        pairs: goal.pairs(&information),
        values: goal.values(&information),
        not_by_motion: unknowns.not_by_motion.clone(),
        notes: Vec::new(),
    }
}

/// Indices of the parts that are taken, in their order, beginning with some, and what they tell together.
fn greedy(
    told: &[(&Candidate, Information)],
    first: Vec<usize>,
    known: Information,
    goal: &Goal,
    seconds: f64,
) -> (Vec<usize>, Information) {
    let mut left_s = (seconds - START_REST_S) / f64::from(LAPS);
    let (mut taken, mut information) = (Vec::new(), known);
    for index in first {
        if told[index].0.seconds <= left_s {
            left_s -= told[index].0.seconds;
            information = information.with(&told[index].1, f64::from(LAPS));
            taken.push(index);
        }
    }
    loop {
        let score = goal.score(&information);
        let gains = told.par_iter().enumerate().filter_map(|(index, (candidate, own))| {
            let is_free = taken.iter().filter(|other| **other == index).count() < MAX_TAKEN;
            (is_free && candidate.seconds <= left_s).then(|| {
                let with = information.with(own, f64::from(LAPS));
                let gain = goal.score(&with) - score;
                (index, with, gain, gain / candidate.seconds)
            })
        });
        let best = gains.max_by(|a, b| a.3.total_cmp(&b.3).then(b.0.cmp(&a.0)));
        match best {
            Some((index, with, gain, _)) if gain > LEAST_GAIN => {
                left_s -= told[index].0.seconds;
                taken.push(index);
                information = with;
            }
            _ => return (taken, information),
        }
    }
}

/// All parts in a row, in each lap.
fn motion(parts: &[&Candidate]) -> Option<Motion> {
    let start_mm = parts.first()?.motion.start_mm.clone();
    let lap = || parts.iter().flat_map(|part| part.motion.blocks.iter().cloned());
    let rest = Block::Dwell { seconds: START_REST_S };
    let blocks = std::iter::once(rest).chain((0..LAPS).flat_map(|_| lap())).collect();
    Some(Motion { name: "plan".to_owned(), start_mm, blocks })
}

/// A value of an effect of the model.
struct OfEffect {
    axis: usize,
    effect: usize,
    index: usize,
    name: String,
    value: f64,
    before: Option<f64>,
    wanted: Option<f64>,
}

/// The values of all effects.
struct Values(Vec<OfEffect>);

impl Values {
    fn of(model: &Machine, within: f64) -> Self {
        let mut all = Vec::new();
        for (number, (axis, own)) in model.axis.iter().enumerate() {
            for (effect, declared) in own.effect.iter().enumerate() {
                let evidence = own.evidence.get(effect).filter(|known| known.effect == declared.name());
                let parameters = declared.declared_parameters();
                for (index, (value, parameter)) in declared.values().into_iter().zip(parameters).enumerate() {
                    let half = evidence.and_then(|known| known.half_widths.get(index)).copied();
                    // Not fitted, or one of many: neither open nor to be told.
                    if half == Some(0.0) || parameter.is_list {
                        continue;
                    }
                    let target = within * value.abs();
                    let wanted = half.filter(|half| *half > target).map(|_| target);
                    let name = format!("{axis}.{}.{}", declared.name(), parameter.key);
                    all.push(OfEffect { axis: number, effect, index, name, value, before: half, wanted });
                }
            }
        }
        Self(all)
    }

    fn wanted(&self) -> impl Iterator<Item = (&OfEffect, f64)> {
        self.0.iter().filter_map(|value| Some((value, value.wanted?)))
    }
}

/// What a plan is for.
struct Goal<'a> {
    model: &'a Machine,
    unknowns: &'a Unknowns,
    values: &'a Values,
}

impl Goal<'_> {
    /// How much of what is wanted is reached: 1 for each pair and each value that is. Logarithms, so that a first part counts that is not
    /// enough alone.
    fn score(&self, information: &Information) -> f64 {
        let reached = |ratio: f64| (1.0 + 100.0 * ratio.clamp(0.0, 1.0)).ln() / 101_f64.ln();
        let pairs: f64 = information.distances().iter().map(|distance| reached(distance / WANTED)).sum();
        let half = |value: &OfEffect| {
            information.half_widths(self.model, self.unknowns, value.axis, value.effect)[value.index]
        };
        pairs + self.values.wanted().map(|(value, wanted)| reached(wanted / half(value))).sum::<f64>()
    }

    /// Axes of which something is open.
    fn open_axes(&self) -> Vec<String> {
        let pairs = self.unknowns.pairs.iter().map(|pair| pair.axis);
        let open = pairs.chain(self.values.wanted().map(|(value, _)| value.axis));
        open.filter_map(|axis| Some(self.model.axis.get_index(axis)?.0.clone())).collect()
    }

    fn pairs(&self, information: &Information) -> Vec<ExpectedPair> {
        let pairs = self.unknowns.pairs.iter().zip(information.distances());
        pairs
            .filter_map(|(pair, distance)| {
                let (axis, own) = self.model.axis.get_index(pair.axis)?;
                let effects = [own.effect[pair.effect].name(), pair.rival.name()];
                Some(ExpectedPair { axis: axis.clone(), effects, distance, is_decided: distance >= DECIDED })
            })
            .collect()
    }

    fn values(&self, information: &Information) -> Vec<ExpectedValue> {
        let expected = |value: &OfEffect| {
            let halves = information.half_widths(self.model, self.unknowns, value.axis, value.effect);
            ExpectedValue {
                name: value.name.clone(),
                value: value.value,
                half_width_before: value.before,
                half_width: Some(halves[value.index])
                    .filter(|half| *half < TELLS_NOTHING * value.value.abs()),
                wanted: value.wanted,
            }
        };
        self.values.0.iter().map(expected).collect()
    }
}
