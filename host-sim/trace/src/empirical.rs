//! What no effect explains as a table over the variable that it follows best, judged like an effect.
//!
//! A table says what, not why: it holds for motions like those it was taken from. It is taken where it lowers the
//! residual in every third of the logs, with the table of the other two.

use serde::Serialize;

use super::axis::Pair;
use super::candidates::LEAST_REDUCTION;
use super::held_out::FOLDS;
use super::residual::{Evidence, Part};
use super::unexplained::{Variable, values};
use model::effects::Stage;

/// Points of a table.
const POINTS: usize = 32;

/// A point that stands for fewer samples is not known.
const LEAST_SAMPLES: usize = 8;

/// A remainder over a variable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Empirical {
    /// Stage.
    pub channel: Stage,
    /// Axis.
    pub axis: String,
    /// What the table is over: mm, m/s, m/s², N, or −1 to 1 for the direction.
    pub variable: Variable,
    /// Variable and residual (µm or N), in the order of the variable; straight between.
    pub table: Vec<[f64; 2]>,
    /// Rms without it, µm or N.
    pub before: Pair,
    /// Rms with it; the fit logs with the table of their other parts.
    pub after: Pair,
}

/// One sample of a remainder.
#[derive(Clone, Copy)]
struct Sample {
    variable: f64,
    residual: f64,
    fold: usize,
}

/// The table of a stage's remainder, if held-out data support it.
#[must_use]
pub fn empirical(
    [fit, validate]: [&Evidence<'_>; 2],
    [fit_parts, validate_parts]: [&[Part]; 2],
    stage: Stage,
    variable: Variable,
    axis: &str,
) -> Option<Empirical> {
    let seen = samples(fit, fit_parts, stage, variable)?;
    let unseen = samples(validate, validate_parts, stage, variable)?;
    let of_fold = |fold: usize| {
        let table = table(seen.iter().filter(|sample| sample.fold != fold));
        let own = || seen.iter().filter(move |sample| sample.fold == fold);
        [squares(own(), &[]), squares(own(), &table)]
    };
    let folds: Vec<[f64; 2]> = (0..FOLDS).map(of_fold).collect();
    let [before, after] = [0, 1].map(|which| folds.iter().map(|fold| fold[which]).sum::<f64>());
    let is_better = folds.iter().all(|[before, after]| after < before);
    if !is_better || after > (1.0 - LEAST_REDUCTION) * before {
        return None;
    }
    let table = table(seen.iter());
    let rms = |squares: f64, of: &[Sample]| (squares / of.len().max(1) as f64).sqrt();
    let [unseen_before, unseen_after] = [&[][..], &table].map(|table| squares(unseen.iter(), table));
    Some(Empirical {
        channel: stage,
        axis: axis.to_owned(),
        variable,
        before: Pair { fit: rms(before, &seen), validate: rms(unseen_before, &unseen) },
        after: Pair { fit: rms(after, &seen), validate: rms(unseen_after, &unseen) },
        table,
    })
}

/// All samples of a stage that count; `None` if the variable was not measured.
fn samples(evidence: &Evidence<'_>, parts: &[Part], stage: Stage, variable: Variable) -> Option<Vec<Sample>> {
    let mut all = Vec::new();
    for part in parts.iter().filter(|part| part.stage == stage) {
        let n = part.values.len().max(1);
        let of = values(evidence, part.log, variable)?;
        let counts = evidence.counting(stage, part.log);
        let counted = (0..part.values.len()).filter(|&i| counts(i));
        all.extend(counted.map(|i| Sample {
            variable: of[i],
            residual: part.values[i],
            fold: i * FOLDS / n,
        }));
    }
    (!all.is_empty()).then_some(all)
}

/// Mean residual at evenly spread points, each sample shared by the two around it.
fn table<'a>(samples: impl Iterator<Item = &'a Sample> + Clone) -> Vec<[f64; 2]> {
    let [least, most] = numerics::min_max(samples.clone().map(|s| s.variable));
    let width = (most - least) / (POINTS - 1) as f64;
    if !width.is_finite() || width <= 0.0 {
        return Vec::new();
    }
    let mut sums = [[0.0; 2]; POINTS];
    for sample in samples {
        let at = (sample.variable - least) / width;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to POINTS")]
        let point = (at as usize).min(POINTS - 2);
        let share = at - point as f64;
        for (point, weight) in [(point, 1.0 - share), (point + 1, share)] {
            sums[point][0] += weight;
            sums[point][1] += weight * sample.residual;
        }
    }
    let known = sums.iter().enumerate().filter(|(_, [weight, _])| *weight >= LEAST_SAMPLES as f64);
    known.map(|(i, [weight, sum])| [least + i as f64 * width, sum / weight]).collect()
}

/// Σ (residual − table)².
fn squares<'a>(samples: impl Iterator<Item = &'a Sample>, table: &[[f64; 2]]) -> f64 {
    samples.map(|sample| (sample.residual - at(table, sample.variable)).powi(2)).sum()
}

/// The table at a value: straight between its points, level beyond them.
fn at(table: &[[f64; 2]], value: f64) -> f64 {
    let above = table.partition_point(|[x, _]| *x < value);
    match (above.checked_sub(1).map(|i| table[i]), table.get(above).copied()) {
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (value - x0) / (x1 - x0),
        (Some([_, y]), None) | (None, Some([_, y])) => y,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(i: u32, residual: impl Fn(f64) -> f64) -> Sample {
        // Over ±50 mm seven times, three folds one behind the other.
        let mm = 50.0 * (f64::from(i) * 0.044).sin();
        Sample { variable: mm, residual: residual(mm), fold: (i / 334) as usize }
    }

    #[test]
    fn a_table_stands_for_a_smooth_curve() {
        let curve = |mm: f64| 2.0 * (-(mm / 15.0).powi(2)).exp();
        let seen: Vec<Sample> = (0..1000).map(|i| sample(i, curve)).collect();
        let table = table(seen.iter());
        // Points 3.2 mm apart: curvature 2·2/15² times 3.2²/8 is 0.023 at the top, and means smooth as much again.
        for mm in [-40.0, -10.0, 0.0, 3.0, 25.0] {
            assert!((at(&table, mm) - curve(mm)).abs() < 0.06, "{mm}: {} {}", at(&table, mm), curve(mm));
        }
        let left = squares(seen.iter(), &table) / squares(seen.iter(), &[]);
        assert!((1e-6..1e-2).contains(&left), "{left}");
    }

    #[test]
    fn beyond_its_ends_a_table_stays_level() {
        let table = [[0.0, 1.0], [10.0, 3.0]];
        assert!(
            [(-5.0, 1.0), (5.0, 2.0), (25.0, 3.0)].iter().all(|(x, y)| (at(&table, *x) - y).abs() < 1e-12)
        );
    }
}
