//! The closed forms of the appendix in time, (9) to (12), (15) and (16), against the system run in
//! [`super::response`].
//!
//! Lost motion ΔQ, K = 1/T, K' = 1/T' = 1/(αT), no command:
//!
//! ```text
//! (9), (10)   Qo/ΔQ = 1/((1 + Ts)(1 + T's)) − 1
//! (11), (12)  step:  Qo = −ΔQ·(T·e^(−t/T) − T'·e^(−t/T'))/(T − T'),   T = T': −ΔQ·(1 + t/T)·e^(−t/T)
//!             ramp:  Qo = −r·(T²(1 − e^(−t/T)) − T'²(1 − e^(−t/T')))/(T − T')
//! (15)        Qc = −ΔQb·e^(−K't) for a step, −ΔQp/K'·(1 − e^(−K't)) for a ramp
//! (16)        Qc of both at once: their sum
//! ```
//!
//! A tick holds what continuous time lets slide: the shift is late by up to h·ΔQ/T', which bounds every deviation.

use super::response::{Shown, TICK_S, Times, run};
use crate::reproduce::{Outcome, Picture, Printed, Study};
use report::number::fixed;
use report::plot::{Chart, Ink, Layer};

/// T, s: Kp = 33 1/s.
const POSITION_S: f64 = 0.03;

/// T'/T.
pub const ALPHAS: [f64; 3] = [1.0 / 3.0, 1.0, 8.0 / 3.0];

/// Lost motion, nm.
const STEP_NM: f64 = 10_000.0;

/// What fixed point leaves of 10 µm, nm: its gains are h/T' right to 2⁻²⁵ of one, 5e-5 of themselves, and an answer
/// goes with at most 1/e of that; half of its 1/16 nm stands in each of the two integrators.
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

/// Pitch error, nm/s, that in the end is as much as the step: `ΔQp/K' = ΔQb`.
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
            (self.shown_nm)(row) - (self.exact_nm)(times, f64::from(tick) * TICK_S)
        };
        numerics::max_abs((0u32..).zip(&rows).map(off))
    }
}

/// What a tick may add, nm: as much as the shift moves in it.
fn bound_nm(times: Times) -> f64 {
    STEP_NM * TICK_S / times.shift_s + FORMAT_NM
}

/// Of an α.
pub fn times(alpha: f64) -> Times {
    Times { position_s: POSITION_S, shift_s: alpha * POSITION_S }
}

/// Greatest |Qc| of backlash and pitch error at once, nm; the one is [`STEP_NM`], the other `ratio` of it in the end.
fn greatest_of_both_nm(times: Times, ratio: f64) -> f64 {
    let rows = run(times, 2 * TICKS, |time_s| STEP_NM + ratio * ramp_nm_per_s(times) * time_s);
    numerics::max_abs(rows.iter().map(|row| row.second_nm))
}

/// Adds the closed forms.
pub fn add(study: &mut Study) {
    let systems = ALPHAS.map(times);
    let most_nm = numerics::max_abs(systems.map(bound_nm));
    for form in &FORMS {
        let farthest_nm = numerics::max_abs(systems.map(|times| form.farthest_nm(times)));
        study.outcomes.push(Outcome::new(
            format!("{}: farthest from the closed form", form.name),
            Printed::Below(rounded(100.0 * most_nm / STEP_NM, 2)),
            100.0 * farthest_nm / STEP_NM,
            "% of ΔQ",
        ));
    }
    let equal = times(1.0);
    let greatest = |ratio: f64| greatest_of_both_nm(equal, ratio) / STEP_NM;
    let (twice, half) = (greatest(2.0), greatest(0.5));
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
    study.pictures.push(picture_of_steps(systems));
    study.notes.extend([
        "That Qc never exceeds ΔQp or ΔQb, as the paper ends, holds for the greater of the two: by (16) Qc is a mean \
         of ΔQb and ΔQp/K' that goes from the one to the other. It exceeds the lesser, and that verdict differs. ΔQp \
         stands there for ΔQp/K', the same number only at the paper's K' = 1 1/s."
            .to_owned(),
        "The condition printed as T = T' over the partial fractions of (11) is read T ≠ T'; the values of α in the \
         paper's figure of (12) are not in the scan, so 1/3, 1 and 8/3 are taken with T = 0.03 s."
            .to_owned(),
    ]);
}

/// To so many digits behind the point, for a printed bound.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let unit = 10f64.powi(decimals);
    (value * unit).round() / unit
}

/// One line, or a mark.
pub fn line(ink: Ink, points: Vec<(f64, f64)>, is_marked: bool) -> Layer {
    Layer { ink, points, is_marked }
}

/// Of the three α.
pub const INKS: [Ink; 3] = [Ink::Before, Ink::Third, Ink::Fourth];

/// What they stand for.
pub fn keys(systems: [Times; 3], marks: &str) -> Vec<(&'static str, String)> {
    let name = |times: Times| format!("T' = {} s", fixed(times.shift_s, 2));
    let [a, b, c] = systems.map(name);
    vec![("before", a), ("cw", b), ("ccw", c), ("after mark", marks.to_owned())]
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
    let caption =
        "How the table comes back after the lost motion has jumped by ΔQ, T = 0.03 s: closed forms (11), \
                   (12), and the controller's dual feedback in fixed point behind an ideal motor."
            .to_owned();
    let chart = Chart {
        size: (960, 260),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Each within what its own tick explains; the table's step does show the tick.
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
}
