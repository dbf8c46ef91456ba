//! The plan for a terminal: a sentence, what is decided, what is narrowed, the parts.

use files::format::{significant, with_spread};

use crate::{ExpectedPair, ExpectedValue, Plan};

/// All lines.
#[must_use]
pub fn of(plan: &Plan) -> String {
    let mut parts = vec![lead(plan)];
    if !plan.pairs.is_empty() {
        parts.push(plan.pairs.iter().map(of_pair).collect::<Vec<_>>().join("\n"));
    }
    if plan.motion.is_some() && !plan.values.is_empty() {
        let heading = format!("{:<44}{:>20}{:>20}{:>12}", "value", "in the model", "expected", "wanted");
        let rows = plan.values.iter().map(row);
        parts.push(std::iter::once(heading).chain(rows).collect::<Vec<_>>().join("\n"));
        parts.push(format!("Parts, run twice: {}.", plan.parts.join(", ")));
    }
    let remarks: Vec<String> = plan.not_by_motion.iter().chain(&plan.notes).cloned().collect();
    if !remarks.is_empty() {
        parts.push(remarks.join("\n"));
    }
    parts.join("\n\n")
}

/// How long the motion takes, and what it is expected to decide.
#[must_use]
pub fn lead(plan: &Plan) -> String {
    let wanted = || {
        plan.values.iter().filter_map(|value| {
            let wanted = value.wanted?;
            Some(value.half_width.is_some_and(|half| half <= wanted))
        })
    };
    if plan.pairs.is_empty() && wanted().next().is_none() {
        return "Nothing is open that a motion would decide: no effect of the model has a fitted rival, and every interval is as narrow \
                as wanted."
            .to_owned();
    }
    let decided = plan.pairs.iter().filter(|pair| pair.is_decided).count();
    let narrowed = wanted().filter(|is_reached| *is_reached).count();
    let of = |reached: usize, all: usize, what: &str| (all > 0).then(|| format!("{reached} of {all} {what}"));
    let expected = [
        of(decided, plan.pairs.len(), "pairs of rivals distinguished"),
        of(narrowed, wanted().count(), "intervals as narrow as wanted"),
    ];
    let expected: Vec<String> = expected.into_iter().flatten().collect();
    match plan.motion {
        Some(_) => {
            format!("{} s of motion; expected: {}.", significant(plan.seconds, 3), expected.join(", "))
        }
        None => "No motion within these limits tells more of what is open.".to_owned(),
    }
}

fn of_pair(pair: &ExpectedPair) -> String {
    let [own, rival] = pair.effects.map(|name| name.replace('_', " "));
    let verdict = if pair.is_decided { "are distinguished" } else { "are not distinguished for certain" };
    format!(
        "{}: {own} and {rival} {verdict}: they differ by {} times the noise, whatever the other values are.",
        pair.axis,
        significant(pair.distance, 2)
    )
}

fn row(value: &ExpectedValue) -> String {
    let before = value
        .half_width_before
        .map_or_else(|| significant(value.value, 4), |half| with_spread(value.value, half));
    let wanted = value.wanted.map_or_else(String::new, |half| format!("± {}", significant(half, 2)));
    let expected =
        value.half_width.map_or_else(|| "–".to_owned(), |half| format!("± {}", significant(half, 2)));
    format!("{:<44}{before:>20}{expected:>20}{wanted:>12}", value.name).trim_end().to_owned()
}
