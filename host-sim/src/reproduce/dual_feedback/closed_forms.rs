//! The closed forms of the appendix, (9) to (16), against the system run in [`super::response`].
//!
//! Lost motion ΔQ, K = 1/T, K' = 1/T' = 1/(αT), no command:
//!
//! ```text
//! (9), (10)   Qo/ΔQ = 1/((1 + Ts)(1 + T's)) − 1
//! (11), (12)  step:  Qo = −ΔQ·(T·e^(−t/T) − T'·e^(−t/T'))/(T − T'),   T = T': −ΔQ·(1 + t/T)·e^(−t/T)
//!             ramp:  Qo = −r·(T²(1 − e^(−t/T)) − T'²(1 − e^(−t/T')))/(T − T')
//! (13), (14)  breaks at 1/(T + T'), 1/T, 1/T', (T + T')/(TT')
//! (15)        Qc = −ΔQb·e^(−K't) for a step, −ΔQp/K'·(1 − e^(−K't)) for a ramp
//! (16)        Qc of both at once: their sum
//! ```
//!
//! A tick holds what continuous time lets slide: the shift is late by up to h·ΔQ/T', which bounds every deviation.

use super::printed;
use super::response::{Response, Shown, TICK_S, Times, at, breaks, run};
use crate::report::number::{fixed, significant};
use crate::report::plot::{Chart, Ink, Layer};
use crate::reproduce::{Outcome, Picture, Printed, ReproduceError, Study};

/// T, s: Kp = 33 1/s.
const POSITION_S: f64 = 0.03;

/// T'/T.
const ALPHAS: [f64; 3] = [1.0 / 3.0, 1.0, 8.0 / 3.0];

/// Lost motion, nm.
const STEP_NM: f64 = 10_000.0;

/// What fixed point leaves of 10 µm, nm: its gains are h/T' right to 2⁻²⁵ of one, 5e-5 of themselves, and an answer goes
/// with at most 1/e of that; half of its 1/16 nm stands in each of the two integrators.
const FORMAT_NM: f64 = 0.3;

/// Half a second.
const TICKS: u32 = 10_000;

/// One closed form: what ΔQ is (nm), what is looked at, and what it should be (nm), over time (s).
struct Form {
    name: &'static str,
    /// Of ΔQ over time.
    lost_nm: fn(Times, f64) -> f64,
    shown_nm: fn(&Shown) -> f64,
    exact_nm: fn(Times, f64) -> f64,
}

/// Pitch error, nm/s, that in the end is as much as the step: ΔQp/K' = ΔQb.
fn ramp_nm_per_s(times: Times) -> f64 {
    STEP_NM / times.shift_s
}

/// Qo of a step of one.
fn after_step(Times { position_s, shift_s }: Times, time_s: f64) -> f64 {
    let fades = |time_constant: f64| (-time_s / time_constant).exp();
    if is_equal(position_s, shift_s) {
        -(1.0 + time_s / position_s) * fades(position_s)
    } else {
        -(position_s * fades(position_s) - shift_s * fades(shift_s)) / (position_s - shift_s)
    }
}

/// Qo of a ramp of one a second.
fn after_ramp(Times { position_s, shift_s }: Times, time_s: f64) -> f64 {
    if is_equal(position_s, shift_s) {
        return -(2.0 * position_s - (2.0 * position_s + time_s) * (-time_s / position_s).exp());
    }
    let part = |time_constant: f64| -time_constant.powi(2) * (-time_s / time_constant).exp_m1();
    -(part(position_s) - part(shift_s)) / (position_s - shift_s)
}

fn is_equal(one: f64, other: f64) -> bool {
    (one - other).abs() < 1e-9
}

/// Qc of a step of one: what of it the second detector still sees.
fn unseen(times: Times, time_s: f64) -> f64 {
    (-time_s / times.shift_s).exp()
}

