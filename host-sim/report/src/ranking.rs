//! The candidates of each round: their gain on held-out data, and the reason why each was added or not.

use maud::{Markup, html};

use super::parameters;
use files::format::{fixed, percent, significant};
use files::log::Unit;
use pages::markup::{note, number_cell, table_with, text};
use trace::AxisIdentification;
use trace::fit::normal_equations::FOLDS;
use trace::judge::found_effect::FoundEffect;
use trace::options::SearchOptions;
use trace::search::candidates::Candidate;
use trace::search::held_out::Comparison;
use trace::search::round::Round;
use trace::stages::stage_names;

/// Most candidates of a round that are shown.
const MAX_SHOWN: usize = 6;

const NOTE: &str = "In each round every effect of the catalogue is tested on the remaining residual. The most \
                    promising candidates are fitted with all other parameters free, and evaluated on held-out parts \
                    of the fit logs. Gain: reduction of the residual there, in the stage that the candidate \
                    improves most. The best supported candidate is added, and the next round begins.";

/// The section's body; empty without rounds.
#[must_use]
pub fn body(axes: &[AxisIdentification]) -> Markup {
    let tables = html! {
        @for axis in axes { (table_of_axis(axis)) }
    };
    if tables.0.is_empty() {
        return tables;
    }
    html! { (note(NOTE)) (tables) }
}

fn table_of_axis(axis: &AxisIdentification) -> Markup {
    let rounds = html! {
        @for (round, number) in axis.rounds.iter().zip(round_numbers(axis)) { (rows_of_round(axis, round, number)) }
    };
    if rounds.0.is_empty() {
        return rounds;
    }
    let parts = html! {
        colgroup { col; col; col; col; }
        thead {
            tr {
                th scope="col" { "candidate" }
                th scope="col" colspan="2" { "gain" }
                th scope="col" { "verdict" }
            }
        }
        (rounds)
    };
    html! {
        h3 { "Axis " (text(&axis.axis)) }
        (table_with("ranking", &format!("Candidates of axis {}", axis.axis), &parts))
    }
}

/// Number of each round, counted from 1 for each search (rounds in a row about the same stages).
fn round_numbers(axis: &AxisIdentification) -> Vec<usize> {
    let searches = axis.rounds.chunk_by(|a, b| a.stages == b.stages);
    searches.flat_map(|rounds| 1..=rounds.len()).collect()
}

fn rows_of_round(axis: &AxisIdentification, round: &Round, number: usize) -> Markup {
    let fitted = round.candidates.iter().enumerate().filter(|(_, candidate)| best(candidate).is_some());
    let rows = html! {
        @for (i, candidate) in fitted.take(MAX_SHOWN) {
            (row(axis.unit, candidate, &verdict(axis, round, i), round.added == Some(i)))
        }
    };
    if rows.0.is_empty() {
        return rows;
    }
    let heading = format!("{}, round {number}", stage_names(&round.stages));
    html! {
        tbody {
            tr { th colspan="4" scope="rowgroup" { (text(&heading)) } }
            (rows)
        }
    }
}

fn row(unit: Unit, candidate: &Candidate, verdict: &str, is_added: bool) -> Markup {
    let gain = best(candidate).map_or(0.0, gain_percent);
    let shown = if gain < -999.5 { "far worse".to_owned() } else { format!("{} %", fixed(gain, 1)) };
    let class = if is_added { "taken" } else { "left" };
    html! {
        tr {
            td { (text(&parameters::brief(&candidate.effect, unit == Unit::Degree))) }
            (number_cell(&shown))
            td {
                svg.bar viewBox="0 0 100 8" preserveAspectRatio="none" aria-hidden="true" {
                    rect class=(class) x="0" y="1" width=(fixed(gain.clamp(0.0, 100.0), 1)) height="6" {}
                }
            }
            td { (text(verdict)) }
        }
    }
}

