//! How the residual of the driven stages depends on the position: the resolution of maps, and the periods of harmonics, with
//! which candidates start. No simulation is needed, as an error of the screw moves the table and a friction the force.

use nalgebra::{DMatrix, DVector};

use super::position_spectrum::waves;
use super::residual_samples::{Sample, samples, samples_over, solve};
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::normal_equations::FOLDS;
use crate::fit::scope::{Scope, ShownIn};
use model::axis::Mechanics;
use model::effects::{ResidualOverOther, ResidualShape, Stage, WaveOf};
use model::position_curve::PositionCurve;

/// Numbers of knots that are tried.
const KNOTS: [u32; 8] = [4, 6, 8, 10, 13, 16, 20, 25];

/// A map does not resolve the turns of the screw: its knots are at least this fraction of the lead apart. Errors that repeat
/// with every turn are harmonics.
const MIN_SPACING_OF_LEAD: f64 = 0.6;

/// A finer map must remove at least this fraction more of what the best one removes: 1 % of its rms.
const MIN_REFINEMENT: f64 = 1e-4;

/// Number of intervals of the position in which the residual is averaged for maps. The finest map has ten for each knot.
const BINS: usize = 256;

/// The shape of the residuals of a scope's table and force stage; of its tool stage, where that shows the table.
#[must_use]
pub fn shape(
    data: &FitData<'_>,
    residuals: &[ResidualSeries],
    scope: &Scope,
    mechanics: &Mechanics,
) -> ResidualShape {
    let options = &data.options.search;
    let min_share = options.promising * options.min_reduction;
    let travel_mm = data.travel_mm();
    let count = |&count: &u32| {
        let spacing_mm = (travel_mm[1] - travel_mm[0]) / f64::from(count - 1);
        mechanics.lead_mm.is_none_or(|lead_mm| spacing_mm >= MIN_SPACING_OF_LEAD * lead_mm)
    };
    let counts: Vec<u32> = KNOTS.into_iter().filter(count).collect();
    let table = samples(data, residuals, scope.shown_in.of(Stage::Table));
    let force = samples(data, residuals, Stage::Force);
    let friction: Vec<Sample> = force.iter().map(|sample| sample.as_multiple_of(sample.direction)).collect();
    // Without a declared stiffness, no effect asks for it.
    let stretched = if mechanics.stiffness_n_per_um.is_some() { &table[..] } else { &[] };
    let stretch: Vec<Sample> = stretched
        .iter()
        .map(|sample| sample.as_multiple_of(force_on_table_n(mechanics, sample)))
        .filter(|sample| sample.weight > 0.0)
        .collect();

    let curves = Curves { counts: &counts, travel_mm, min_share };
    let pitch = curves.best(&table, false, None);
    let each_way = curves.best(&table, true, pitch);
    let all = [(WaveOf::Table, &table), (WaveOf::Force, &force), (WaveOf::Friction, &friction)];
    ResidualShape {
        pitch_knots: pitch.map(|fit| fit.count),
        pitch_knots_each_way: each_way.map(|fit| fit.count),
        friction_knots: curves.best(&friction, false, None).map(|fit| fit.count),
        stiffness_knots: curves.best(&stretch, false, None).map(|fit| fit.count),
        tool_over_others: over_others(data, residuals, scope, min_share),
        waves: all.into_iter().flat_map(|(of, samples)| waves(of, samples, travel_mm, min_share)).collect(),
    }
}

/// The force that drives the table at a sample, N, to which the stretch of the spring is proportional; 0 if its mass is not known.
fn force_on_table_n(mechanics: &Mechanics, sample: &Sample) -> f64 {
    let Some(mass_kg) = mechanics.table_mass_kg else { return 0.0 };
    mass_kg * sample.acceleration
        + mechanics.coulomb_n.unwrap_or(0.0) * sample.direction
        + mechanics.viscous_n_s_per_m.unwrap_or(0.0) * sample.velocity
}

