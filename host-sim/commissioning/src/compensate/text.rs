//! The plan for a terminal: a sentence, a table of the motions, a table of the items.

use contour::verification::Prediction;
use files::format::significant;

use crate::compensate::plan::Plan;

/// What the compensation is predicted to do to each motion, and of how many causes.
fn sentence(plan: &Plan) -> String {
    let of_motion = |motion: &Prediction| {
        let [before, after] = [motion.before_um, motion.after_um].map(|um| significant(um, 3));
        format!("{before} → {after} µm rms on {}", motion.motion)
    };
    let motions: Vec<String> = plan.file.predicted.iter().map(of_motion).collect();
    let count = |n: usize| if n == 1 { "1 cause is".to_owned() } else { format!("{n} causes are") };
    let left = match plan.not_compensated.len() {
        0 => String::new(),
        1 => ", 1 is not".to_owned(),
        n => format!(", {n} are not"),
    };
    format!(
        "{}: predicted contour error {}; {} compensated{left}.",
        plan.file.machine,
        motions.join(", "),
        count(plan.items.len())
    )
}

/// What may be left where the trace of the model left something unexplained.
fn range(motion: &Prediction) -> String {
    let [least, most] = motion.range_um(motion.after_um).map(|um| significant(um, 3));
    let unexplained = significant(motion.unexplained_um, 3);
    format!(
        "{}: {least} to {most} µm rms are to be expected, as the trace left {unexplained} µm of its logs unexplained.",
        motion.motion
    )
}

/// Sentence and tables.
#[must_use]
pub fn of(plan: &Plan) -> String {
    let mut lines = vec![
        sentence(plan),
        String::new(),
        format!("{:<24}{:>24}{:>24}{:>26}", "predicted", "rms µm", "greatest µm", "circular deviation G µm"),
        format!("{:<24}{}", "motion", format!("{:>12}{:>12}", "before", "after").repeat(3)),
    ];
    let cell = |value: Option<f64>| {
        value.map_or(format!("{:>12}", "–"), |um| format!("{:>12}", significant(um, 3)))
    };
    for motion in &plan.file.predicted {
        let figures = [
            Some(motion.before_um),
            Some(motion.after_um),
            motion.max_before_um,
            motion.max_after_um,
            motion.circular_before_um,
            motion.circular_after_um,
        ];
        lines.push(format!("{:<24}{}", motion.motion, figures.map(cell).concat()));
    }
    let unexplained = plan.file.predicted.iter().filter(|motion| motion.unexplained_um > 0.0);
    let ranges: Vec<String> = unexplained.map(range).collect();
    // The first of those that are watched are the motions above.
    let watched = plan.watched.iter().skip(plan.file.predicted.len());
    lines.extend(watched.map(|watched| {
        let figures = [Some(watched.before_um), Some(watched.after_um), None, None, None, None];
        let worse = if watched.is_worse { "  worse: not planned for" } else { "  watched" };
        format!("{:<24}{}{worse}", watched.motion, figures.map(cell).concat())
    }));
    lines.extend(ranges);
    lines.push(String::new());
    lines.push(format!("{:<24}{:<6}{:>14}{:>10}", "item", "axis", "without it µm", "with µm"));
    for item in &plan.items {
        let axis = if item.axis.is_empty() { "all" } else { &item.axis };
        lines.push(format!(
            "{:<24}{:<6}{:>14}{:>10}  {}",
            item.effect,
            axis,
            significant(item.before_um, 3),
            significant(item.after_um, 3),
            item.does
        ));
    }
    for not in &plan.not_compensated {
        let axis = if not.axis.is_empty() { "all axes" } else { &not.axis };
        lines.push(format!(
            "\n{axis}: {} is not compensated: {}. Instead: {}.",
            not.effect, not.why, not.instead
        ));
    }
    lines.extend(plan.assumed.iter().map(|assumed| format!("\n{}", assumed.sentence())));
    for (motion, beyond) in &plan.beyond {
        lines.extend(beyond.iter().map(|beyond| format!("\n{motion}: {}", beyond.sentence())));
    }
    lines.join("\n")
}
