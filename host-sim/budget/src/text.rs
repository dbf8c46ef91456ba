//! The budget for a terminal: for each motion a sentence, then a table of its causes.

use files::format::significant;
use model::machine::evidence::Certainty;

use crate::Budget;
use crate::of_motion::{CauseShare, MotionBudget};

/// Part of the mean square shared in proportion from which it is told.
const TOLD_TOGETHER: f64 = 0.1;

/// Causes that the sentence names, and the least part of the whole of one.
const NAMED: usize = 3;
const LEAST_NAMED: f64 = 0.2;

/// All motions, then what is assumed and left out.
#[must_use]
pub fn of(budget: &Budget) -> String {
    let mut parts: Vec<String> = budget.motions.iter().map(of_motion).collect();
    parts.extend(budget.assumed.iter().map(plant::equivalent::Assumed::sentence));
    parts.extend(budget.notes.iter().cloned());
    parts.join("\n\n")
}

/// The sentence and the table of a motion.
#[must_use]
pub fn of_motion(motion: &MotionBudget) -> String {
    let mut lines = vec![
        sentence(motion),
        String::new(),
        format!(
            "{:<26}{:<6}{:>9}{:>18}{:>11}{:>9}{:>12}{:>13}  {:<11}remedy",
            "cause",
            "axis",
            "µm rms",
            "95 % interval",
            "µm at most",
            "G µm",
            "without it",
            "compensated",
            "certainty"
        ),
    ];
    let (shown, others) = motion.shown();
    lines.extend(shown.into_iter().map(row));
    lines.extend(others);
    if motion.shared_in_proportion > TOLD_TOGETHER {
        lines.push(format!(
            "Causes act on each other: {} % of the mean square is shared among them in proportion.",
            significant(100.0 * motion.shared_in_proportion, 2)
        ));
    }
    lines.join("\n")
}

/// What the contour error of a motion is, and mostly made of.
#[must_use]
pub fn sentence(motion: &MotionBudget) -> String {
    let circular =
        motion.whole.circular.map_or(String::new(), |um| format!(", G = {} µm", significant(um, 3)));
    let largest = motion.causes.iter().filter(|cause| cause.share.rms >= LEAST_NAMED * motion.whole.rms);
    let largest: Vec<String> = largest
        .take(NAMED)
        .map(|cause| format!("{} ({} µm)", cause.title(), significant(cause.share.rms, 3)))
        .collect();
    let of = if largest.is_empty() { String::new() } else { format!(": {}", largest.join(", ")) };
    format!(
        "{}: {} µm rms from the path, at most {} µm{circular}{of}.{}",
        motion.name,
        significant(motion.whole.rms, 3),
        significant(motion.whole.max, 3),
        compensated(motion)
    )
}

/// What a compensation of everything makes of the motion.
fn compensated(motion: &MotionBudget) -> String {
    let Some(sizes) = motion.compensated else { return String::new() };
    let worse = if sizes.rms > motion.whole.rms {
        ", which is worse: `compensate` leaves out what does not help"
    } else {
        ""
    };
    format!(" With everything compensated: {} µm rms{worse}.", significant(sizes.rms, 3))
}

impl CauseShare {
    /// Its name and axis in words, with its doubt.
    #[must_use]
    pub fn title(&self) -> String {
        let doubt = if self.certainty == Certainty::Ambiguous { " (ambiguous)" } else { "" };
        format!("{}{doubt}", self.plain_title())
    }

    /// Its name and axis in words.
    #[must_use]
    pub fn plain_title(&self) -> String {
        let name = self.name.replace('_', " ");
        self.axis.as_ref().map_or_else(|| name.clone(), |axis| format!("{name} of {axis}"))
    }
}

fn row(cause: &CauseShare) -> String {
    let um = |um: f64| significant(um, 3);
    let interval =
        cause.interval_um.map_or("unknown".to_owned(), |[from, to]| format!("{} to {}", um(from), um(to)));
    format!(
        "{:<26}{:<6}{:>9}{:>18}{:>11}{:>9}{:>12}{:>13}  {:<11}{}",
        cause.name,
        cause.axis.as_deref().unwrap_or("all"),
        um(cause.share.rms),
        interval,
        um(cause.share.max),
        cause.share.circular.map_or("–".to_owned(), um),
        um(cause.without.rms),
        cause.compensated.map_or("–".to_owned(), |sizes| um(sizes.rms)),
        cause.certainty.word(),
        cause.remedy
    )
}
