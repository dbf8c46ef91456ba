//! Findings and notes as text.

use super::contributors::Contributor;
use super::experiment::{Experiment, StickSlip};
use super::table_model::{self, RADIUS_M, SPEEDS_RAD_PER_S, TABLES};
use contour::circular_test::Ballbar;
use files::format::{fixed, significant};

/// The findings, one paragraph each.
pub fn findings(experiment: &Experiment) -> Vec<String> {
    let sizes = experiment.contributors.iter().map(|(contributor, ballbar)| size(contributor, ballbar));
    std::iter::once(friction_slope()).chain(sizes).collect()
}

/// The slope of falling friction compared with the damping, which explains why there are no self-excited vibrations.
fn friction_slope() -> String {
    let max_m_per_s = SPEEDS_RAD_PER_S[1] * RADIUS_M;
    let [x, y] = TABLES.each_ref().map(|table| {
        let fall = table_model::steepest_fall_n_s_per_m(&table.friction(), max_m_per_s);
        format!("{} against {} N·s/m", significant(fall, 3), significant(table.damping_n_s_per_m, 4))
    });
    format!(
        "The steepest decrease of friction with speed compared with the damping of the drive: {x} on X, {y} on Y. \
         Neither table develops self-excited vibrations. The remaining error is due to the reversal of friction on \
         an elastic drive."
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

/// Readings that were used where the printed text is unclear or wrong, with the reason.
pub fn notes(experiment: &Experiment) -> Vec<String> {
    let [lower, higher] = &experiment.stick_slip;
    let both = |[x, y]: [f64; 2]| format!("{} µm on X and {} µm on Y", significant(x, 3), significant(y, 3));
    let (lower_um, higher_um) = (lower.lap.peak_to_peak_um(), higher.lap.peak_to_peak_um());
    let radial_um = [lower, higher].map(|run| significant(run.ballbar.circular_deviation_um(), 3));
    let turning_degrees = [lower, higher].map(|run: &StickSlip| {
        let path_m_per_s = RADIUS_M * run.lap.path.speed_rad_per_s;
        significant(libm::asin(1.0 / (TABLES[0].friction().alpha * path_m_per_s)).to_degrees(), 2)
    });
    vec![
        format!(
            "The paper does not state which error is 2 to 3 µm. Its figure, which is missing from the scan, shows \
             the deviations of X and Y over time. Their peak-to-peak values are {} at 0.5 rad/s and {} at 1.5 \
             rad/s, so that Y exceeds 3 µm at the lower speed already. Half of these values, an amplitude, would be \
             below 2 µm on both axes.",
            both(lower_um),
            both(higher_um),
        ),
        format!(
            "Read radially, as a circular deviation about the least-squares circle, the error is {} and {} µm at \
             the two speeds, which is less than printed at the lower one. At that speed the friction of X and Y \
             acts against the motion and displaces the table along the circle, not radially, except at the quadrant \
             changes.",
            radial_um[0], radial_um[1],
        ),
        "α is printed in s²/m², β in s/m, and v without a unit. tanh αv must change its sign with v, so that α is \
         read in s/m and v in m/s. With v in mm/s, the square alone would give a coefficient of 200 at 50 mm/s."
            .to_owned(),
        "The inertia of X has a minus in equation 10 and a plus in 14. Equations 2 and 8 lead to the plus, which is \
         used. The sign does not affect the result: with the sign reversed, each deviation runs backwards in time \
         between the same least and greatest values."
            .to_owned(),
        "The two speeds of the figure are printed as 0.5 and 0.5 rad/s; earlier in the text as 0.5 and 1.5, which \
         are used."
            .to_owned(),
        "The initial condition is not printed. From rest, the full friction acts on Y as a step, and Y overshoots \
         to nearly twice its deviation, as a spring with 1 % of damping does; here the first lap is discarded."
            .to_owned(),
        format!(
            "The paper states that the greatest error occurs where a speed is close to zero, without a value. It \
             counts as agreeing if it is closer to an axis than to a diagonal. Friction reverses while the speed \
             rises to 1/α = 20 mm/s, which takes {}° of the lap at 0.5 rad/s, so that agreement is narrow there, \
             and {}° at 1.5.",
            turning_degrees[0], turning_degrees[1],
        ),
        "Glitches of the master–slave changeover are said to occur every 45 degrees. The axes change roles where \
         their speeds are equal, which is on the diagonals, 45 degrees from either axis: four times per lap, not \
         eight."
            .to_owned(),
        "The paper gives no sizes for the contributors; those used here were chosen to be visible at one scale. The \
         values are the circular deviation G of ISO 230-4 in the worse direction, and the reversal value B of ISO \
         230-2, fitted from 3 to 20 degrees beside the reversals of each axis. ISO 230-4 itself compares the \
         directions by their greatest difference H. The friction of the paper has not fully reversed at 3 degrees: \
         its B results from the gradual reversal and is not lost motion."
            .to_owned(),
    ]
}
