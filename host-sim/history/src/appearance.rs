//! Effects that came or went.

use std::collections::BTreeSet;

use jiff::civil::Date;

use crate::record::{Group, Record, Trust};

/// Traces in a row that must have an effect, or not, before it is told: one may have missed it, or mistaken another for it.
const MIN_TRACES: usize = 2;

/// Whether an effect came or went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// It is certain in the last traces, and was not found before.
    Came,
    /// It was certain before, and is not found in the last traces.
    Went,
}

/// An effect that came or went.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Appearance {
    /// The axis.
    pub axis: String,
    /// The effect.
    pub effect: String,
    /// Which of both.
    pub turn: Turn,
    /// The last trace before.
    pub after: Date,
    /// The first trace since.
    pub since: Date,
}

/// How a trace found an effect.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Found {
    Certain,
    /// As one of several names, or with a value at a bound.
    Doubtful,
    No,
}

/// The effects that came or went and stayed so, by axis and name. Traces whose logs cannot show an effect say nothing of it; one that is
/// not found may still be there, smaller than what these logs show.
#[must_use]
pub fn of(records: &[Record]) -> Vec<Appearance> {
    let effects: BTreeSet<(String, String)> = records
        .iter()
        .flat_map(|record| record.figures.keys())
        .filter(|name| name.group == Group::Effect)
        .map(|name| (name.axis.clone(), name.of.clone()))
        .collect();
    effects.into_iter().filter_map(|effect| appearance(records, effect)).collect()
}

fn appearance(records: &[Record], effect: (String, String)) -> Option<Appearance> {
    let seen: Vec<(Date, Found)> = records
        .iter()
        .filter(|record| !record.not_testable.contains(&effect))
        .map(|record| (record.day, found(record, &effect)))
        .collect();
    let (turn, now, before) = match seen.last()?.1 {
        Found::Certain => (Turn::Came, Found::Certain, Found::No),
        Found::No => (Turn::Went, Found::No, Found::Certain),
        Found::Doubtful => return None,
    };
    let since = seen.iter().rposition(|(_, found)| *found != now)? + 1;
    let run = seen[..since].iter().rev().take_while(|(_, found)| *found == before).count();
    if seen.len() - since < MIN_TRACES || run < MIN_TRACES {
        return None;
    }
    let (axis, effect) = effect;
    Some(Appearance { axis, effect, turn, after: seen[since - 1].0, since: seen[since].0 })
}

fn found(record: &Record, (axis, effect): &(String, String)) -> Found {
    let own = record.figures.iter().filter(|(name, _)| name.axis == *axis && name.of == *effect);
    let trusts: Vec<Trust> = own.map(|(_, figure)| figure.trust).collect();
    match () {
        () if trusts.is_empty() => Found::No,
        () if trusts.iter().all(|trust| trust.is_counted()) => Found::Certain,
        () => Found::Doubtful,
    }
}
