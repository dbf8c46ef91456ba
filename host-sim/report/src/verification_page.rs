//! The page of `verify`: contour errors before, predicted and after, and the circles before and after on one scale.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::before_after::{self, on_one_scale};
use contour::verification::{Change, VerifiedMotion};
use files::format::significant;
use files::output::OutputError;
use pages::markup::{list, note, paragraph, section};

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, machine: &str, motions: &[VerifiedMotion]) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(machine, motions))
}

/// The page. The same motions give the same bytes.
#[must_use]
pub fn html(machine: &str, motions: &[VerifiedMotion]) -> String {
    let sections = html! {
        (section("Contour error", &errors(motions)))
        @for motion in motions { (section(&format!("The circle of {}", motion.name), &circles(motion))) }
    };
    let lead = paragraph(&summary(motions));
    pages::render(&format!("Before and after: {machine}"), &lead, &sections)
}

/// How many motions became better, worse, or neither.
#[must_use]
pub fn summary(motions: &[VerifiedMotion]) -> String {
    let count = |change: Change| motions.iter().filter(|motion| motion.change() == change).count();
    let predicted = motions.iter().filter_map(VerifiedMotion::is_as_predicted);
    let (within, all) = predicted.fold((0, 0), |(within, all), is| (within + usize::from(is), all + 1));
    let predictions = if all == 0 {
        "No prediction is given for them.".to_owned()
    } else {
        format!("{within} of {all} predictions hold.")
    };
    format!(
        "Contour error of {} {}: smaller in {}, larger in {}, not distinguishable in {}. {predictions}",
        motions.len(),
        if motions.len() == 1 { "motion" } else { "motions" },
        count(Change::Better),
        count(Change::Worse),
        count(Change::Unchanged)
    )
}

/// One sentence for each motion that became worse or is not as predicted, and for each that is not measured at the tool.
#[must_use]
pub fn remarks(motions: &[VerifiedMotion]) -> Vec<String> {
    motions.iter().flat_map(remarks_on).collect()
}

fn remarks_on(motion: &VerifiedMotion) -> Vec<String> {
    let name = &motion.name;
    let mut remarks = Vec::new();
    if motion.change() == Change::Worse {
        remarks.push(format!(
            "{name}: the error became larger, from {} to {} µm rms.",
            significant(motion.before.rms_um, 3),
            significant(motion.after.rms_um, 3)
        ));
    }
    if let (Some(false), Some(predicted)) = (motion.is_as_predicted(), &motion.predicted) {
        remarks.push(format!(
            "{name}: {} µm rms were measured, {} µm ± {} % predicted.",
            significant(motion.after.rms_um, 3),
            significant(predicted.after_um, 3),
            significant(predicted.bound_percent, 2)
        ));
    }
    if motion.channel != contour::logged::POSITIONS[0] {
        remarks.push(format!(
            "{name}: measured at the {}; errors between it and the tool are not in these figures.",
            motion.channel.word()
        ));
    }
    if motion.before.is_along_axis {
        remarks.push(format!("{name}: one axis; the error is along it, the following error."));
    }
    remarks
}

fn errors(motions: &[VerifiedMotion]) -> Markup {
    let remarks = remarks(motions);
    html! {
        (before_after::errors(&motions.iter().map(VerifiedMotion::comparison).collect::<Vec<_>>()))
        @if !remarks.is_empty() { (list(&remarks)) }
    }
}

/// The largest circle before and after; empty if the motion has none.
fn circles(motion: &VerifiedMotion) -> Markup {
    let errors = [("Before", &motion.before), ("After", &motion.after)];
    html! {
        (note(&format!("Measured at the {}.", motion.channel.word())))
        (on_one_scale(&errors, &motion.axes))
    }
}
