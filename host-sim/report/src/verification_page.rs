//! The page of `verify`: contour errors before, predicted and after, and the circles before and after on one scale.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::before_after::{self, on_one_scale};
use super::certificate;
use budget::limits::Judgement;
use contour::verification::{Change, VerifiedMotion};
use files::format::significant;
use files::output::OutputError;
use pages::markup::{list, note, paragraph, section};

/// Smallest ratio of the noise before and after that is stated.
const MAX_NOISE_RATIO: f64 = 1.5;

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(
    folder: &Path,
    machine: &str,
    motions: &[VerifiedMotion],
    limits: &[Judgement],
) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(machine, motions, limits))
}

/// The page. The same motions give the same bytes.
#[must_use]
pub fn html(machine: &str, motions: &[VerifiedMotion], limits: &[Judgement]) -> String {
    let sections = html! {
        (section("Limits", &certificate::limits(limits)))
        (section("Contour error", &errors(motions)))
        @for motion in motions { (section(&format!("Radial deviation of {}", motion.name), &circles(motion))) }
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
    let has_prediction =
        |motion: &VerifiedMotion| motion.predicted.is_some() || motion.not_comparable.is_some();
    let predictions = if all == 0 && motions.iter().any(has_prediction) {
        "No prediction is judged.".to_owned()
    } else if all == 0 {
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
            significant(motion.before.rms_without_noise_um(), 3),
            significant(motion.after.rms_without_noise_um(), 3)
        ));
    }
    if let (Some(false), Some(predicted), [_, Some(predicted_um), Some(after_um)]) =
        (motion.is_as_predicted(), &motion.predicted, motion.rms_um())
    {
        remarks.push(format!(
            "{name}: {} µm rms were measured, {} µm ± {} % predicted.",
            significant(after_um, 3),
            significant(predicted_um, 3),
            significant(predicted.bound_percent, 2)
        ));
    }
    if let Some(why) = &motion.not_comparable {
        remarks.push(format!("{name}: the prediction is not compared: {why}."));
    }
    if let Some(predicted) = motion.predicted.as_ref().filter(|p| !p.beyond_mapped.is_empty()) {
        remarks.push(format!(
            "{name}: the prediction is not judged: on {}, the motion leaves the travel that the compensation is made for, and the error \
             there is not known.",
            predicted.beyond_mapped.join(" and ")
        ));
    }
    remarks.extend(on_noise(motion));
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

/// The noise, if it is more than a part of the figures, or another one after the change.
fn on_noise(motion: &VerifiedMotion) -> Option<String> {
    let [before_um, after_um] = [motion.before.noise_um, motion.after.noise_um];
    let is_other = before_um.max(after_um) > MAX_NOISE_RATIO * before_um.min(after_um);
    let is_large =
        before_um > motion.before.rms_without_noise_um() || after_um > motion.after.rms_without_noise_um();
    (is_other || is_large).then(|| {
        format!(
            "{}: noise of {} µm before and {} µm after is not in the rms figures. It is taken for white; a vibration of several hundred \
             hertz counts as noise, too.",
            motion.name,
            significant(before_um, 2),
            significant(after_um, 2)
        )
    })
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