const FORMS: [Form; 5] = [
    Form {
        name: "step, table Qo, (11) and (12)",
        lost_nm: |_, _| STEP_NM,
        shown_nm: |row| row.table_nm,
        exact_nm: |times, time_s| STEP_NM * after_step(times, time_s),
    },
    Form {
        name: "ramp, table Qo, from (10)",
        lost_nm: |times, time_s| ramp_nm_per_s(times) * time_s,
        shown_nm: |row| row.table_nm,
        exact_nm: |times, time_s| ramp_nm_per_s(times) * after_ramp(times, time_s),
    },
    Form {
        name: "step, second detector Qc",
        lost_nm: |_, _| STEP_NM,
        shown_nm: |row| row.second_nm,
        exact_nm: |times, time_s| -STEP_NM * unseen(times, time_s),
    },
    Form {
        name: "ramp, second detector Qc, (15)",
        lost_nm: |times, time_s| ramp_nm_per_s(times) * time_s,
        shown_nm: |row| row.second_nm,
        exact_nm: |times, time_s| -STEP_NM * (1.0 - unseen(times, time_s)),
    },
    Form {
        name: "step and ramp of half of it at once, Qc, (16)",
        lost_nm: |times, time_s| STEP_NM + 0.5 * ramp_nm_per_s(times) * time_s,
        shown_nm: |row| row.second_nm,
        exact_nm: |times, time_s| -STEP_NM * (0.5 + 0.5 * unseen(times, time_s)),
    },
];

impl Form {
    /// Farthest that the run is from the closed form, nm.
    fn farthest_nm(&self, times: Times) -> f64 {
        let rows = run(times, TICKS, |time_s| (self.lost_nm)(times, time_s));
        let off = |(tick, row): (u32, &Shown)| {
            ((self.shown_nm)(row) - (self.exact_nm)(times, f64::from(tick) * TICK_S)).abs()
        };
        (0u32..).zip(&rows).map(off).fold(0.0, f64::max)
    }
}

/// What a tick may add, nm: as much as the shift moves in it, for a step and a ramp of ΔQ.
fn bound_nm(times: Times) -> f64 {
    2.0 * STEP_NM * TICK_S / times.shift_s + FORMAT_NM
}

fn times(alpha: f64) -> Times {
    Times { position_s: POSITION_S, shift_s: alpha * POSITION_S }
}

/// |G| of (13).
fn magnitude(Times { position_s, shift_s }: Times, omega: f64) -> f64 {
    let (x, y) = (omega * position_s, omega * shift_s);
    (x + y).hypot(x * y) / (1f64.hypot(x) * 1f64.hypot(y))
}

/// (13), rad/s, in the order of its text.
fn break_frequencies(Times { position_s, shift_s }: Times) -> [f64; 4] {
    let sum = position_s + shift_s;
    [1.0 / sum, 1.0 / position_s.max(shift_s), 1.0 / position_s.min(shift_s), sum / (position_s * shift_s)]
}

/// Greatest |Qc| of backlash and pitch error at once, nm; the one is STEP_NM, the other `ratio` of it in the end.
fn greatest_of_both_nm(times: Times, ratio: f64) -> f64 {
    let rows = run(times, 2 * TICKS, |time_s| STEP_NM + ratio * ramp_nm_per_s(times) * time_s);
    rows.iter().fold(0.0, |most, row| most.max(row.second_nm.abs()))
}

/// Measured from 0.03 to 30 times 1/T, four a decade.
fn bode(times: Times) -> Vec<Response> {
    (-6..=6).map(|quarter| at(times, 10f64.powf(0.25 * f64::from(quarter)) / times.position_s)).collect()
}

/// Adds the closed forms.
///
/// # Errors
/// When the fit of the break frequencies fails.
pub fn add(study: &mut Study) -> Result<(), ReproduceError> {
    let systems = ALPHAS.map(times);
    let most_nm = systems.map(bound_nm).into_iter().fold(0.0, f64::max);
    for form in &FORMS {
        let farthest_nm = systems.map(|times| form.farthest_nm(times)).into_iter().fold(0.0, f64::max);
        study.outcomes.push(Outcome::new(
            format!("{}: farthest from the closed form", form.name),
            Printed::Below(rounded(100.0 * most_nm / STEP_NM, 2)),
            100.0 * farthest_nm / STEP_NM,
            "% of ΔQ",
        ));
    }
    let responses = systems.map(bode);
    add_breaks(study, systems[2], &responses[2])?;
    add_claims(study, &responses);
    study.pictures.push(picture_of_steps(systems));
    study.pictures.push(picture_of_bode(systems, &responses));
    Ok(())
}

/// To so many digits behind the point, for a printed bound.
fn rounded(value: f64, decimals: i32) -> f64 {
    let unit = 10f64.powi(decimals);
    (value * unit).round() / unit
}

