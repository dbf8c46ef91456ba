//! The result of a self-test as plain text: sentences and tables.

use super::confusion::Confusion;
use super::judgement_text;
use super::kind_table;
use super::outside::Answer;
use super::score::Outcome;
use super::summary::{Proportion, Spread, Summary};

/// The statistics in sentences.
#[must_use]
pub fn sentences(seed: u64, summary: &Summary) -> Vec<String> {
    let Summary { clean, outside, duplicates, coverage, .. } = summary;
    let mut sentences = vec![exact_sentence(seed, summary.exact), found_sentence(summary)];
    let ambiguous = summary.false_finds - summary.certain_false_finds;
    if ambiguous > 0 {
        let are = if ambiguous == 1 { "is" } else { "are" };
        sentences.push(format!("Of the false effects, {ambiguous} {are} called ambiguous."));
    }
    if *duplicates > 0 {
        sentences.push(format!(
            "{} {} found a second time on {} axis; the score counts each once.",
            counted(*duplicates, "effect"),
            was_or_were(*duplicates),
            if *duplicates == 1 { "its" } else { "their" }
        ));
    }
    if clean.trials > 0 {
        let machines = counted(clean.trials, "machine");
        sentences
            .push(format!("Of {machines} without an undeclared effect, {} had no effect found.", clean.hits));
    }
    if outside.trials > 0 {
        sentences.push(format!(
            "Of {} from outside the catalogue {} {} described as unexplained.",
            counted(outside.trials, "effect"),
            outside.hits,
            was_or_were(outside.hits)
        ));
    }
    sentences.extend(named_sentence(summary));
    if coverage.trials > 0 {
        sentences.push(parameter_sentence(summary));
    }
    sentences
}

fn exact_sentence(seed: u64, exact: Proportion) -> String {
    let [low, high] = exact.interval();
    format!(
        "{} drawn from seed {seed}: in {} of them exactly the undeclared effects were found ({}, 95 % interval {} \
         to {}).",
        counted(exact.trials, "machine"),
        exact.hits,
        percent(exact.fraction()),
        percent(low),
        percent(high)
    )
}

fn found_sentence(Summary { found, false_finds, .. }: &Summary) -> String {
    format!(
        "Of {} {} {} found and {} missed; {false_finds} false {effects} {were} found.",
        counted(found.trials, "effect"),
        found.hits,
        was_or_were(found.hits),
        found.trials - found.hits,
        effects = if *false_finds == 1 { "effect" } else { "effects" },
        were = was_or_were(*false_finds)
    )
}

/// What was said about things from outside the catalogue in the other kinds, and about faults of the data.
fn named_sentence(Summary { named, described, false_faults, .. }: &Summary) -> Option<String> {
    if named.trials == 0 && *false_faults == 0 {
        return None;
    }
    Some(format!(
        "Of {} and faults of the data {} {} named and {} described; {} {} found.",
        counted(named.trials, "other deviation"),
        named.hits,
        was_or_were(named.hits),
        described.hits,
        counted(*false_faults, "false fault"),
        was_or_were(*false_faults)
    ))
}

fn parameter_sentence(Summary { coverage, error, .. }: &Summary) -> String {
    let [low, high] = coverage.interval();
    format!(
        "Parameter errors: median {}, 95 % quantile {}. {} of {} 95 % confidence intervals contain the true value \
         ({}, interval {} to {}).",
        fine_percent(error.median),
        fine_percent(error.percentile95),
        coverage.hits,
        coverage.trials,
        percent(coverage.fraction()),
        percent(low),
        percent(high)
    )
}

/// A count with its noun: `1 effect`, `2 effects`.
pub(super) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

fn was_or_were(count: usize) -> &'static str {
    if count == 1 { "was" } else { "were" }
}

/// Incorrect cases, confusions, parameters, residuals; `seconds` is the time that each outcome took, s.
#[must_use]
pub fn tables(outcomes: &[Outcome], seconds: &[f64], summary: &Summary) -> String {
    let mut lines = Vec::new();
    if kind_table::is_needed(outcomes) {
        lines.extend([kind_table::text(outcomes, seconds), String::new()]);
    }
    let judged = judgement_text::text(outcomes);
    if !judged.is_empty() {
        lines.extend([judged, String::new()]);
    }
    for outcome in outcomes.iter().filter(|outcome| !is_right(outcome)) {
        if let Some(why) = &outcome.refusal {
            lines.push(format!("{}: refused: {why}", outcome.name()));
            continue;
        }
        let (there, found) = true_and_found(outcome);
        lines.push(format!("{}: true {there}; found {found}", outcome.name()));
    }
    let wrong = |(row, column, count): (&str, &str, usize)| {
        (count > 0 && !Confusion::is_right(row, column)).then(|| format!("{count:>5} × {row} → {column}"))
    };
    let confusions: Vec<String> = summary.confusion.cells().filter_map(wrong).collect();
    if !confusions.is_empty() {
        lines.push(String::new());
        lines.extend(confusions);
    }
    lines.push(format!("\n{:<48}{:>6}{:>12}{:>12}{:>14}", "parameter", "n", "error", "95 %", "in interval"));
    for p in &summary.parameters {
        let name = format!("{} {}", p.effect, p.parameter);
        let Spread { count, median, percentile95 } = p.error;
        let covered = p.coverage.map_or_else(|| "–".to_owned(), hits_of_trials);
        lines.push(format!(
            "{name:<48}{count:>6}{:>12}{:>12}{covered:>14}",
            fine_percent(median),
            fine_percent(percentile95)
        ));
    }
    lines.push(format!(
        "\n{:<48}{:>6}{:>12}{:>12}",
        "residual after / noise, held out", "n", "median", "95 %"
    ));
    for (channel, Spread { count, median, percentile95 }) in &summary.ratios {
        lines.push(format!("{channel:<48}{count:>6}{median:>12.2}{percentile95:>12.2}"));
    }
    lines.join("\n") + "\n"
}