/// The comparison of the stage that a candidate improves most on held-out data; none if it was not fitted.
fn best(candidate: &Candidate) -> Option<&Comparison> {
    candidate.comparison.iter().max_by(|a, b| a.reduction.total_cmp(&b.reduction))
}

/// Reduction of the rms residual in percent; a comparison has that of its square.
fn gain_percent(comparison: &Comparison) -> f64 {
    numerics::rms_reduction_percent(comparison.reduction)
}

/// Candidates with a large gain in the last round of each search that were not added, with the reason. None that was added in the end: it was not in
/// that stage alone.
#[must_use]
pub fn refused(axis: &AxisIdentification) -> Vec<String> {
    let last_rounds = axis.rounds.iter().filter(|round| round.added.is_none());
    let sentence = |round: &Round| {
        let index = round.refused()?;
        let effect = &round.candidates[index].effect;
        if axis.found.iter().any(|found| found.effect.is_same(effect)) {
            return None;
        }
        let brief = parameters::brief(effect, axis.unit == Unit::Degree);
        Some(format!(
            "{}, {}: not added, although it explains a large part of the residual: {brief}; {}.",
            axis.axis,
            stage_names(&round.stages),
            verdict(axis, round, index)
        ))
    };
    last_rounds.filter_map(sentence).collect()
}

/// The first applicable reason why a candidate of a round was added or not; empty if it was not fitted.
fn verdict(axis: &AxisIdentification, round: &Round, index: usize) -> String {
    let candidate = &round.candidates[index];
    let Some(best) = best(candidate) else { return String::new() };
    if round.added == Some(index) {
        return verdict_of_added(axis, candidate).to_owned();
    }
    if let Some(limit) = &candidate.limit {
        return format!("{} is the limit of its search range", significant(limit.limit, 3));
    }
    if candidate.is_supported(&round.options) {
        // The best supported candidate is added, unless it makes the closed loop worse.
        let is_vetoed = round.added.is_none_or(|added| index < added);
        let why = if is_vetoed { "makes the closed loop worse" } else { "another candidate is better" };
        return format!("supported, but {why}");
    }
    if !candidate.exceeds_tolerance {
        return "too small: within the tolerance of the declared model".to_owned();
    }
    verdict_of_unsupported(candidate, best, &round.options)
}

/// The final result for a candidate that its round added.
fn verdict_of_added(axis: &AxisIdentification, candidate: &Candidate) -> &'static str {
    let is_among = |all: &[FoundEffect]| all.iter().any(|found| found.effect.is_same(&candidate.effect));
    if is_among(&axis.found) {
        "added"
    } else if is_among(&axis.refuted) {
        "added; refuted by the logs held out"
    } else if axis.refused.iter().any(|limit| limit.effect.is_same(&candidate.effect)) {
        "added; dropped because the final fit reached a limit of its search range"
    } else {
        "added; dropped because a later effect made it unnecessary"
    }
}

/// Which condition of support a candidate misses.
fn verdict_of_unsupported(candidate: &Candidate, best: &Comparison, options: &SearchOptions) -> String {
    let is_supported =
        |c: &Comparison| c.reduction >= options.min_reduction && c.t >= c.min_t && c.folds_better == FOLDS;
    if best.reduction <= 0.0 {
        "increases the residual".to_owned()
    } else if best.reduction < options.min_reduction {
        format!("too small: below {} %", fixed(numerics::rms_reduction_percent(options.min_reduction), 0))
    } else if candidate.comparison.iter().any(is_supported) {
        let worst = numerics::min(candidate.comparison.iter().map(|c| c.worst_log)).min(0.0);
        format!("worse by {} on another log or stage", percent(100.0 * ((1.0 - worst).sqrt() - 1.0)))
    } else if best.folds_better < FOLDS {
        format!("better in only {} of {FOLDS} parts of the logs", best.folds_better)
    } else {
        format!("not significant: {} standard errors, below {}", fixed(best.t, 1), fixed(best.min_t, 1))
    }
}