/// How the tool residual depends on the positions of the other axes. None if it depends more on that of the axis itself, or a bump over it is
/// subtracted: on a circle, a defect at a place of one axis is one at two places of the other.
fn over_others(
    data: &FitData<'_>,
    residuals: &[ResidualSeries],
    scope: &Scope,
    min_share: f64,
) -> Vec<ResidualOverOther> {
    let has_bump = data.exclusions.iter().any(|exclusion| exclusion.bump(Stage::Tool).is_some());
    if scope.stages != [Stage::Tool] || scope.shown_in != ShownIn::default() || has_bump {
        return Vec::new();
    }
    let curve_over = |axis: usize| {
        let travel_mm = FitData { axis, ..*data }.travel_mm();
        let samples = samples_over(data, residuals, axis);
        let fit = Curves { counts: &KNOTS, travel_mm, min_share }.best(&samples, false, None)?;
        Some((
            fit.removed,
            ResidualOverOther { source: data.names[axis].clone(), travel_mm, knots: fit.count },
        ))
    };
    let others = (0..data.names.len()).filter(|&other| other != data.axis);
    let mut over_others: Vec<(f64, ResidualOverOther)> = others.filter_map(curve_over).collect();
    if !over_others.is_empty() {
        let by_own = curve_over(data.axis).map_or(0.0, |(removed, _)| removed);
        over_others.retain(|(removed, _)| *removed > by_own);
    }
    over_others.into_iter().map(|(_, over)| over).collect()
}

/// Mean residual over an interval of the position, in one direction and one fold.
#[derive(Clone, Copy, Debug)]
struct Bin {
    position_mm: f64,
    direction: f64,
    fold: usize,
    mean: f64,
    /// Sum of the weights.
    weight: f64,
}

/// A number of knots, with the Σr² that is left on data that were not fitted; of the curve that is taken, that which the best
/// number of knots leaves.
#[derive(Clone, Copy, Debug)]
struct CurveFit {
    count: u32,
    left: f64,
    /// Σr² that the best number of knots removes of the mean residuals.
    removed: f64,
}

/// The curves over the position that are compared.
struct Curves<'a> {
    counts: &'a [u32],
    travel_mm: [f64; 2],
    /// Smallest fraction of Σr² that a curve removes.
    min_share: f64,
}

