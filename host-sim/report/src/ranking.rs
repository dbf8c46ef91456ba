//! The candidates of each round: what each is worth on held-out data, and why it was taken or not.

use super::markup::{note, text};
use super::number::{fixed, percent, significant};
use super::parameters;
use super::words::rotary;
use files::log::Unit;
use trace::axis::{AxisTrace, Found, is_same, stage_names};
use trace::candidates::{Candidate, LEAST_REDUCTION, LEAST_T};
use trace::held_out::{Comparison, FOLDS};
use trace::search::Round;

/// Most candidates of a round that are shown.
const SHOWN: usize = 6;

/// The section's body.
pub fn body(axes: &[AxisTrace]) -> String {
    let tables: String = axes.iter().map(of_axis).collect();
    if tables.is_empty() {
        return tables;
    }
    let what = "In each round every effect of the catalogue is tried on what is left, the most promising are fitted \
                with everything else free, and held against parts of the fit logs that the fit did not see. Gain: by \
                how much the residual of the stage that it helps most gets smaller there. The best that is supported \
                is added, and the next round begins.";
    note(what) + &tables
}

fn of_axis(axis: &AxisTrace) -> String {
    let mut number = 0;
    let mut last: &[_] = &[];
    let mut rounds = String::new();
    for round in &axis.rounds {
        number = if round.stages == last { number + 1 } else { 1 };
        last = &round.stages;
        rounds += &of_round(axis, round, number);
    }
    if rounds.is_empty() {
        return rounds;
    }
    format!(
        "<h3>Axis {}</h3>\n<table class=\"ranking\">\n<colgroup><col><col><col><col></colgroup>\n<thead><tr><th scope=\"col\">candidate</th><th scope=\"col\" \
         colspan=\"2\">gain</th><th scope=\"col\">verdict</th></tr></thead>\n{rounds}</table>\n",
        text(&axis.axis)
    )
}

fn of_round(axis: &AxisTrace, round: &Round, number: usize) -> String {
    let fitted = round.candidates.iter().enumerate().filter(|(_, candidate)| best(candidate).is_some());
    let row = |(i, candidate)| row(axis.unit, candidate, &verdict(axis, round, i), round.added == Some(i));
    let rows: String = fitted.take(SHOWN).map(row).collect();
    if rows.is_empty() {
        return rows;
    }
    let heading = text(&format!("{}, round {number}", stage_names(&round.stages)));
    format!("<tbody>\n<tr><th colspan=\"4\" scope=\"rowgroup\">{heading}</th></tr>\n{rows}</tbody>\n")
}

fn row(unit: Unit, candidate: &Candidate, verdict: &str, is_added: bool) -> String {
    let gain = best(candidate).map_or(0.0, gain_percent);
    let shown = if gain < -999.5 { "far worse".to_owned() } else { format!("{} %", fixed(gain, 1)) };
    let brief = parameters::brief(&candidate.effect);
    let brief = if unit == Unit::Degree { rotary(&brief) } else { brief };
    let class = if is_added { "taken" } else { "left" };
    let width = fixed(gain.clamp(0.0, 100.0), 1);
    let bar = format!(
        "<svg class=\"bar\" viewBox=\"0 0 100 8\" preserveAspectRatio=\"none\" aria-hidden=\"true\"><rect \
         class=\"{class}\" x=\"0\" y=\"1\" width=\"{width}\" height=\"6\"/></svg>"
    );
    format!(
        "<tr><td>{}</td><td class=\"n\">{}</td><td>{bar}</td><td>{}</td></tr>\n",
        text(&brief),
        text(&shown),
        text(verdict)
    )
}

/// The stage that a candidate helps most, on held-out data; none if it was not fitted.
fn best(candidate: &Candidate) -> Option<&Comparison> {
    candidate.comparison.iter().max_by(|a, b| a.reduction.total_cmp(&b.reduction))
}

/// By how much the residual itself gets smaller, percent; comparisons are of its square.
fn gain_percent(comparison: &Comparison) -> f64 {
    numerics::rms_reduction_percent(comparison.reduction)
}

/// What would have gained much in the last round of each search, and why it was not taken.
#[must_use]
pub fn refused(axis: &AxisTrace) -> Vec<String> {
    let last = axis.rounds.iter().filter(|round| round.added.is_none());
    let said = |round: &Round| {
        let place = round.refused()?;
        let candidate = &round.candidates[place];
        let brief = parameters::brief(&candidate.effect);
        let brief = if axis.unit == Unit::Degree { rotary(&brief) } else { brief };
        Some(format!(
            "{}, {}: not taken, though it explains much: {brief}; {}.",
            axis.axis,
            stage_names(&round.stages),
            verdict(axis, round, place)
        ))
    };
    last.filter_map(said).collect()
}

/// Why the candidate at a place of a round was added or not, the first reason that holds.
fn verdict(axis: &AxisTrace, round: &Round, place: usize) -> String {
    let candidate = &round.candidates[place];
    let Some(best) = best(candidate) else { return String::new() };
    if round.added == Some(place) {
        let is_among = |all: &[Found]| all.iter().any(|found| is_same(&found.effect, &candidate.effect));
        let said = if is_among(&axis.found) {
            "added"
        } else if is_among(&axis.refuted) {
            "added; refuted by the logs held out"
        } else if axis.refused.iter().any(|limit| is_same(&limit.effect, &candidate.effect)) {
            "added; dropped when the last fits drove it to a limit of its search"
        } else {
            "added; dropped when a later one made it needless"
        };
        return said.to_owned();
    }
    if let Some(limit) = &candidate.limit {
        return format!("{} is the limit of its search", significant(limit.limit, 3));
    }
    let supported =
        |c: &Comparison| c.reduction >= LEAST_REDUCTION && c.t >= LEAST_T && c.folds_better == FOLDS;
    let least = numerics::rms_reduction_percent(LEAST_REDUCTION);
    if candidate.is_supported() {
        // The best that is supported is added, unless the closed loop speaks against it.
        let is_vetoed = round.added.is_none_or(|added| place < added);
        let why = if is_vetoed { "makes the closed loop worse" } else { "another one is better" };
        format!("supported here, but {why}")
    } else if !candidate.material {
        "too small to tell from what any model leaves open".to_owned()
    } else if best.reduction <= 0.0 {
        "makes it worse".to_owned()
    } else if best.reduction < LEAST_REDUCTION {
        format!("too small: below {} %", fixed(least, 0))
    } else if candidate.comparison.iter().any(supported) {
        let worst = numerics::min(candidate.comparison.iter().map(|c| c.worst_log)).min(0.0);
        format!("worse on another log or stage, by {}", percent(100.0 * ((1.0 - worst).sqrt() - 1.0)))
    } else if best.folds_better < FOLDS {
        format!("better in {} of {FOLDS} parts of the logs only", best.folds_better)
    } else {
        format!("may be chance: {} standard errors, below {}", fixed(best.t, 1), fixed(LEAST_T, 1))
    }
}
