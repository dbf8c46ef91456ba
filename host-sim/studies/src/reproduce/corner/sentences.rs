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
            "The printed feed-forward of 51 % indicates the control law of the paper's machine: HPC keeps a \
             circle's radius with Kf = {} % at Kp = 33, 51, 75, P with {} %. In closed form HPC requires 50 % at \
             any Kp: its zero then cancels the pole at −2·Kp, and a second-order system with ζ = 1/√2 remains.",
            list(hpc, &|t| t.feedforward.motor_percent),
            list(p, &|t| t.feedforward.motor_percent),
        ),
        format!(
            "Identified at Kp = 33: X {:.0} Hz with ζ = {:.2}, Y {:.0} Hz with ζ = {:.2}.",
            x.0, x.1, y.0, y.1
        ),
        format!(
            "Under HPC with Kf = {FEEDFORWARD_PERCENT} % the overshoot at the corner is {} µm at the tool and {} µm \
             at the motors, for Kp = 33, 51, 75; without feed-forward it is {} µm at the tool. With the \
             feed-forward that keeps the radius of the tool's circle ({} %) it is {} µm. The feed-forward that is \
             correct for the circle is too large at the corner, increasingly so for lower Kp.",
            list(hpc, &|t| t.printed.overshoot_um()),
            list(hpc, &|t| t.printed.motor_overshoot_um()),
            list(hpc, &|t| t.without.overshoot_um()),
            list(hpc, &|t| t.feedforward.tool_percent),
            list(hpc, &|t| t.radius_kept.overshoot_um()),
        ),
        format!(
            "Comparison with Kf = {FEEDFORWARD_PERCENT} %: P overshoots by {} µm and rounds the corner by {} µm, \
             HPC rounds it by {} µm. With the feed-forward for its own circle, P overshoots by {} µm.",
            list(p, &|t| t.printed.overshoot_um()),
            list(p, &|t| t.printed.rounding_um()),
            list(hpc, &|t| t.printed.rounding_um()),
            list(p, &|t| t.radius_kept.overshoot_um()),
        ),
        format!(
            "The tool's overshoot decreases from Kp = 51 to 75 (ratio {:.2}; predicted: {:.2}). This decrease is \
             within the error of the prediction, and specific to the stiff machine. With two thirds of the \
             structural frequencies, identified as {soft_x:.0} and {soft_y:.0} Hz, the ratio is {:.2}, because the \
             oscillation of the structure increases by more than the overshoot of the motors decreases, and the \
             prediction at Kp = 75 has an error of {:.1} µm.",
            hpc[2].printed.overshoot_um() / hpc[1].printed.overshoot_um(),
            predicted_m(2) / predicted_m(1),
            softer.overshoot_ratio,
            softer.difference_um,
        ),
    ]
}

/// Readings that were used where the printed text is unclear or wrong, with the reason.
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
            "Equation (1), HPC, is printed as k1k2Kp²/(s² + k2·s + k1k2Kp²) and lacks a Kp in two positions. As \
             printed, the slowest pole of the loop is at {} 1/s for any Kp. With only the leading Kp restored, the \
             loop is unstable above Kp = 6 1/s (at Kp = 33 with a pole at {pole_per_s:+.0} 1/s). Used here: \
             Kp·k1k2Kp²/(s² + k2·Kp·s + k1k2Kp²), with poles at −2·Kp and (−2 ± 2j)·Kp. It requires 50 % of \
             feed-forward for a true circle at every Kp, close to the 51 % printed for all three gains, which \
             supports the correction.",
            fixed(printed_hpc_pole_per_s(low.gain_per_s, 0), 2),
        ),
        format!(
            "Kf: 51 % is a setting made on a machine in steps of 1 %; the closed form is 50 %, as in our \
             simulation. On our circle of {:.0} mm at Kp = 33 the difference is {radius_difference_um:.1} µm of \
             radius. Radius and feed of the paper's circle are not printed.",
            1e3 * RADIUS_M,
        ),
        format!(
            "The paper explains the decrease at the table by a lag of the mechanics that falls as Kp rises. A \
             linear system behind the motors has the same lag at any Kp. Its contribution to the overshoot grows \
             from {:.1} to {:.1} µm, because the motors turn more sharply. What decreases is the overshoot of the \
             motors.",
            added_by_mechanics_um(&low.printed),
            added_by_mechanics_um(&experiment.hpc[2].printed),
        ),
        "All figures are missing from the scan. The text does not give the lengths in figure 3: two lines of 20 mm \
         are run, with X continuing and Y reversing as in the text. With acceleration before interpolation and \
         trapezoidal ramps, each line begins and ends at rest; the acceleration is √2 · 7.3 m/s² along the path, \
         which is Y's printed limit. Figure 2 is taken as position law, PI velocity loop on a rigid mass, and \
         integrator."
            .to_owned(),
        "ωi, ζi and sizes of overshoot are not printed. Masses, stiffness, friction and structure of the plant are \
         chosen here (machine.toml). The structure was chosen after a softer one had failed; it is one of those \
         whose overshoot at the tool decreases up to Kp = 75, as in the paper. The softer machine above shows the \
         opposite. Ti was 20 ms at first and was then set to 5 ms, which is critically damped; the longer Ti \
         overshoots more and requires 1 to 2 % less Kf on the circle. The force limit was raised until the printed \
         accelerations were reached: those four values show that the plant has the declared properties, and do not \
         confirm the paper."
            .to_owned(),
        "The paper equates tool and table (yTool = yt) and measures the tool with a grid encoder; here contours are \
         those of the tool point. The paper predicts the table from measured motors; here the tool is predicted \
         from the command alone. The paper says \"about 5 µm\"; the bound here is 5."
            .to_owned(),
        "Two items of the paper's section 2 are numbered (3); the second is the feed drive, equation (3).".to_owned(),
    ]
}
