//! The closed forms of the appendix in time, (9) to (12), (15) and (16), against the system in
//! [`super::ideal_loop`].
//!
//! With the lost motion ΔQ, K = 1/T, K' = 1/T' = 1/(αT), and no command:
//!
//! ```text
//! (9), (10)   Qo/ΔQ = 1/((1 + Ts)(1 + T's)) − 1
//! (11), (12)  step:  Qo = −ΔQ·(T·e^(−t/T) − T'·e^(−t/T'))/(T − T'),   T = T': −ΔQ·(1 + t/T)·e^(−t/T)
//!             ramp:  Qo = −r·(T²(1 − e^(−t/T)) − T'²(1 − e^(−t/T')))/(T − T')
//! (15)        Qc = −ΔQb·e^(−K't) for a step, −ΔQp/K'·(1 − e^(−K't)) for a ramp
//! (16)        Qc of both at once: their sum
//! ```
//!
//! The sampled system holds its values over a tick h: the shift lags by up to h·ΔQ/T', which bounds every deviation.

use super::ideal_loop::{ALPHAS, Output, TICK_S, TimeConstants, run};
use super::plotting::{INKS, legend, line, marker, rounded};
use crate::reproduce::study::{Outcome, Picture, Printed, Study};
use pages::plot::{Chart, Ink};

/// Step of the lost motion ΔQ, nm.
const STEP_NM: f64 = 10_000.0;

/// Error of the number format on 10 µm, nm: the gains h/T' are rounded to 2⁻²⁵, 5e-5 relative, of which at most 1/e
/// appears in a response; each of the two integrators is rounded to half of 1/16 nm.
const FORMAT_NM: f64 = 0.3;

/// Duration of a run: 0.5 s.
const TICKS: u32 = 10_000;

/// One closed form.
struct Form {
    /// Name in the report.
    name: &'static str,
    /// Lost motion ΔQ (nm) over time (s).
    lost_nm: fn(TimeConstants, f64) -> f64,
    /// The output that is compared, nm.
    output_nm: fn(&Output) -> f64,
    /// The closed form of that output (nm) over time (s).
    exact_nm: fn(TimeConstants, f64) -> f64,
}

/// Rate of a ramp, nm/s, whose final Qc equals that of the step: `ΔQp/K' = ΔQb`.
fn ramp_nm_per_s(times: TimeConstants) -> f64 {
    STEP_NM / times.dual_s
}

/// Qo after a unit step, (11) and (12).
fn step_response(TimeConstants { position_s, dual_s }: TimeConstants, time_s: f64) -> f64 {
    let decay = |time_constant: f64| libm::exp(-time_s / time_constant);
    if is_equal(position_s, dual_s) {
        -(1.0 + time_s / position_s) * decay(position_s)
    } else {
        -(position_s * decay(position_s) - dual_s * decay(dual_s)) / (position_s - dual_s)
    }
}

/// Qo on a ramp of one per second: the integral of the step response.
fn ramp_response(TimeConstants { position_s, dual_s }: TimeConstants, time_s: f64) -> f64 {
    if is_equal(position_s, dual_s) {
        return -(2.0 * position_s - (2.0 * position_s + time_s) * libm::exp(-time_s / position_s));
    }
    let term = |time_constant: f64| -time_constant.powi(2) * libm::expm1(-time_s / time_constant);
    -(term(position_s) - term(dual_s)) / (position_s - dual_s)
}

/// Whether two time constants, s, are equal except for rounding.
fn is_equal(one: f64, other: f64) -> bool {
    (one - other).abs() < 1e-9
}

/// −Qc after a unit step, (15): e^(−t/T').
fn detector2_decay(times: TimeConstants, time_s: f64) -> f64 {
    libm::exp(-time_s / times.dual_s)
}

