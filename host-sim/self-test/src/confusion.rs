//! The confusion matrix of effects.

use serde_json::{Map, Value, json};

use super::outside::{self, Answer};
use super::score::Outcome;
use super::truth::{NAMES, OUTSIDE, Truth};

/// Row of false effects that no missed effect accounts for.
pub const NOTHING: &str = "nothing";
/// Column of effects that were not found under any name.
pub const MISSED: &str = "missed";
/// Column of effects from outside the catalogue that the trace describes as unexplained.
pub const DESCRIBED: &str = "unexplained";

/// How often the effect of a row was found as the effect of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Confusion {
    /// Truths: the textbook catalogue, what is outside it, what else occurs, [`NOTHING`].
    pub rows: Vec<&'static str>,
    /// Findings: the catalogue, faults of the data that occur, [`DESCRIBED`], [`MISSED`].
    pub columns: Vec<&'static str>,
    /// Counts by row and column.
    pub counts: Vec<Vec<usize>>,
}

impl Confusion {
    /// Counts all outcomes. A false effect is attributed to an effect that was missed on its axis, each missed effect
    /// once, or to [`NOTHING`] if none was missed.
    #[must_use]
    pub fn new(outcomes: &[Outcome]) -> Self {
        let mut rows: Vec<&str> = NAMES.into_iter().chain(OUTSIDE).collect();
        for truth in outcomes.iter().flat_map(all_truths) {
            if !rows.contains(&truth.name) {
                rows.push(truth.name);
            }
        }
        rows.push(NOTHING);
        // The tracer's catalogue may have more effects than are drawn.
        let more = trace::effect_names().into_iter().filter(|name| !NAMES.contains(name));
        let is_reported = |kind: &&str| outcomes.iter().any(|o| o.faults.iter().any(|f| f.name.0 == **kind));
        let faults = outside::FAULT_KINDS.into_iter().filter(is_reported);
        let columns: Vec<&str> =
            NAMES.into_iter().chain(more).chain(faults).chain([DESCRIBED, MISSED]).collect();
        let counts = vec![vec![0; columns.len()]; rows.len()];
        let mut confusion = Self { rows, columns, counts };
        for outcome in outcomes {
            confusion.add(outcome);
        }
        confusion
    }

    fn add(&mut self, outcome: &Outcome) {
        for truth in outcome.truths.iter().filter(|truth| outcome.finds(truth)) {
            self.count(truth.name, truth.name);
        }
        let (described, undescribed): (Vec<_>, Vec<_>) =
            outcome.outside().partition(|(_, described)| *described);
        for (truth, _) in described {
            self.count(truth.name, DESCRIBED);
        }
        let mut missed = outcome.missed();
        missed.extend(undescribed.iter().map(|(truth, _)| *truth));
        for answer in &outcome.answers {
            match column_of(answer) {
                Some(column) => self.count(answer.extra.name, column),
                None if outside::counts(&answer.extra) => missed.push(&answer.extra),
                None => {}
            }
        }
        for (name, axis) in outcome.false_finds().into_iter().chain(outcome.false_faults()) {
            let cause = missed.iter().position(|truth| truth.axis == axis);
            let row = cause.map_or(NOTHING, |index| missed.remove(index).name);
            self.count(row, name);
        }
        for truth in missed {
            self.count(truth.name, MISSED);
        }
    }

    fn count(&mut self, row: &str, column: &str) {
        let position = |names: &[&str], name: &str| names.iter().position(|n| *n == name);
        if let Some((row, column)) = position(&self.rows, row).zip(position(&self.columns, column)) {
            self.counts[row][column] += 1;
        }
    }

    /// Count of a row and a column; 0 if there is none of that name.
    #[must_use]
    pub fn of(&self, row: &str, column: &str) -> usize {
        let mut cells = self.cells();
        cells.find(|(r, c, _)| *r == row && *c == column).map_or(0, |(_, _, count)| count)
    }

    /// Row, column and count of every cell, row by row.
    pub fn cells(&self) -> impl Iterator<Item = (&'static str, &'static str, usize)> {
        let row = |(row, counts): (&'static str, Vec<usize>)| {
            self.columns.iter().zip(counts).map(move |(&column, count)| (row, column, count))
        };
        self.rows.iter().copied().zip(self.counts.clone()).flat_map(row)
    }

    /// Whether a cell counts correct results.
    #[must_use]
    pub fn is_right(row: &str, column: &str) -> bool {
        row == column || column == DESCRIBED || outside::is_name(row, column)
    }

    /// Rows by name, each with the cells that are not 0.
    #[must_use]
    pub fn json(&self) -> Value {
        let row = |&row: &&'static str| {
            let cells = self.cells().filter(|(r, _, count)| *r == row && *count > 0);
            let cells: Map<String, Value> =
                cells.map(|(_, column, count)| (column.to_owned(), json!(count))).collect();
            (row.to_owned(), Value::Object(cells))
        };
        Value::Object(self.rows.iter().map(row).collect())
    }
}

/// True effects of an outcome, and what else was in the machine.
fn all_truths(outcome: &Outcome) -> impl Iterator<Item = &Truth> {
    let extras = outcome.answers.iter().map(|answer| &answer.extra);
    outcome.truths.iter().chain(extras)
}

/// The column of something outside the catalogue: its name, otherwise what was reported for it.
fn column_of(answer: &Answer) -> Option<&str> {
    let name = answer.names.iter().find(|name| outside::is_name(answer.extra.name, name));
    let unexplained = answer.is_unexplained.then_some(DESCRIBED);
    name.map(String::as_str).or(unexplained).or(answer.names.first().map(String::as_str))
}

#[cfg(test)]
mod tests {
    use super::super::score::tests::{found, truth};
    use super::*;

    #[test]
    fn a_false_find_is_attributed_to_an_effect_missed_on_its_axis() {
        let truths = [truth("windup", "x", &[]), truth("backlash", "y", &[]), truth("stribeck", "x", &[])];
        let effects = [
            found("stribeck", "x", &json!({})),
            found("latency", "x", &json!({})),
            found("intalk", "x", &json!({})),
        ];
        let confusion = Confusion::new(&[Outcome::new(1, &truths, &json!({"effects": effects}))]);
        assert_eq!(confusion.of("stribeck", "stribeck"), 1);
        assert_eq!(confusion.of("windup", "latency"), 1);
        assert_eq!(confusion.of(NOTHING, "intalk"), 1);
        assert_eq!(confusion.of("backlash", MISSED), 1);
        assert_eq!(confusion.cells().map(|(_, _, count)| count).sum::<usize>(), 4);
    }

    #[test]
    fn an_effect_outside_the_catalogue_is_described_confused_or_missed() {
        let truths = [truth("vibration", "x", &[("frequency_hz", 60.0)])];
        let of = |trace: Value| Confusion::new(&[Outcome::new(1, &truths, &trace)]);
        let described = of(json!({"unexplained": [{"axis": "x", "variable": "time", "frequency_hz": 60.2}]}));
        assert_eq!(described.of("vibration", DESCRIBED), 1);
        let confused = of(json!({"effects": [found("resonance", "x", &json!({}))]}));
        assert_eq!(confused.of("vibration", "resonance"), 1);
        assert_eq!(of(json!({})).of("vibration", MISSED), 1);
    }
}