fn add_breaks(study: &mut Study, times: Times, responses: &[Response]) -> Result<(), ReproduceError> {
    let unfit = || ReproduceError::Numerics("no break frequencies fit the measured responses".to_owned());
    // From a tenth to ten times the middle of the four.
    let found = breaks(&responses[2..11]).ok_or_else(unfit)?;
    let names = ["1/(T + T')", "1/T'", "1/T", "(T + T')/(TT')"];
    for ((name, exact), found) in names.into_iter().zip(break_frequencies(times)).zip(found) {
        study.outcomes.push(Outcome::new(
            format!("Bode diagram, break at {name}, T = 0.03 s, T' = 0.08 s"),
            printed(rounded(exact, 1), 0.1),
            found,
            "rad/s",
        ));
    }
    Ok(())
}

/// What the paper concludes from its formulas.
fn add_claims(study: &mut Study, responses: &[Vec<Response>; 3]) {
    let highest =
        responses.each_ref().map(|responses| responses.iter().map(Response::magnitude).fold(0.0, f64::max));
    // A tenth of T, where it is highest: |G|² − 1 = (2αx² − 1)/((1 + x²)(1 + α²x²)), x = ωT.
    let small = times(0.1);
    let at_small = (2..=5).map(|times_four| at(small, f64::from(times_four) / small.position_s).magnitude());
    let at_small = at_small.fold(0.0, f64::max);
    let greatest = |ratio: f64| greatest_of_both_nm(times(1.0), ratio) / STEP_NM;
    let (twice, half) = (greatest(2.0), greatest(0.5));
    study.outcomes.extend([
        Outcome::new(
            "highest |Qo/ΔQ| with T' = T/10, over that with T' = T (the paper: unusable for α ≪ 1)",
            Printed::Above(1.0),
            at_small / highest[1],
            "",
        ),
        Outcome::new(
            "backlash and pitch error at once: |Qc| over the greater of ΔQb and ΔQp/K'",
            Printed::Below(1.0 + rounded(bound_nm(times(1.0)) / STEP_NM, 4)),
            half.max(twice / 2.0),
            "",
        ),
        Outcome::new(
            "backlash and pitch error at once: |Qc| over the lesser of the two",
            Printed::Below(1.0 + rounded(bound_nm(times(1.0)) / STEP_NM, 4)),
            twice.max(half / 0.5),
            "",
        ),
    ]);
    study.said.push(format!(
        "The table moves by up to {} times the lost motion where T' = T, by {} times where T' is three times shorter: \
         2/√3 at the most.",
        significant(highest[1], 4),
        significant(highest[0], 4)
    ));
    study.notes.extend([
        "The paper rules α = T'/T far below one out because |Qo/ΔQ| is then above one. By its own formula (13) the magnitude \
         does not change when T and T' are exchanged, is above one for every α at ω > 1/√(2TT'), and highest, \
         2/√3, at α = 1: a small α is the milder case, and this verdict differs."
            .to_owned(),
        "\"In any case Qc does not exceed either ΔQp or ΔQb\" holds for the greater of the two: by (16) Qc is a mean of \
         ΔQb and ΔQp/K' that goes from the one to the other. It exceeds the lesser, and that verdict differs. ΔQp \
         stands there for ΔQp/K', the same number only at the paper's K' = 1 1/s."
            .to_owned(),
        "The condition printed as T = T' over the partial fractions of (11) is read T ≠ T'; the values of α in the paper's \
         figure of (12) are not in the scan, so 1/3, 1 and 8/3 are taken with T = 0.03 s."
            .to_owned(),
    ]);
}

fn line(ink: Ink, points: Vec<(f64, f64)>, is_marked: bool) -> Layer {
    Layer { ink, points, is_marked }
}

const INKS: [Ink; 3] = [Ink::Before, Ink::Third, Ink::Fourth];

fn keys(systems: [Times; 3], marks: &str) -> Vec<(&'static str, String)> {
    let name = |times: Times| format!("T' = {} s", fixed(times.shift_s, 2));
    let [a, b, c] = systems.map(name);
    vec![("before", a), ("cw", b), ("ccw", c), ("after", marks.to_owned())]
}

