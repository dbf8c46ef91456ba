//! The statistics of each kind of cases, a row for each: as text and on the page.

use std::ops::Range;

use maud::{Markup, html};
use numerics::quantile;

use crate::kind::Kind;
use crate::score::Outcome;
use crate::summary::{Summary, by_kind};
use pages::markup::{Column, note, number_cell, table};

/// Headings of the columns after that of the kind, with the widths of the text.
const HEADINGS: [(&str, usize); 13] = [
    ("cases", 6),
    ("exact", 7),
    ("missed", 8),
    ("false, sure", 13),
    ("ambiguous", 11),
    ("named", 14),
    ("described", 14),
    ("false faults", 14),
    ("intervals", 14),
    ("table", 8),
    ("force", 8),
    ("motor", 8),
    ("tool", 8),
];

const NOTE: &str = "False, sure: names of effects that are not there, stated as certain; ambiguous: such names that the \
                    trace does not state as certain. Named: effects from outside the textbook catalogue, and faults of the data, that were given their \
                    name; described: named, or reported as unexplained on their axis. False faults: reported faults \
                    of the data that are not there. Intervals: 95 % confidence intervals that contain the true \
                    value.";

/// Name of the last row.
const ALL: &str = "all";

/// Whether the outcomes need the table: for the textbook kind alone, the summary says the same.
#[must_use]
pub fn is_needed(outcomes: &[Outcome]) -> bool {
    outcomes.iter().any(|outcome| outcome.kind != Kind::Textbook)
}

/// The rows: kind and figures; the last is that of all kinds.
fn rows(outcomes: &[Outcome]) -> Vec<(&'static str, [String; HEADINGS.len()])> {
    let row = |(kind, outcomes): (Kind, Vec<Outcome>)| (kind.name(), figures(&Summary::new(&outcomes)));
    let all = (ALL, figures(&Summary::new(outcomes)));
    by_kind(outcomes).into_iter().map(row).chain([all]).collect()
}

fn figures(summary: &Summary) -> [String; HEADINGS.len()] {
    let of = |hits: usize, trials: usize| {
        if trials == 0 { "–".to_owned() } else { format!("{hits} of {trials}") }
    };
    let median = |channel: &str| {
        let spread = summary.ratios.iter().find(|(name, _)| *name == channel);
        spread
            .filter(|(_, spread)| spread.count > 0)
            .map_or_else(|| "–".to_owned(), |(_, s)| format!("{:.2}", s.median))
    };
    [
        summary.exact.trials.to_string(),
        summary.exact.hits.to_string(),
        (summary.found.trials - summary.found.hits).to_string(),
        summary.certain_false_finds.to_string(),
        (summary.false_finds - summary.certain_false_finds).to_string(),
        of(summary.named.hits, summary.named.trials),
        of(summary.described.hits, summary.described.trials),
        summary.false_faults.to_string(),
        of(summary.coverage.hits, summary.coverage.trials),
        median("table"),
        median("force"),
        median("motor"),
        median("tool"),
    ]
}

/// The table as text; `seconds` is the time that each outcome took, s, of which the last column has the median.
///
/// The JSON and the page have no times, so that the same seed gives the same files.
#[must_use]
pub fn text(outcomes: &[Outcome], seconds: &[f64]) -> String {
    let headings = HEADINGS.map(|(heading, _)| heading.to_owned());
    let mut lines = vec![line("kind", &headings, "seconds")];
    lines.extend(rows(outcomes).into_iter().map(|(kind, figures)| {
        let is_of_kind = |outcome: &Outcome| kind == ALL || outcome.kind.name() == kind;
        let timed = outcomes.iter().zip(seconds);
        let own: Vec<f64> = timed.filter(|(outcome, _)| is_of_kind(outcome)).map(|(_, &s)| s).collect();
        line(kind, &figures, &format!("{:.1}", quantile(&own, 0.5)))
    }));
    lines.join("\n")
}

fn line(first: &str, figures: &[String; HEADINGS.len()], last: &str) -> String {
    let cells = figures.iter().zip(HEADINGS).map(|(figure, (_, width))| format!("{figure:>width$}"));
    format!("{first:<12}{}{last:>9}", cells.collect::<String>())
}

/// The first columns, those of names; the others are those of the channels.
const NAME_COLUMNS: usize = 9;

/// The table on the page, in two parts, because it would be wider than the page.
pub fn markup(outcomes: &[Outcome]) -> Markup {
    html! {
        (note(NOTE))
        (part(outcomes, 0..NAME_COLUMNS))
        (note("Residual after / noise on held-out logs, median."))
        (part(outcomes, NAME_COLUMNS..HEADINGS.len()))
    }
}

/// The table with some of its columns.
fn part(outcomes: &[Outcome], columns: Range<usize>) -> Markup {
    let headings = HEADINGS[columns.clone()].iter().map(|&(heading, _)| Column::Numbers(heading));
    let headings: Vec<Column> = [Column::Words("kind")].into_iter().chain(headings).collect();
    let body = html! {
        @for (kind, figures) in rows(outcomes) {
            tr {
                th scope="row" { (kind) }
                @for figure in &figures[columns.clone()] { (number_cell(figure)) }
            }
        }
    };
    table("Statistics by kind", &headings, &body)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::score::tests::{found, truth};
    use super::*;

    #[test]
    fn the_table_has_a_row_for_each_kind_that_occurs() {
        let truths = [truth("windup", "x", &[])];
        let textbook = Outcome::new(1, &truths, &json!({"effects": [found("windup", "x", &json!({}))]}));
        assert!(!is_needed(std::slice::from_ref(&textbook)));
        let other = Outcome { kind: Kind::Many, ..Outcome::new(1, &truths, &json!({})) };
        let outcomes = [textbook, other];
        assert!(is_needed(&outcomes));
        let text = text(&outcomes, &[1.0, 3.0]);
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
        // Kind, cases, exact, missed, false and sure, false and ambiguous.
        assert_eq!(lines[1][..6], ["textbook", "1", "1", "0", "0", "0"]);
        assert_eq!(lines[2][..6], ["many", "1", "0", "1", "0", "0"]);
        assert_eq!(lines[3][..6], ["all", "2", "1", "1", "0", "0"]);
        assert_eq!(lines.len(), 4);
        // The time of the case of each kind; the median of two by nearest rank is the lower one.
        let seconds: Vec<&str> = lines.iter().filter_map(|line| line.last().copied()).collect();
        assert_eq!(seconds, ["seconds", "1.0", "3.0", "1.0"]);
        // Two parts, each with headings and a row for each kind and for all; 1 + 9 and 1 + 4 cells a row.
        let html = markup(&outcomes).into_string();
        assert_eq!((html.matches("<tr>").count(), html.matches("<td").count()), (8, 3 * 13));
    }
}