/// The closed forms that are compared.
const FORMS: [Form; 5] = [
    Form {
        name: "step, table Qo, (11) and (12)",
        lost_nm: |_, _| STEP_NM,
        output_nm: |row| row.table_nm,
        exact_nm: |times, time_s| STEP_NM * step_response(times, time_s),
    },
    Form {
        name: "ramp, table Qo, from (10)",
        lost_nm: |times, time_s| ramp_nm_per_s(times) * time_s,
        output_nm: |row| row.table_nm,
        exact_nm: |times, time_s| ramp_nm_per_s(times) * ramp_response(times, time_s),
    },
    Form {
        name: "step, second detector Qc",
        lost_nm: |_, _| STEP_NM,
        output_nm: |row| row.detector2_nm,
        exact_nm: |times, time_s| -STEP_NM * detector2_decay(times, time_s),
    },
    Form {
        name: "ramp, second detector Qc, (15)",
        lost_nm: |times, time_s| ramp_nm_per_s(times) * time_s,
        output_nm: |row| row.detector2_nm,
        exact_nm: |times, time_s| -STEP_NM * (1.0 - detector2_decay(times, time_s)),
    },
    Form {
        name: "step and ramp of half of it at once, Qc, (16)",
        lost_nm: |times, time_s| STEP_NM + 0.5 * ramp_nm_per_s(times) * time_s,
        output_nm: |row| row.detector2_nm,
        exact_nm: |times, time_s| -STEP_NM * (0.5 + 0.5 * detector2_decay(times, time_s)),
    },
];

impl Form {
    /// Maximum deviation of the run from the closed form, nm.
    fn max_deviation_nm(&self, times: TimeConstants) -> f64 {
        let rows = run(times, TICKS, |time_s| (self.lost_nm)(times, time_s));
        let deviation = |(tick, row): (u32, &Output)| {
            (self.output_nm)(row) - (self.exact_nm)(times, f64::from(tick) * TICK_S)
        };
        numerics::max_abs((0u32..).zip(&rows).map(deviation))
    }
}

/// Bound of the deviation by sampling, nm: the movement of the shift in one tick.
fn bound_nm(times: TimeConstants) -> f64 {
    STEP_NM * TICK_S / times.dual_s + FORMAT_NM
}

/// Maximum |Qc| with backlash and pitch error together, nm: a step of [`STEP_NM`], and a ramp with `ratio` times its
/// final Qc.
fn max_of_both_nm(times: TimeConstants, ratio: f64) -> f64 {
    let rows = run(times, 2 * TICKS, |time_s| STEP_NM + ratio * ramp_nm_per_s(times) * time_s);
    numerics::max_abs(rows.iter().map(|row| row.detector2_nm))
}

/// Adds the closed forms.
pub fn add(study: &mut Study) {
    let systems = ALPHAS.map(TimeConstants::with_alpha);
    let bound_nm_of_all = numerics::max_abs(systems.map(bound_nm));
    for form in &FORMS {
        let deviation_nm = numerics::max_abs(systems.map(|times| form.max_deviation_nm(times)));
        study.outcomes.push(Outcome::new(
            format!("{}: farthest from the closed form", form.name),
            Printed::Below(rounded(100.0 * bound_nm_of_all / STEP_NM, 2)),
            100.0 * deviation_nm / STEP_NM,
            "% of ΔQ",
        ));
    }
    let equal = TimeConstants::with_alpha(1.0);
    let max_of_both = |ratio: f64| max_of_both_nm(equal, ratio) / STEP_NM;
    let (twice, half) = (max_of_both(2.0), max_of_both(0.5));
    let one = Printed::Below(1.0 + rounded(bound_nm(equal) / STEP_NM, 4));
    study.outcomes.extend([
        Outcome::new(
            "backlash and pitch error at once: |Qc| over the greater of ΔQb and ΔQp/K'",
            one.clone(),
            half.max(twice / 2.0),
            "",
        ),
        Outcome::new(
            "backlash and pitch error at once: |Qc| over the lesser of the two",
            one,
            twice.max(half / 0.5),
            "",
        ),
    ]);
    study.pictures.push(step_picture(systems));
    study.notes.extend([
        "The paper concludes that Qc never exceeds ΔQp or ΔQb. This holds for the greater of the two: by (16), Qc \
         is a mean of ΔQb and ΔQp/K' that changes from one to the other over time. It exceeds the lesser of the \
         two, so that this verdict differs. ΔQp in the conclusion stands for ΔQp/K', which is the same number only \
         at the paper's K' = 1 1/s."
            .to_owned(),
        "The condition T = T' printed above the partial fractions of (11) is read as T ≠ T'. The values of α in the \
         paper's figure of (12) are not in the scan; 1/3, 1 and 8/3 are used with T = 0.03 s."
            .to_owned(),
    ]);
}

