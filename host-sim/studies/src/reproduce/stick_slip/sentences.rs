//! Findings and notes as text.

use super::contributors::Contributor;
use super::experiment::{Experiment, StickSlip};
use super::table_model::{self, RADIUS_M, SPEEDS_RAD_PER_S, TABLES};
use crate::reproduce::ballbar::Ballbar;
use files::format::{fixed, significant};

/// The findings, one paragraph each.
pub fn findings(experiment: &Experiment) -> Vec<String> {
    let sizes = experiment.contributors.iter().map(|(contributor, ballbar)| size(contributor, ballbar));
    std::iter::once(friction_slope()).chain(sizes).collect()
}

/// Falling friction against the damping: why there are no self-excited vibrations.
fn friction_slope() -> String {
    let max_m_per_s = SPEEDS_RAD_PER_S[1] * RADIUS_M;
    let [x, y] = TABLES.each_ref().map(|table| {
        let fall = table_model::steepest_fall_n_s_per_m(&table.friction(), max_m_per_s);
        format!("{} against {} N·s/m", significant(fall, 3), significant(table.damping_n_s_per_m, 4))
    });
    format!(
        "The steepest fall of friction with speed against the damping of the drive: {x} on X, {y} on Y. Neither table \
         swings up by itself. What is left is friction turning over at each reversal on a drive that gives way, which is \
         where the error stands."
    )
}

/// Circular deviation and reversal value of a contributor.
fn size(contributor: &Contributor, ballbar: &Ballbar) -> String {
    let [x, y] = ballbar.reversal_um();
    let expected = contributor.expected_um().map_or(String::new(), |expected| {
        format!(
            "; in closed form {} and {} µm",
            significant(expected.circular_deviation_um, 3),
            significant(expected.reversal_um, 3)
        )
    });
    format!(
        "{}, {}: circular deviation G {} µm, reversal value B {} µm on X and {} µm on Y{expected}.",
        contributor.name(),
        contributor.description(),
        significant(ballbar.circular_deviation_um(), 3),
        micrometres(x),
        micrometres(y),
    )
}

/// To 0.01 µm: smaller reversal values are artefacts of an oval in the fit.
pub fn micrometres(um: f64) -> String {
    fixed(um, 2)
}

/// Where the printed text is unclear or wrong: what was read instead, and why.
pub fn notes(experiment: &Experiment) -> Vec<String> {
    let [lower, higher] = &experiment.stick_slip;
    let both = |[x, y]: [f64; 2]| format!("{} µm on X and {} µm on Y", significant(x, 3), significant(y, 3));
    let (lower_um, higher_um) = (lower.lap.peak_to_peak_um(), higher.lap.peak_to_peak_um());
    let radial_um = [lower, higher].map(|run| significant(run.ballbar.circular_deviation_um(), 3));
    let turning_degrees = [lower, higher].map(|run: &StickSlip| {
        let path_m_per_s = RADIUS_M * run.lap.path.speed_rad_per_s;
        significant((1.0 / (TABLES[0].friction().alpha * path_m_per_s)).asin().to_degrees(), 2)
    });
    vec![
        format!(
            "Which error is 2 to 3 µm is not printed; the figure that it is read from shows the deviations of X and Y over \
             time, of which the text is kept but not the picture. From end to end they are {} at 0.5 rad/s and {} at 1.5 \
             rad/s: Y is beyond 3 µm at the lower speed already. Half of that, an amplitude, would be below 2 µm on both \
             axes.",
            both(lower_um),
            both(higher_um),
        ),
        format!(
            "Read radially, as a circular deviation about the least-squares circle, the error is {} and {} µm at the two \
             speeds: less than printed at the lower one. There the friction of X and Y, which point against the motion \
             together, shift the table along the circle and not off it, but for the quadrant changes.",
            radial_um[0], radial_um[1],
        ),
        "α is printed in s²/m², β in s/m, and v without unit. tanh αv has to change its sign with v, so α is read in s/m \
         and v counts in m/s; counted in mm/s, the square alone would make a coefficient of 200 at 50 mm/s."
            .to_owned(),
        "The inertia of X has a minus in equation 10 and a plus in 14. Equations 2 and 8 lead to the plus, which is \
         integrated. Beside the friction the sign has no weight: reversed, each deviation runs backwards in time with the \
         same least and greatest values."
            .to_owned(),
        "The two speeds of the figure are printed as 0.5 and 0.5 rad/s; before that, 0.5 and 1.5, which is what was run."
            .to_owned(),
        "The start is not printed. From rest Y meets its whole friction at once and swings to nearly twice its deviation, \
         as a spring with 1 % of damping does; here a lap passes before one is kept."
            .to_owned(),
        format!(
            "The greatest error is said to stand where a speed is close to zero, without a figure: it counts as agreeing \
             when it is nearer to an axis than to a diagonal. Friction turns over while the speed rises to 1/α = 20 mm/s, \
             which takes {}° of the lap at 0.5 rad/s, so that it agrees by little there, and {}° at 1.5.",
            turning_degrees[0], turning_degrees[1],
        ),
        "Glitches of the master–slave changeover are said to come every 45 degrees. The axes change parts where their \
         speeds are equal, which is on the diagonals, 45 degrees from either axis: four times a lap, not eight."
            .to_owned(),
        "Of the contributors the paper gives no sizes: those here were chosen to be seen at one scale. The figures are the \
         circular deviation G of ISO 230-4 in the worse direction, and B as ISO 230-2 has it, read from 3 to 20 degrees \
         beside each axis's reversals; what ISO 230-4 itself compares the directions with is their greatest distance H. \
         The paper's friction is not yet turned over at 3 degrees: its B is what a rounded crossing leaves, and no lost \
         motion."
            .to_owned(),
    ]
}