impl Curves<'_> {
    /// The number of knots of the best curve, or of a curve for each direction, by cross-validation; `None` if no curve
    /// removes enough more than the `known` one.
    fn best(&self, samples: &[Sample], differs: bool, known: Option<CurveFit>) -> Option<CurveFit> {
        let bins = self.bins(samples);
        let total: f64 = samples.iter().map(|sample| sample.residual * sample.residual / sample.weight).sum();
        let without = bins.iter().map(|bin| bin.weight * bin.mean * bin.mean).sum::<f64>();
        let known = known.map_or(without, |fit| fit.left);
        let fits: Vec<(u32, f64)> =
            self.counts.iter().map(|&count| (count, self.left(&bins, count, differs))).collect();
        let best = numerics::min(fits.iter().map(|(_, left)| *left));
        let enough = best + MIN_REFINEMENT * (known - best);
        let (count, left) = fits.into_iter().find(|(_, left)| *left <= enough)?;
        let is_enough = known - left > self.min_share * total;
        is_enough.then_some(CurveFit { count, left: best, removed: without - best })
    }

    fn bins(&self, samples: &[Sample]) -> Vec<Bin> {
        let [from, to] = self.travel_mm;
        let width_mm = ((to - from) / BINS as f64).max(1e-9);
        let mut sums = vec![(0.0, 0.0); BINS * 2 * FOLDS];
        for sample in samples {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bin number")]
            let bin = ((sample.position_mm - from) / width_mm).clamp(0.0, (BINS - 1) as f64) as usize;
            let way = usize::from(sample.direction > 0.0);
            let sum = &mut sums[(bin * 2 + way) * FOLDS + sample.fold];
            *sum = (sum.0 + sample.residual, sum.1 + sample.weight);
        }
        let bin = |(index, (sum, weight)): (usize, (f64, f64))| {
            let way = index / FOLDS % 2;
            (weight > 0.0).then(|| Bin {
                position_mm: from + width_mm * ((index / (2 * FOLDS)) as f64 + 0.5),
                direction: if way == 1 { 1.0 } else { -1.0 },
                fold: index % FOLDS,
                mean: sum / weight,
                weight,
            })
        };
        sums.into_iter().enumerate().filter_map(bin).collect()
    }

    /// Σr² of the bins of each fold under the curve that fits the other folds.
    fn left(&self, bins: &[Bin], count: u32, differs: bool) -> f64 {
        let unit = self.unit_curves(count);
        let row = |bin: &Bin| {
            let values = unit.iter().map(|curve| curve.value(bin.position_mm));
            let both: Vec<f64> = values.collect();
            let ways =
                if differs { both.iter().map(|value| value * bin.direction).collect() } else { Vec::new() };
            DVector::from_vec([both, ways].concat())
        };
        let rows: Vec<DVector<f64>> = bins.iter().map(row).collect();
        let size = rows.first().map_or(0, DVector::len);
        let of_fold = |fold: usize| {
            let (mut curvature, mut gradient) = (DMatrix::zeros(size, size), DVector::zeros(size));
            for (row, bin) in rows.iter().zip(bins).filter(|(_, bin)| bin.fold != fold) {
                curvature.syger(bin.weight, row, row, 1.0);
                gradient.axpy(bin.weight * bin.mean, row, 1.0);
            }
            curvature.fill_upper_triangle_with_lower_triangle();
            let solution = solve(curvature, &gradient).unwrap_or_else(|| DVector::zeros(size));
            let held_out = rows.iter().zip(bins).filter(|(_, bin)| bin.fold == fold);
            held_out.map(|(row, bin)| bin.weight * (bin.mean - row.dot(&solution)).powi(2)).sum::<f64>()
        };
        (0..FOLDS).map(of_fold).sum()
    }

    /// For each knot, the curve that is one there and zero at the other knots.
    fn unit_curves(&self, count: u32) -> Vec<PositionCurve> {
        let [from, to] = self.travel_mm;
        let knot = |i: u32| from + (to - from) * f64::from(i) / f64::from(count - 1);
        let positions: Vec<f64> = (0..count).map(knot).collect();
        let unit = |i: u32| (0..count).map(|j| if i == j { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
        (0..count).map(|i| PositionCurve::new(&positions, &unit(i))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::residual_samples::tests::moved;
    use super::*;

    fn best(samples: &[Sample], differs: bool, known: Option<CurveFit>) -> Option<CurveFit> {
        let curves = Curves { counts: &KNOTS, travel_mm: [-75.0, 75.0], min_share: 0.01 };
        curves.best(samples, differs, known)
    }

    /// Three waves over the travel: a spline needs more than three knots per wave to remove nearly all.
    #[test]
    fn the_resolution_follows_from_the_data() {
        let wavy = moved(|x, _| 2.0 * (std::f64::consts::TAU * x / 50.0).sin());
        let fit = best(&wavy, false, None).unwrap();
        assert!((10..=20).contains(&fit.count), "{fit:?}");
        // A parabola is smooth: few knots.
        let bent = moved(|x, _| (x / 50.0).powi(2));
        assert!(best(&bent, false, None).unwrap().count <= 6);
        // Noise has no curve, and equal ways need no second one.
        assert!(best(&moved(|_, _| 0.0), false, None).is_none());
        assert!(best(&wavy, true, Some(fit)).is_none());
    }

    /// A stretch whose factor follows a parabola over the position, under a force that reverses at both ends, is no curve of the residual
    /// itself in both directions, but one of the residual as a multiple of the force.
    #[test]
    fn a_stretch_that_varies_is_a_curve_of_multiples_of_the_force() {
        let mechanics =
            Mechanics { table_mass_kg: Some(100.0), coulomb_n: Some(150.0), ..Mechanics::default() };
        let of_force = |sample: &Sample| {
            let force_n = force_on_table_n(&mechanics, sample);
            Sample {
                residual: 0.01 * force_n * (sample.position_mm / 50.0).powi(2) + sample.residual,
                ..*sample
            }
        };
        let samples: Vec<Sample> = moved(|_, _| 0.0).iter().map(of_force).collect();
        let stretch: Vec<Sample> = samples
            .iter()
            .map(|sample| sample.as_multiple_of(force_on_table_n(&mechanics, sample)))
            .collect();
        assert!((4..=6).contains(&best(&stretch, false, None).unwrap().count));
        // Of an axis whose mass is not known there are no multiples.
        assert!(force_on_table_n(&Mechanics::default(), &samples[0]) == 0.0);
    }

    #[test]
    fn ways_that_differ_need_a_curve_each() {
        let samples = moved(|x, direction| direction * (std::f64::consts::TAU * x / 150.0).sin());
        let both = best(&samples, false, None);
        assert!(both.is_none(), "{both:?}");
        assert!(best(&samples, true, both).unwrap().count <= 9);
    }
}