fn picture_of_steps(systems: [Times; 3]) -> Picture {
    const END_S: f64 = 0.35;
    let mut layers = Vec::new();
    for (times, ink) in systems.into_iter().zip(INKS) {
        let exact = (0..=350).map(|k| 1e-3 * f64::from(k)).map(|t| (t, after_step(times, t)));
        layers.push(line(ink, exact.collect(), false));
        let rows = run(times, TICKS, |_| STEP_NM);
        let marks =
            (0u32..).zip(&rows).step_by(400).map(|(k, row)| (f64::from(k) * TICK_S, row.table_nm / STEP_NM));
        layers.extend(marks.filter(|mark| mark.0 <= END_S).map(|mark| line(Ink::After, vec![mark], true)));
    }
    let title = "A step of the lost motion".to_owned();
    let caption = "How the table comes back after the lost motion has jumped by ΔQ, T = 0.03 s: closed forms (11) and (12), \
                   and the controller's dual feedback in fixed point behind an ideal motor."
        .to_owned();
    let chart = Chart {
        size: (560, 240),
        title: &title,
        description: &caption,
        x: "time, s",
        y: "table Qo, ΔQ",
        noise: 0.0,
        layers,
    };
    let svg = chart.svg();
    Picture { title, svg, caption, keys: keys(systems, "run") }
}

fn picture_of_bode(systems: [Times; 3], responses: &[Vec<Response>; 3]) -> Picture {
    let db = |magnitude: f64| 20.0 * magnitude.log10();
    let mut layers = Vec::new();
    for ((times, responses), ink) in systems.into_iter().zip(responses).zip(INKS) {
        let exact = (-150..=150).map(|k| 0.01 * f64::from(k));
        let exact = exact.map(|decade| (decade, db(magnitude(times, 10f64.powf(decade) / times.position_s))));
        layers.push(line(ink, exact.collect(), false));
        let place =
            |response: &Response| ((response.omega * times.position_s).log10(), db(response.magnitude()));
        layers.extend(responses.iter().map(|response| line(Ink::After, vec![place(response)], true)));
    }
    let title = "Bode diagram of the dual feedback system".to_owned();
    let caption = "How much of a lost motion that comes and goes the table shows, |Qo/ΔQ|: formula (13), and measured on the \
                   controller's dual feedback in fixed point. Slow lost motion is taken out; above (T + T')/(TT') the loop \
                   does not answer any more, as in a semi-closed one."
        .to_owned();
    let chart = Chart {
        size: (560, 240),
        title: &title,
        description: &caption,
        x: "log10 of ωT",
        y: "|Qo/ΔQ|, dB",
        noise: 0.0,
        layers,
    };
    let svg = chart.svg();
    Picture { title, svg, caption, keys: keys(systems, "measured") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each within what its own tick explains, and not by less than a twentieth of it where the shift is held.
    #[test]
    fn every_closed_form_holds_at_every_alpha() {
        for times in ALPHAS.map(times) {
            for form in &FORMS {
                let (farthest, bound) = (form.farthest_nm(times), bound_nm(times));
                assert!(farthest < bound, "{} {times:?}: {farthest} of {bound}", form.name);
            }
            assert!(FORMS[0].farthest_nm(times) > 0.02 * bound_nm(times));
        }
    }

    /// The step's closed form solves what it was made from: T·T'·Q″ + (T + T')·Q′ + Q = 0, by differences.
    #[test]
    fn the_step_solves_its_equation() {
        let h = 1e-4;
        for times in [Times { position_s: 0.03, shift_s: 0.01 }, times(1.0)] {
            for t in [0.005, 0.03, 0.1] {
                let q = |k: f64| after_step(times, t + k * h);
                let (first, second) =
                    ((q(1.0) - q(-1.0)) / (2.0 * h), (q(1.0) - 2.0 * q(0.0) + q(-1.0)) / (h * h));
                let Times { position_s, shift_s } = times;
                let sum = position_s * shift_s * second + (position_s + shift_s) * first + q(0.0);
                assert!(sum.abs() < 1e-4, "{times:?} {t}: {sum}");
            }
            // The ramp's is the step's integral.
            let slope = (after_ramp(times, 0.05 + h) - after_ramp(times, 0.05 - h)) / (2.0 * h);
            assert!((slope - after_step(times, 0.05)).abs() < 1e-5);
        }
    }

    /// Held over a tick the motor's share is off by (ωh)²/3 of itself at most, and 5e-5 in fixed point.
    #[test]
    fn the_magnitude_is_that_of_the_formula() {
        for times in ALPHAS.map(times) {
            for response in bode(times) {
                let exact = magnitude(times, response.omega);
                let motor = 1.0
                    / (1f64.hypot(response.omega * times.position_s)
                        * 1f64.hypot(response.omega * times.shift_s));
                let tolerance = 1.02
                    * motor
                    * ((response.omega * TICK_S).powi(2) / 3.0 + (TICK_S / times.shift_s).powi(2) / 6.0)
                    + 5e-5;
                assert!((response.magnitude() - exact).abs() < tolerance, "{times:?} {response:?} {exact}");
            }
        }
    }
}
