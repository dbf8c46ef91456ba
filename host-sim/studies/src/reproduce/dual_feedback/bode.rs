//! The Bode diagram of the appendix, (13) and (14), measured on the system in [`super::ideal_loop`].
//!
//! ```text
//! G = Qo/ΔQ = −s(T + T' + TT's)/((1 + Ts)(1 + T's));   breaks at 1/(T + T'), 1/T, 1/T', (T + T')/(TT')
//! |G|² − 1 = (2αx² − 1)/((1 + x²)(1 + α²x²)),  x = ωT, α = T'/T
//! ```

use super::frequency_response::{Response, fit_breaks, measure};
use super::ideal_loop::{ALPHAS, TimeConstants};
use super::plotting::{INKS, legend, line, marker, rounded};
use crate::reproduce::study::{Outcome, Picture, Printed, ReproduceError, Study};
use files::format::significant;
use pages::plot::{Chart, Ink};

/// |G| of (13); `omega` in rad/s.
fn magnitude(TimeConstants { position_s, dual_s }: TimeConstants, omega: f64) -> f64 {
    let (x, y) = (omega * position_s, omega * dual_s);
    libm::hypot(x + y, x * y) / (libm::hypot(1f64, x) * libm::hypot(1f64, y))
}

/// Break frequencies of (13), rad/s, ascending.
fn break_frequencies(TimeConstants { position_s, dual_s }: TimeConstants) -> [f64; 4] {
    let sum = position_s + dual_s;
    [1.0 / sum, 1.0 / position_s.max(dual_s), 1.0 / position_s.min(dual_s), sum / (position_s * dual_s)]
}

/// Responses from 0.03/T to 30/T, four per decade.
fn bode(times: TimeConstants) -> Vec<Response> {
    (-6..=6)
        .map(|quarter| measure(times, libm::pow(10f64, 0.25 * f64::from(quarter)) / times.position_s))
        .collect()
}

/// Adds the Bode diagram.
///
/// # Errors
/// If the fit of the break frequencies fails.
pub fn add(study: &mut Study) -> Result<(), ReproduceError> {
    let systems = ALPHAS.map(TimeConstants::with_alpha);
    let responses = systems.map(bode);
    add_breaks(study, systems[2], &responses[2])?;
    add_magnitudes(study, &responses);
    study.pictures.push(picture(systems, &responses));
    Ok(())
}

/// Break frequencies fitted to the responses, against the formulas.
fn add_breaks(study: &mut Study, times: TimeConstants, responses: &[Response]) -> Result<(), ReproduceError> {
    let no_fit = || ReproduceError::Numerics("no break frequencies fit the measured responses".to_owned());
    // From 0.1/T to 10/T: one decade on either side of the breaks.
    let found = fit_breaks(&responses[2..11]).ok_or_else(no_fit)?;
    let names = ["1/(T + T')", "1/T'", "1/T", "(T + T')/(TT')"];
    for ((name, exact), found) in names.into_iter().zip(break_frequencies(times)).zip(found) {
        study.outcomes.push(Outcome::new(
            format!("Bode diagram, break at {name}, T = 0.03 s, T' = 0.08 s"),
            Printed::to_digit(rounded(exact, 1), 0.1),
            found,
            "rad/s",
        ));
    }
    Ok(())
}

/// The paper's conclusion about small α, against the maxima of |G|.
fn add_magnitudes(study: &mut Study, responses: &[Vec<Response>; 3]) {
    let max = |responses: &[Response]| numerics::max_abs(responses.iter().map(Response::magnitude));
    let highest = responses.each_ref().map(|responses| max(responses));
    // The maximum is near ωT = 1/√α, about 3 for α = 0.1.
    let small = TimeConstants::with_alpha(0.1);
    let near_maximum = [2.0, 3.0, 4.0, 5.0].map(|x| measure(small, x / small.position_s));
    study.outcomes.push(Outcome::new(
        "highest |Qo/ΔQ| with T' = T/10, over that with T' = T (the paper: unusable for α ≪ 1)",
        Printed::Above(1.0),
        max(&near_maximum) / highest[1],
        "",
    ));
    study.findings.push(format!(
        "The table deviates by at most {} times the amplitude of a periodic lost motion for T' = T, and by {} times \
         for T' three times shorter. The theoretical maximum is 2/√3.",
        significant(highest[1], 4),
        significant(highest[0], 4)
    ));
    study.notes.push(
        "The paper excludes α = T'/T far below one because |Qo/ΔQ| is then above one. By its own formula (13), \
         however, the magnitude does not change when T and T' are exchanged, is above one for every α at ω > \
         1/√(2TT'), and has its maximum, 2/√3, at α = 1. A small α is the milder case, and this verdict differs."
            .to_owned(),
    );
}

/// |G| over ωT: formula (13) as lines, measurements as markers.
fn picture(systems: [TimeConstants; 3], responses: &[Vec<Response>; 3]) -> Picture {
    let db = |magnitude: f64| 20.0 * libm::log10(magnitude);
    let mut layers = Vec::new();
    for ((times, responses), ink) in systems.into_iter().zip(responses).zip(INKS) {
        let exact = (-150..=150).map(|k| 0.01 * f64::from(k));
        let exact =
            exact.map(|decade| (decade, db(magnitude(times, libm::pow(10f64, decade) / times.position_s))));
        layers.push(line(ink, exact.collect()));
        let point =
            |response: &Response| (libm::log10(response.omega * times.position_s), db(response.magnitude()));
        layers.extend(responses.iter().map(|response| marker(Ink::After, point(response))));
    }
    let title = "Bode diagram of the dual feedback system".to_owned();
    let caption = "Response |Qo/ΔQ| of the table to a sinusoidal lost motion: formula (13), and measured with the \
                   controller's dual feedback in fixed point. Slow lost motion is compensated; above (T + T')/(TT') \
                   the loop no longer responds, as in a semi-closed one."
        .to_owned();
    let chart = Chart {
        size: (960, 260),
        title: &title,
        description: &caption,
        x: "log10 of ωT",
        y: "|Qo/ΔQ|, dB",
        noise: Some(0.0),
        layers,
    };
    let svg = chart.svg();
    Picture { title, svg, caption, legend: legend(systems, "measured") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::dual_feedback::ideal_loop::TICK_S;

    /// The zero-order hold changes the motor's contribution by (ωh)²/3 of itself at most; fixed point by 5e-5.
    #[test]
    fn the_magnitude_is_that_of_the_formula() {
        for times in ALPHAS.map(TimeConstants::with_alpha) {
            for response in bode(times) {
                let exact = magnitude(times, response.omega);
                let motor = 1.0
                    / (1f64.hypot(response.omega * times.position_s)
                        * 1f64.hypot(response.omega * times.dual_s));
                let tolerance = 1.02
                    * motor
                    * ((response.omega * TICK_S).powi(2) / 3.0 + (TICK_S / times.dual_s).powi(2) / 6.0)
                    + 5e-5;
                assert!((response.magnitude() - exact).abs() < tolerance, "{times:?} {response:?} {exact}");
            }
        }
    }
}
