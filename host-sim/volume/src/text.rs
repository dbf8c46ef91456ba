//! The result for a terminal.

use files::format::{significant, with_spread};

use super::analysis::{Analysis, Judged, Verdict};
use super::finding::{Finding, Known};

/// A sentence, the errors, the measurements before and after, and what was assumed.
#[must_use]
pub fn of(analysis: &Analysis) -> String {
    let mut lines = vec![sentence(analysis), String::new()];
    lines.push(format!("{:<6} {:<44} {}", "error", "", "greatest value, 95 % interval"));
    lines.extend(analysis.findings.iter().map(line));
    lines.push(String::new());
    lines.push(format!("{:<40} {:>12} {:>12}", "measurement, µm rms", "before", "after"));
    lines.extend(analysis.judged.iter().map(judged));
    if !analysis.notes.is_empty() {
        lines.push(String::new());
        lines.extend(analysis.notes.iter().cloned());
    }
    lines.join("\n")
}

/// What was found, in a sentence or two.
#[must_use]
pub fn sentence(analysis: &Analysis) -> String {
    let count =
        |is: fn(&Known) -> bool| analysis.findings.iter().filter(|finding| is(&finding.known)).count();
    let shown = count(|known| matches!(known, Known::Shown { .. }));
    let open = count(|known| matches!(known, Known::Open { .. }));
    let errors = |number: usize| if number == 1 { "1 error".to_owned() } else { format!("{number} errors") };
    let judged = match analysis.verdict {
        Verdict::Confirmed => "Measurements that took no part in the fit confirm them.",
        Verdict::NotJudged => "No measurement was held out to judge them.",
        Verdict::Undecided => {
            "The measurements that took no part in the fit neither confirm nor refute them: more than half of their mean square is left."
        }
        Verdict::Refuted => {
            "A measurement is worse with them: they are not confirmed, and no table is written."
        }
    };
    let open = if open == 0 {
        String::new()
    } else {
        format!(" {} not determined by these measurements.", are(open))
    };
    format!("{} of geometry {} shown.{open} {judged}", errors(shown), if shown == 1 { "is" } else { "are" })
}

fn are(number: usize) -> String {
    if number == 1 { "1 other is".to_owned() } else { format!("{number} others are") }
}

/// What is known of an error, in words.
#[must_use]
pub fn known(finding: &Finding) -> String {
    match &finding.known {
        Known::Shown { greatest, half_width, if_zero } => {
            let condition = if if_zero.is_empty() {
                String::new()
            } else {
                format!(", if {} is zero", if_zero.join(" and "))
            };
            format!("{} {}{condition}", with_spread(*greatest, *half_width), finding.unit)
        }
        Known::Small { at_most_um } => {
            format!("not told from zero: at most {} µm at the tool", significant(*at_most_um, 2))
        }
        Known::Open { shown_by } => format!("not determined; would be shown by {shown_by}"),
        Known::WithoutEffect => "does not move the tool".to_owned(),
    }
}

fn line(finding: &Finding) -> String {
    format!("{:<6} {:<44} {}", finding.name, finding.words, known(finding))
}

fn judged(judged: &Judged) -> String {
    let name =
        if judged.is_held_out { format!("{} (held out)", judged.source) } else { judged.source.clone() };
    let [before, after] = [judged.before_um, judged.after_um].map(|um| significant(um, 3));
    format!("{name:<40} {before:>12} {after:>12}")
}
