//! The result of a self-test for people: sentences, then tables of plain text.

use super::confusion::Confusion;
use super::score::Outcome;
use super::summary::{Share, Spread, Summary};

/// What came out.
#[must_use]
pub fn sentences(seed: u64, summary: &Summary) -> Vec<String> {
    let Summary { exact, found, clean, outside, coverage, error, .. } = summary;
    let [low, high] = exact.interval();
    let mut said = vec![
        format!(
            "{} machines drawn from seed {seed}: in {} of them exactly the undeclared effects were found ({}, 95 % interval \
             {} to {}).",
            exact.trials,
            exact.hits,
            percent(exact.share()),
            percent(low),
            percent(high)
        ),
        format!(
            "Of {} effects {} were found and {} missed; {} were found that were not there.",
            found.trials,
            found.hits,
            found.trials - found.hits,
            summary.false_ones
        ),
    ];
    if summary.doubled > 0 {
        said.push(format!(
            "{} effects were found a second time on their axis, which the score takes for one.",
            summary.doubled
        ));
    }
    if clean.trials > 0 {
        said.push(format!("Of {} machines as declared {} came out clean.", clean.trials, clean.hits));
    }
    if outside.trials > 0 {
        let (there, known) = (outside.trials, outside.hits);
        said.push(format!(
            "Of {there} effects from outside the catalogue {known} were described as unexplained."
        ));
    }
    if coverage.trials > 0 {
        let [low, high] = coverage.interval();
        said.push(format!(
            "Parameters are off by {} in the median, {} in 95 of 100; {} of {} 95 % confidence intervals hold the truth \
             ({}, interval {} to {}).",
            fine_percent(error.median),
            fine_percent(error.most),
            coverage.hits,
            coverage.trials,
            percent(coverage.share()),
            percent(low),
            percent(high)
        ));
    }
    said
}

/// Cases that are not exact, what was taken for what, parameters, residuals.
#[must_use]
pub fn tables(outcomes: &[Outcome], summary: &Summary) -> String {
    let mut lines = Vec::new();
    for outcome in outcomes.iter().filter(|outcome| !is_right(outcome)) {
        let (there, found) = sets(outcome);
        lines.push(format!("case {}: there was {there}; found {found}", outcome.number));
    }
    let wrong = |(row, column, count): (&str, &str, usize)| {
        (count > 0 && !Confusion::is_right(row, column)).then(|| format!("{count:>5} × {row} → {column}"))
    };
    let mistakes: Vec<String> = summary.confusion.cells().filter_map(wrong).collect();
    if !mistakes.is_empty() {
        lines.push(String::new());
        lines.extend(mistakes);
    }
    lines.push(format!("\n{:<48}{:>6}{:>12}{:>12}{:>14}", "parameter", "n", "error", "95 %", "in interval"));
    for p in &summary.parameters {
        let name = format!("{} {}", p.effect, p.parameter);
        let Spread { count, median, most } = p.error;
        let covered = p.coverage.map_or_else(|| "–".to_owned(), said_share);
        lines.push(format!(
            "{name:<48}{count:>6}{:>12}{:>12}{covered:>14}",
            fine_percent(median),
            fine_percent(most)
        ));
    }
    lines.push(format!(
        "\n{:<48}{:>6}{:>12}{:>12}",
        "residual after / noise, held out", "n", "median", "95 %"
    ));
    for (channel, Spread { count, median, most }) in &summary.ratios {
        lines.push(format!("{channel:<48}{count:>6}{median:>12.2}{most:>12.2}"));
    }
    lines.join("\n") + "\n"
}

/// Whether there is nothing to say about a case: everything found once, everything strange described.
#[must_use]
pub fn is_right(outcome: &Outcome) -> bool {
    outcome.is_exact() && outcome.doubled() == 0 && outcome.said.iter().all(|&said| said)
}

/// What there was and what was found, in words.
#[must_use]
pub fn sets(outcome: &Outcome) -> (String, String) {
    let or_nothing = |names: Vec<String>| {
        if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
    };
    let there = outcome.truths.iter().map(|truth| format!("{} on {}", truth.name, truth.axis)).collect();
    let mut found: Vec<String> =
        outcome.found.iter().map(|(name, axis)| format!("{name} on {axis}")).collect();
    let described = outcome.outside().filter(|(_, said)| *said);
    found.extend(described.map(|(truth, _)| format!("something like {} on {}", truth.name, truth.axis)));
    (or_nothing(there), or_nothing(found))
}

/// `12 of 13`.
#[must_use]
pub fn said_share(share: Share) -> String {
    format!("{} of {}", share.hits, share.trials)
}

/// Whole percent of a share.
#[must_use]
pub fn percent(share: f64) -> String {
    if share.is_nan() { "–".to_owned() } else { format!("{:.0} %", 100.0 * share) }
}

/// Percent of an error, to two digits.
#[must_use]
pub fn fine_percent(error: f64) -> String {
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
    fn a_mistake_is_said_with_its_case() {
        let truths = [truth("windup", "x", &[("stiffness_n_per_um", 100.0)])];
        let trace = json!({"effects": [found("stribeck", "x", &json!({}))]});
        let outcomes = [Outcome::new(7, &truths, &trace)];
        let said = tables(&outcomes, &Summary::new(&outcomes));
        assert!(said.contains("case 7: there was windup on x; found stribeck on x"), "{said}");
        assert!(said.contains("1 × windup → stribeck"), "{said}");
    }

    #[test]
    fn errors_have_two_digits() {
        assert_eq!(
            [0.000_123, 0.0034, 0.034, 0.34].map(fine_percent),
            ["0.012 %", "0.34 %", "3.4 %", "34 %"]
        );
    }
}
