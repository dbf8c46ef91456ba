//! The judgements of the kinds `sensors` and `sparse`: a row for each error or gap, then the cases with something false and sure.

use super::judgement::Judgement;
use super::outside::Named;
use super::score::Outcome;

const HEADINGS: [(&str, usize); 11] = [
    ("cases", 6),
    ("exact", 6),
    ("sure", 6),
    ("values", 7),
    ("beyond", 7),
    ("unsure", 7),
    ("missed", 7),
    ("named", 8),
    ("said", 8),
    ("intervals", 10),
    ("unfit", 6),
];

/// The rows of all errors and gaps that occur, with their sum and the names in their cases; empty for the other kinds.
#[must_use]
pub fn text(outcomes: &[Outcome]) -> String {
    let judged: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.subject().is_some()).collect();
    if judged.is_empty() {
        return String::new();
    }
    let mut subjects: Vec<&str> = Vec::new();
    for subject in judged.iter().filter_map(|outcome| outcome.subject()) {
        if !subjects.contains(&subject) {
            subjects.push(subject);
        }
    }
    let of =
        |subject: &str| judged.iter().copied().filter(|o| o.subject() == Some(subject)).collect::<Vec<_>>();
    let mut lines = vec![line("error or gap", &HEADINGS.map(|(heading, _)| heading.to_owned()), "")];
    lines.extend(subjects.iter().map(|subject| row(subject, &of(subject))));
    lines.push(row("all", &judged));
    lines.extend(
        judged
            .iter()
            .filter(|outcome| outcome.judgement.is_surely_false())
            .map(|outcome| false_line(outcome)),
    );
    lines.join("\n")
}

fn row(first: &str, outcomes: &[&Outcome]) -> String {
    let count =
        |of: fn(&Judgement) -> usize| outcomes.iter().map(|o| of(&o.judgement)).sum::<usize>().to_string();
    let cases = |is: fn(&Judgement) -> bool| outcomes.iter().filter(|o| is(&o.judgement)).count().to_string();
    let extras: usize = outcomes.iter().map(|outcome| outcome.answers.len()).sum();
    let estimates = || outcomes.iter().flat_map(|outcome| &outcome.estimates).filter(|e| !e.is_declared());
    let held = estimates().filter(|estimate| estimate.is_covered()).count();
    let figures = [
        outcomes.len().to_string(),
        cases(Judgement::is_exact),
        count(|j| j.sure_false.len()),
        count(|j| j.wrong_values.len()),
        count(|j| j.false_statements.len()),
        count(|j| j.unsure_false.len()),
        count(|j| j.missed.len()),
        format!("{}/{extras}", count(|j| j.named.len())),
        format!("{}/{extras}", count(|j| j.said.len())),
        format!("{held}/{}", estimates().count()),
        cases(|j| j.verdict == "model_does_not_fit"),
    ];
    let lists = |of: fn(&Judgement) -> &Vec<Named>| counted(outcomes.iter().flat_map(|o| of(&o.judgement)));
    let mut words = Vec::new();
    for (word, list) in [
        ("sure", lists(|j| &j.sure_false)),
        ("values", lists(|j| &j.wrong_values)),
        ("beyond", lists(|j| &j.false_statements)),
        ("unsure", lists(|j| &j.unsure_false)),
        ("missed", lists(|j| &j.missed)),
    ] {
        if !list.is_empty() && first != "all" {
            words.push(format!("{word}: {list}"));
        }
    }
    line(first, &figures, &words.join("; "))
}

fn line(first: &str, figures: &[String; HEADINGS.len()], words: &str) -> String {
    let cells: String =
        figures.iter().zip(HEADINGS).map(|(figure, (_, width))| format!("{figure:>width$}")).collect();
    format!("{first:<18}{cells}  {words}").trim_end().to_owned()
}

/// Names with their counts, without the axes.
fn counted<'a>(pairs: impl Iterator<Item = &'a Named>) -> String {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for (name, _) in pairs {
        match counts.iter_mut().find(|(known, _)| known == name) {
            Some((_, count)) => *count += 1,
            None => counts.push((name, 1)),
        }
    }
    let words = counts
        .into_iter()
        .map(|(name, count)| if count == 1 { name.to_owned() } else { format!("{count} {name}") });
    words.collect::<Vec<_>>().join(", ")
}

/// What is false and sure in a case.
fn false_line(outcome: &Outcome) -> String {
    let Judgement { sure_false, wrong_values, false_statements, .. } = &outcome.judgement;
    let list = |word: &str, pairs: &[Named]| {
        let pairs: Vec<String> = pairs.iter().map(|(name, axis)| format!("{name} on {axis}")).collect();
        (!pairs.is_empty()).then(|| format!("{word}: {}", pairs.join(", ")))
    };
    let lists = [
        list("sure and false", sure_false),
        list("wrong value", wrong_values),
        list("called beyond tolerance", false_statements),
    ];
    let kind_case = outcome.kind.case_name(outcome.number);
    let subject = outcome.subject().unwrap_or_default();
    format!("{kind_case} ({subject}): {}", lists.into_iter().flatten().collect::<Vec<_>>().join("; "))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::kind::Kind;
    use super::super::score::tests::truth;
    use super::*;

    #[test]
    fn each_error_has_a_row_and_a_sure_false_name_its_case() {
        let rotated = [truth("probe_rotated", "x", &[])];
        let trace = json!({"effects": [{"name": "squareness", "axis": "x", "parameters": {}}]});
        let outcome = Outcome::new(5, &[], &trace).with_kind(Kind::Sensors, &rotated, &trace);
        let text = text(&[outcome.clone(), Outcome { kind: Kind::Textbook, ..outcome }]);
        let lines: Vec<&str> = text.lines().collect();
        let row: Vec<&str> = lines[1].split_whitespace().collect();
        assert_eq!(row[..5], ["probe_rotated", "1", "0", "1", "0"], "{text}");
        assert!(lines[1].ends_with("sure: squareness"), "{text}");
        assert_eq!(lines[3], "sensors-5 (probe_rotated): sure and false: squareness on x");
        assert_eq!(lines.len(), 4);
    }
}
