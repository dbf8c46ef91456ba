//! Findings and notes as text.

use super::closed_loop::{X, Z};
use super::experiment::{Experiment, without_noise_um};
use super::identify::{self, Candidate};
use super::{machines, z_move};
use files::format::significant;

/// The findings, one paragraph each.
pub fn findings(experiment: &Experiment) -> Vec<String> {
    vec![
        ranking(experiment),
        identified(experiment),
        in_talk(experiment),
        cross_talk_on_the_move(experiment),
        limit_of_the_move(experiment),
    ]
}

/// Three significant digits.
fn three(value: f64) -> String {
    significant(value, 3)
}

/// The factor of a candidate.
fn factor(candidate: &Candidate) -> String {
    if candidate.is_identifiable() {
        format!("factor {}", three(candidate.factor))
    } else {
        "no factor reduces the error".to_owned()
    }
}

/// All candidates with their residuals.
fn ranking(experiment: &Experiment) -> String {
    let candidates: Vec<String> = experiment
        .candidates
        .iter()
        .map(|c| format!("{} {} ({})", c.name, three(c.residual), factor(c)))
        .collect();
    format!(
        "A machine whose guideways have {} times the catalogue's stiffness, with a scatter of {} %, is measured on \
         circles in three planes. Each part of the catalogue's model in turn is multiplied by a fitted factor. Rms \
         errors on circles at another acceleration, in standard deviations of the readings: {}; unchanged catalogue \
         {}.",
        machines::TRUE_GUIDEWAY_FACTOR,
        100.0 * machines::GUIDEWAY_SCATTER,
        candidates.join(", "),
        three(identify::rms_error(&experiment.validation, &experiment.before, machines::WEIGHTS)),
    )
}

/// The identified part, and the error at the tool before and after.
fn identified(experiment: &Experiment) -> String {
    let best = experiment.candidates.first().map_or(String::new(), |c| format!("{}, {}", c.name, factor(c)));
    let [raw, before, after] = experiment.residuals_um();
    format!(
        "Identified: {}. Error at the tool on the validation circles, rms without the probe's noise: {} µm; {} µm \
         after correction with the catalogue's machine, {} µm with the identified one.",
        best,
        three(raw),
        three(before),
        three(after),
    )
}

/// In-talk of the three axes: measured and of both models.
fn in_talk(experiment: &Experiment) -> String {
    let list = |of: &dyn Fn(usize) -> f64| [0, 1, 2].map(|axis| three(of(axis))).join(", ");
    format!(
        "In-talk of x, y and z from the ellipses, µm·s²/m: measured {}; catalogue {}; identified {}.",
        list(&|axis| experiment.validation.talk_um_s2_per_m[(axis, axis)]),
        list(&|axis| experiment.before.tool_um_s2_per_m[(axis, axis)]),
        list(&|axis| experiment.after.tool_um_s2_per_m[(axis, axis)]),
    )
}

/// The coefficients of the circles on the 20 mm movement.
fn cross_talk_on_the_move(experiment: &Experiment) -> String {
    let coefficients =
        [experiment.before.tool_um_s2_per_m[(X, Z)], experiment.after.tool_um_s2_per_m[(X, Z)]];
    let [raw, before, after] = [0.0, coefficients[0], coefficients[1]]
        .map(|c| without_noise_um(experiment.measured_move.rms_residual_um(X, c)));
    format!(
        "The same coefficients on the 20 mm move of the true machine: {} µm rms in x; {} µm after correction with \
         the catalogue's coefficient, {} µm with the identified one. By least squares over the whole move the \
         cross-talk is {} µm·s²/m; on the circles it is {} with a standard error of {}.",
        three(raw),
        three(before),
        three(after),
        three(experiment.measured_move.coefficient(X)),
        three(experiment.measured.talk_um_s2_per_m[(X, Z)]),
        significant(experiment.measured.deviation_um_s2_per_m[(X, Z)], 2),
    )
}

/// Which limit determines the acceleration on the 20 mm movement.
fn limit_of_the_move(experiment: &Experiment) -> String {
    let peaks = z_move::jerk_limited_peaks(z_move::DISTANCE_M, z_move::PRINTED.jerk_m_per_s3);
    let [printed, faster, more_jerk] = experiment.commanded;
    format!(
        "The jerk, not the speed, limits the acceleration of the 20 mm move to less than 10 m/s². With the jerk \
         limit alone the acceleration is the cube root of s·j²/2, {} m/s², at a speed of a²/j, {} m/s of the \
         permitted 0.5. The interpolator commands {} m/s²; with twice the permitted speed {} m/s², with a jerk of \
         {} m/s³ {} m/s². The axis itself reaches {} m/s² because its position loop lags.",
        three(peaks.acceleration_m_per_s2),
        three(peaks.speed_m_per_s),
        three(printed.acceleration_m_per_s2),
        three(faster.acceleration_m_per_s2),
        three(more_jerk.jerk_m_per_s3),
        three(more_jerk.acceleration_m_per_s2),
        three(experiment.simulated_move.peak(X).0),
    )
}

/// Readings that were used where the printed text is unclear, with the reason.
pub const NOTES: [&str; 5] = [
    "The paper gives no masses, stiffness or gains; all values of the machine are chosen here. Three of them are \
     set for printed values: the distance of the ram's screw for the cross-talk of −0.55, the factor of the true \
     guideways for −1.55, and Kp for the 4.7 m/s² of the simulated circle. These rows, and the ratio of the first \
     two, agree by choice; the others are results.",
    "Equations (1), (2) and (12) to (16) are missing from the scan. They are taken as the moment of the drive force \
     about the centre of gravity, M·q″ + D·q′ + K·q = B·f, and its state space.",
    "The paper says that the set acceleration was not reached because of the settings of jerk and speed. A speed of \
     30,000 mm/min is never reached on 20 mm with 250 m/s³; jerk and distance alone determine the move.",
    "3.7 µm over 7.9 m/s² is −0.47, not −0.48; with both values rounded it may be −0.46 to −0.48. In either case it \
     is an eighth below the −0.55 of the circles, which the paper calls quite similar. Here the structure is linear \
     and its lowest mode is at 30 Hz, so that move and circles have the same coefficient to a few percent. With \
     −0.55 set on the circles, neither −0.48 nor 3.7 µm can result.",
    "7.9 m/s² depends on the gains, which are not printed. With Kp from the circle and the usual ratios of the \
     velocity loop, the axis reaches slightly less.",
];
