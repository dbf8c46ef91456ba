//! Findings and notes as text.

use std::f64::consts::TAU;

use super::contour::overshoot_m;
use super::drive_model::printed_hpc_pole_per_s;
use super::experiment::{Corner, Experiment, FEEDFORWARD_PERCENT, LawAtGain};
use super::machine::{FEED_M_PER_S, RADIUS_M};
use files::format::fixed;

/// The findings, one paragraph each.
pub fn findings(experiment: &Experiment) -> Vec<String> {
    let list = |runs: &[LawAtGain], value: &dyn Fn(&LawAtGain) -> f64| {
        let values: Vec<String> = runs.iter().map(|run| format!("{:.0}", value(run))).collect();
        values.join(", ")
    };
    let (hpc, p) = (&experiment.hpc[..], &experiment.p[..]);
    let [x, y] = experiment.mechanics.map(|m| (m.omega_per_s / TAU, m.damping_ratio));
    let predicted_m =
        |gain: usize| overshoot_m(&experiment.predictions[gain].tool, &hpc[gain].printed.window);
    let softer = &experiment.softer;
    let [soft_x, soft_y] = softer.mechanics.map(|m| m.omega_per_s / TAU);
    vec![
        format!(
            "The printed feed-forward of 51 % points to the law that the paper's machine ran: HPC keeps a circle's radius with Kf = {} % \
             at Kp = 33, 51, 75, P takes {} %. In closed form HPC takes 50 % at any Kp: its zero then cancels the pole \
             at −2·Kp, and a second order with ζ = 1/√2 is left.",
            list(hpc, &|t| t.feedforward.motor_percent),
            list(p, &|t| t.feedforward.motor_percent),
        ),
        format!(
            "Identified at Kp = 33: X {:.0} Hz with ζ = {:.2}, Y {:.0} Hz with ζ = {:.2}.",
            x.0, x.1, y.0, y.1
        ),
        format!(
            "Under HPC with Kf = {FEEDFORWARD_PERCENT} % the tool stands out of the corner by {} µm at Kp = 33, 51, 75, the \
             motors by {} µm; without feed-forward the tool by {} µm. With the feed-forward that keeps the tool's circle \
             ({} %) it is {} µm: what is right on the circle is too much in the corner, and the more so the lower Kp is.",
            list(hpc, &|t| t.printed.overshoot_um()),
            list(hpc, &|t| t.printed.motor_overshoot_um()),
            list(hpc, &|t| t.without.overshoot_um()),
            list(hpc, &|t| t.feedforward.tool_percent),
            list(hpc, &|t| t.radius_kept.overshoot_um()),
        ),
        format!(
            "Side by side with Kf = {FEEDFORWARD_PERCENT} %: P stands out by {} µm and rounds the corner by {} µm, HPC rounds it \
             by {} µm. With the feed-forward of its own circle P stands out by {} µm.",
            list(p, &|t| t.printed.overshoot_um()),
            list(p, &|t| t.printed.rounding_um()),
            list(hpc, &|t| t.printed.rounding_um()),
            list(p, &|t| t.radius_kept.overshoot_um()),
        ),
        format!(
            "That the tool's overshoot still eases from Kp = 51 to 75 (to {:.2} of it; predicted: {:.2}) is within what the prediction leaves open, and the stiff machine's: with the \
             structure's frequencies at two thirds, which identifies as {soft_x:.0} and {soft_y:.0} Hz, it grows to {:.2} of it, for the \
             structure swings more than the motors overshoot less, and the prediction at Kp = 75 is out by {:.1} µm.",
            hpc[2].printed.overshoot_um() / hpc[1].printed.overshoot_um(),
            predicted_m(2) / predicted_m(1),
            softer.overshoot_ratio,
            softer.difference_um,
        ),
    ]
}

/// Where the printed text is unclear or wrong: what was read instead, and why.
pub fn notes(experiment: &Experiment) -> Vec<String> {
    let low = &experiment.hpc[0];
    let w = FEED_M_PER_S / RADIUS_M / low.gain_per_s;
    let square = |percent: f64| (1e-2 * percent).powi(2);
    let radius_difference_um =
        0.5e6 * RADIUS_M * w * w * (square(FEEDFORWARD_PERCENT) - square(low.feedforward.motor_percent));
    let pole_per_s = printed_hpc_pole_per_s(low.gain_per_s, 1);
    let added_by_mechanics_um = |corner: &Corner| corner.overshoot_um() - corner.motor_overshoot_um();
    vec![
        format!(
            "Equation (1), HPC, is printed as k1k2Kp²/(s² + k2·s + k1k2Kp²) and has lost a Kp twice: as printed the loop \
             creeps with its slowest pole at {} 1/s whatever Kp is, and with only the Kp before it put back it is \
             unstable above Kp = 6 1/s (at Kp = 33 a pole at {pole_per_s:+.0} 1/s). Used here: \
             Kp·k1k2Kp²/(s² + k2·Kp·s + k1k2Kp²), with poles at −2·Kp and (−2 ± 2j)·Kp. That this takes 50 % of \
             feed-forward for a true circle at every Kp, and 51 % are printed for all three, speaks for it.",
            fixed(printed_hpc_pole_per_s(low.gain_per_s, 0), 2),
        ),
        format!(
            "Kf: 51 % is a setting made on a machine, to 1 %; the closed form is 50 %, which \
             ours finds. On our circle of {:.0} mm at Kp = 33 the difference is {radius_difference_um:.1} µm of radius. Radius and feed of \
             the paper's circle are not printed.",
            1e3 * RADIUS_M,
        ),
        format!(
            "The paper reads the easing at the table as a lag of the mechanics that falls as Kp rises. A linear system \
             behind the motors has one lag whatever Kp is, and here what it adds to the overshoot grows from {:.1} to \
             {:.1} µm, because the motors turn more sharply. What eases is the motors' part.",
            added_by_mechanics_um(&low.printed),
            added_by_mechanics_um(&experiment.hpc[2].printed),
        ),
        "All figures are missing from the scan. The lengths of figure 3 are not in the text: two lines of 20 mm are run, X going on, Y \
         turning back, as the text says. Acceleration before interpolation with trapezoids lets each line begin and \
         end at rest; it is √2 · 7.3 m/s² along the path, Y's printed limit. Figure 2 is taken as position law, PI \
         velocity loop on a rigid mass, and integrator."
            .to_owned(),
        "ωi, ζi and sizes of overshoot are not printed: the plant's masses, stiffness, friction and structure are ours \
         (machine.toml). Its structure was chosen, after a softer one had failed, among those whose overshoot at the tool \
         eases up to Kp = 75 as the paper found; one like that stands \
         beside it above. Ti was 20 ms first and became the critically damped 5 ms; the longer one overshoots more and \
         takes 1 to 2 % less Kf on the circle. The force limit was raised until the printed accelerations are held: \
         those four figures show that the plant is the declared one, not that the paper is confirmed."
            .to_owned(),
        "The paper takes the tool for the table (yTool = yt) and measures it with a grid encoder; here contours are those \
         of the tool point. Where the paper predicts the table from measured motors, the tool here follows from the \
         command alone. The paper says \"about 5 µm\"; agreement is asked for below 5."
            .to_owned(),
        "Two items of the paper's section 2 are numbered (3); the second is the feed drive, equation (3).".to_owned(),
    ]
}