/// Table position after a step of the lost motion: closed forms as lines, runs as markers.
fn step_picture(systems: [TimeConstants; 3]) -> Picture {
    const END_S: f64 = 0.35;
    let mut layers = Vec::new();
    for (times, ink) in systems.into_iter().zip(INKS) {
        let exact = (0..=350).map(|k| 1e-3 * f64::from(k)).map(|t| (t, step_response(times, t)));
        layers.push(line(ink, exact.collect()));
        let rows = run(times, TICKS, |_| STEP_NM);
        let points =
            (0u32..).zip(&rows).step_by(400).map(|(k, row)| (f64::from(k) * TICK_S, row.table_nm / STEP_NM));
        layers.extend(points.filter(|point| point.0 <= END_S).map(|point| marker(Ink::After, point)));
    }
    let title = "A step of the lost motion".to_owned();
    let caption =
        "Table position after a step ΔQ of the lost motion, T = 0.03 s: closed forms (11) and (12), and the \
         controller's dual feedback in fixed point with an ideal motor."
            .to_owned();
    let chart = Chart {
        size: (960, 260),
        title: &title,
        description: &caption,
        x: "time, s",
        y: "table Qo, ΔQ",
        noise: Some(0.0),
        layers,
    };
    let svg = chart.svg();
    Picture { title, svg, caption, legend: legend(systems, "run") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each within the bound of its own sampling; in the table's step the effect of sampling is visible.
    #[test]
    fn every_closed_form_holds_at_every_alpha() {
        for times in ALPHAS.map(TimeConstants::with_alpha) {
            for form in &FORMS {
                let (deviation, bound) = (form.max_deviation_nm(times), bound_nm(times));
                assert!(deviation < bound, "{} {times:?}: {deviation} of {bound}", form.name);
            }
            assert!(FORMS[0].max_deviation_nm(times) > 0.02 * bound_nm(times));
        }
    }

    /// The step response solves T·T'·Q″ + (T + T')·Q′ + Q = 0, checked by finite differences.
    #[test]
    fn the_step_response_solves_its_equation() {
        let h = 1e-4;
        for times in [TimeConstants { position_s: 0.03, dual_s: 0.01 }, TimeConstants::with_alpha(1.0)] {
            for t in [0.005, 0.03, 0.1] {
                let q = |k: f64| step_response(times, t + k * h);
                let (first, second) =
                    ((q(1.0) - q(-1.0)) / (2.0 * h), (q(1.0) - 2.0 * q(0.0) + q(-1.0)) / (h * h));
                let TimeConstants { position_s, dual_s } = times;
                let sum = position_s * dual_s * second + (position_s + dual_s) * first + q(0.0);
                assert!(sum.abs() < 1e-4, "{times:?} {t}: {sum}");
            }
            // The ramp response is the integral of the step response.
            let slope = (ramp_response(times, 0.05 + h) - ramp_response(times, 0.05 - h)) / (2.0 * h);
            assert!((slope - step_response(times, 0.05)).abs() < 1e-5);
        }
    }
}
