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
        "no factor helps".to_owned()
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
        "A machine whose guideways have {} of the catalogue's stiffness, and {} % of scatter about that, is \
         measured on circles in three planes. Each part of the catalogue's model gets a factor in its turn; \
         what it leaves on circles at another acceleration, in standard deviations of the readings: {}; the \
         catalogue as it is, {}.",
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
        "Found: {}. Error at the tool on the judging circles, rms without the probe's noise: \
         {} µm; the catalogue's machine leaves {} µm of it, the identified one {} µm.",
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
        "In-talk of x, y and z by the ellipses, µm·s²/m: measured {}; the catalogue {}; identified {}.",
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
        "The same coefficients on the 20 mm move of the true machine: {} µm in x, of which the catalogue leaves \
         {} and the identified machine {}. By least squares over the whole move the cross-talk is {} µm·s²/m, on \
         the circles {} with a standard error of {}.",
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
        "What keeps the 20 mm move below 10 m/s² is the jerk, not the speed: with the jerk alone the \
         acceleration is the cube root of s·j²/2, {} m/s², at a speed of a²/j, {} m/s of the 0.5 allowed. The \
         interpolator commands {} m/s²; with twice the speed allowed {} m/s², with a jerk of {} m/s³ {} m/s². The \
         axis itself reaches {} m/s²: its position loop lags.",
        three(peaks.acceleration_m_per_s2),
        three(peaks.speed_m_per_s),
        three(printed.acceleration_m_per_s2),
        three(faster.acceleration_m_per_s2),
        three(more_jerk.jerk_m_per_s3),
        three(more_jerk.acceleration_m_per_s2),
        three(experiment.simulated_move.peak(X).0),
    )
}

/// Where the printed text is unclear: what was read instead, and why.
pub const NOTES: [&str; 5] = [
    "The paper prints neither masses nor stiffness nor gains. The machine is ours; three of its values are chosen for \
     what the paper reports: the distance of the ram's screw for the cross-talk of −0.55, the share of the true \
     guideways for the −1.55, and Kp for the 4.7 m/s² of the simulated circle. These rows, and the factor between the first two, agree by \
     choice; the others are what follows.",
    "Equations (1), (2) and (12) to (16) are missing from the scan; they are read as the moment of the drive force \
     about the centre of gravity, M·q″ + D·q′ + K·q = B·f, and its state space.",
    "The paper says that the set acceleration was not reached because of the settings of jerk and speed. A speed of \
     30,000 mm/min is never reached on 20 mm with 250 m/s³; jerk and way alone are the limit.",
    "3.7 µm over 7.9 m/s² is −0.47, not −0.48; within the rounding of both figures it may be −0.46 to −0.48. Either \
     way it is an eighth less than the −0.55 of the circles, which the paper calls quite similar. Here the structure is \
     linear and its lowest mode lies at 30 Hz, so move and circles have one coefficient but for a few percent of \
     dynamics: with −0.55 given on the circles, neither −0.48 nor 3.7 µm can come out.",
    "7.9 m/s² depends on the gains, which are not printed. With Kp from the circle, and the velocity loop by the usual \
     rule, the axis reaches a little less.",
];
