//! The page of `verify`: the verdict in one sentence, contour errors before, predicted and after with their limits, and the circles before and
//! after on one scale, and after for itself.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::before_after::{self, Last, on_one_scale};
use super::certificate;
use budget::limits::{Judgement, Limit, judged_by_logs};
use contour::comparison::Comparison;
use contour::verification::{Change, VerifiedMotion};
use files::format::significant;
use files::output::OutputError;
use pages::markup::{list, note, section, text};

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
        (section("Contour error", &errors(motions, limits)))
        (section("Limits", &certificate::limits(limits)))
        @for motion in motions { (section(&format!("Radial deviation of {}", motion.name), &circles(motion))) }
    };
    let lead = html! { p.verdict { (text(&verdict(motions, limits))) } };
    pages::render(&format!("Before and after: {machine}"), &lead, &sections)
}

/// The result in one sentence: how the contour error changed, what is left, whether predictions hold, and limits.
#[must_use]
pub fn verdict(motions: &[VerifiedMotion], limits: &[Judgement]) -> String {
    let first = match motions {
        [motion] => of_motion(motion),
        motions => of_motions(motions),
    };
    let parts: Vec<String> = first.into_iter().chain(budget::limits::summary(limits)).collect();
    format!("{}.", parts.join("; "))
}

fn of_motion(motion: &VerifiedMotion) -> Vec<String> {
    let um = |um: f64| significant(um, 3);
    let change = match motion.change() {
        Change::Better => "became smaller",
        Change::Worse => "became larger",
        Change::Unchanged => "did not change by more than chance",
    };
    let [before, after] = [&motion.before, &motion.after].map(|error| um(error.rms_without_noise_um()));
    let circular = motion
        .circular_um()
        .map_or(String::new(), |[before, after]| format!(", and G from {} to {} µm", um(before), um(after)));
    let error =
        format!("The contour error of {} {change}, from {before} to {after} µm rms{circular}", motion.name);
    let prediction =
        motion.is_as_predicted().zip(motion.rms_um()[1]).map(|(is_as_predicted, predicted_um)| {
            let holds = if is_as_predicted { "this is" } else { "this is not" };
            format!("{holds} as predicted, {} µm rms", um(predicted_um))
        });
    [error].into_iter().chain(prediction).collect()
}

/// How many motions changed in a way.
fn count(motions: &[VerifiedMotion], change: Change) -> usize {
    motions.iter().filter(|motion| motion.change() == change).count()
}

fn of_motions(motions: &[VerifiedMotion]) -> Vec<String> {
    let worse = match count(motions, Change::Worse) {
        0 => String::new(),
        worse => format!(" and larger in {worse}"),
    };
    let error = format!(
        "The contour error became smaller in {} of {} motions{worse}",
        count(motions, Change::Better),
        motions.len()
    );
    let left_um = |motion: &&VerifiedMotion| motion.after.rms_without_noise_um();
    let left = motions.iter().max_by(|a, b| left_um(a).total_cmp(&left_um(b)));
    let left = left.map(|motion| {
        format!("at most {} µm rms are left, in {}", significant(left_um(&motion), 3), motion.name)
    });
    let judged: Vec<bool> = motions.iter().filter_map(VerifiedMotion::is_as_predicted).collect();
    let predictions = (!judged.is_empty()).then(|| {
        format!("{} of {} predictions hold", judged.iter().filter(|holds| **holds).count(), judged.len())
    });
    [error].into_iter().chain(left).chain(predictions).collect()
}

/// How many motions became better, worse, or neither.
#[must_use]
pub fn summary(motions: &[VerifiedMotion]) -> String {
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
        count(motions, Change::Better),
        count(motions, Change::Worse),
        count(motions, Change::Unchanged)
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
        let um = |um: f64| significant(um, 3);
        let expected = match motion.range_um() {
            Some([least_um, most_um]) if predicted.unexplained_um > 0.0 => {
                format!("{} to {} µm", um(least_um), um(most_um))
            }
            _ => format!("{} µm ± {} %", um(predicted_um), significant(predicted.bound_percent, 2)),
        };
        remarks.push(format!("{name}: {} µm rms were measured, {expected} predicted.", um(after_um)));
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

fn errors(motions: &[VerifiedMotion], limits: &[Judgement]) -> Markup {
    let remarks = remarks(motions);
    let rows: Vec<Comparison> = motions.iter().map(VerifiedMotion::comparison).collect();
    let of_motions: Vec<Vec<Judgement>> = motions.iter().map(|motion| of_its_log(motion, limits)).collect();
    html! {
        (before_after::errors(&rows, &of_motions))
        @if !remarks.is_empty() { (list(&remarks)) }
    }
}

/// What becomes of the limits on one motion.
fn of_its_log(motion: &VerifiedMotion, limits: &[Judgement]) -> Vec<Judgement> {
    let limits: Vec<Limit> =
        limits.iter().map(|limit| Limit { figure: limit.name, um: limit.limit_um }).collect();
    judged_by_logs(&limits, &[motion.log_after()])
}

/// The largest circle before and after; empty if the motion has none.
fn circles(motion: &VerifiedMotion) -> Markup {
    let errors = [("Before", &motion.before), ("After", &motion.after)];
    html! {
        (note(&format!("Measured at the {}.", motion.channel.word())))
        (on_one_scale(&errors, &motion.axes, Last::AndAlone))
    }
}