/// Whether a case is correct: every effect found once, every effect from outside the catalogue described or, in the other
/// kinds, named, and no false fault of the data.
#[must_use]
pub fn is_right(outcome: &Outcome) -> bool {
    outcome.is_exact()
        && outcome.duplicates() == 0
        && outcome.described.iter().all(|&described| described)
        && outcome.counted_answers().all(|answer| answer.is_named)
        && outcome.false_faults().is_empty()
}

/// The true effects and the effects found, as lists in words.
#[must_use]
pub fn true_and_found(outcome: &Outcome) -> (String, String) {
    let or_nothing = |names: Vec<String>| {
        if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
    };
    let extras = outcome.answers.iter().map(|answer| &answer.extra);
    let there = outcome.truths.iter().chain(extras);
    let there = there.map(|truth| format!("{} on {}", truth.name, truth.axis)).collect();
    let mut found: Vec<String> =
        outcome.found.iter().map(|(name, axis)| format!("{name} on {axis}")).collect();
    let described = outcome.outside().filter(|(_, described)| *described);
    found.extend(described.map(|(truth, _)| format!("{} on {} (as unexplained)", truth.name, truth.axis)));
    let faults = outcome.faults.iter().map(|fault| &fault.name);
    found.extend(faults.map(|(kind, axis)| format!("{kind} on {axis} (a fault of the data)")));
    let unexplained = outcome.counted_answers().filter(|a| a.names.is_empty() && a.is_described());
    found.extend(
        unexplained.map(|Answer { extra, .. }| format!("{} on {} (as unexplained)", extra.name, extra.axis)),
    );
    (or_nothing(there), or_nothing(found))
}

/// `12 of 13`.
fn hits_of_trials(proportion: Proportion) -> String {
    format!("{} of {}", proportion.hits, proportion.trials)
}

/// A fraction in whole percent.
pub(super) fn percent(fraction: f64) -> String {
    if fraction.is_nan() { "–".to_owned() } else { format!("{:.0} %", 100.0 * fraction) }
}

/// A relative error in percent with two digits.
fn fine_percent(error: f64) -> String {
    match 100.0 * error {
        p if p.is_nan() => "–".to_owned(),
        p if p >= 10.0 => format!("{p:.0} %"),
        p if p >= 1.0 => format!("{p:.1} %"),
        p if p >= 0.1 => format!("{p:.2} %"),
        p => format!("{p:.3} %"),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::score::tests::{found, truth};
    use super::*;

    #[test]
    fn an_incorrect_case_is_listed() {
        let truths = [truth("windup", "x", &[("stiffness_n_per_um", 100.0)])];
        let trace = json!({"effects": [found("stribeck", "x", &json!({}))]});
        let outcomes = [Outcome::new(7, &truths, &trace)];
        let text = tables(&outcomes, &[], &Summary::new(&outcomes));
        assert!(text.contains("case 7: true windup on x; found stribeck on x"), "{text}");
        assert!(text.contains("1 × windup → stribeck"), "{text}");
    }

    #[test]
    fn a_single_effect_is_counted_in_the_singular() {
        let truths = [truth("windup", "x", &[])];
        let trace =
            json!({"effects": [found("windup", "x", &json!({})), found("stribeck", "x", &json!({}))]});
        let sentences = sentences(1, &Summary::new(&[Outcome::new(7, &truths, &trace)]));
        assert!(sentences[0].starts_with("1 machine drawn from seed 1: in 0 of them "), "{sentences:?}");
        assert_eq!(sentences[1], "Of 1 effect 1 was found and 0 missed; 1 false effect was found.");
    }

    #[test]
    fn errors_have_two_digits() {
        assert_eq!(
            [0.000_123, 0.0034, 0.034, 0.34].map(fine_percent),
            ["0.012 %", "0.34 %", "3.4 %", "34 %"]
        );
    }
}
