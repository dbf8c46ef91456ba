//! The waves of the cogging from the forces and the deviations of pairs of passes.

use std::f64::consts::TAU;

use nalgebra::Complex;
use numerics::averages::mean;

use super::fit::{Design, Fitted, Wave};
use super::passes::{Curve, Pair};
use super::plan::Plan;

/// The fit of the force of pairs of passes.
pub struct Forces<'a> {
    plan: &'a Plan,
    /// The least squares over the positions.
    pub design: Design<'a>,
    mass_kg: f64,
}

impl<'a> Forces<'a> {
    /// For an axis with a mass, kg.
    #[must_use]
    pub fn new(plan: &'a Plan, mass_kg: f64) -> Self {
        Self { plan, design: Design::new(&plan.grid, &plan.candidates), mass_kg }
    }

    /// The fit of the mean force of both directions over pairs, and the waves of the cogging (the equations are those of the
    /// [module](super)).
    #[must_use]
    pub fn of(&self, pairs: &[&Pair]) -> (Fitted, Vec<Wave>) {
        let [both, difference] = self.halves(pairs, |curve| &curve.force_n);
        let deviation = self.halves(pairs, |curve| &curve.deviation_m);
        let waves = self.plan.candidates.iter().enumerate().map(|(index, candidate)| {
            let rad_per_s = TAU * self.plan.speed_mm_per_s / candidate.period_mm;
            let inertia_n_per_m = self.mass_kg * rad_per_s * rad_per_s;
            let force = [both.waves[index], difference.waves[index]];
            let deviation = [deviation[0].waves[index], deviation[1].waves[index]];
            // The wave of a derivative has a quarter of a turn more.
            let speed = deviation.map(|wave| wave * Complex::new(0.0, rad_per_s));
            ([0, 1].map(|half| force[half] + deviation[half] * inertia_n_per_m), speed)
        });
        let waves: Vec<([Wave; 2], [Wave; 2])> = waves.collect();
        let along = |(force, speed): &([Wave; 2], [Wave; 2])| (speed[0].conj() * force[1]).re;
        let squares: f64 = waves.iter().map(|(_, speed)| speed[0].norm_sqr()).sum();
        let slope_n_s_per_m =
            if squares > 0.0 { waves.iter().map(along).sum::<f64>() / squares } else { 0.0 };
        let cogging = waves.iter().map(|(force, speed)| speed[1] * slope_n_s_per_m - force[0]).collect();
        (both, cogging)
    }

    /// The fits of half of the sum and half of the difference of a channel in both directions.
    fn halves(&self, pairs: &[&Pair], of: impl Fn(&Curve) -> &Vec<f64>) -> [Fitted; 2] {
        [1.0, -1.0].map(|sign| {
            self.design.fit(&averaged(pairs, |pair, point| {
                0.5 * (of(&pair.forward)[point] + sign * of(&pair.backward)[point])
            }))
        })
    }

    /// Variance of sine and cosine of the mean waves by their scatter from pair to pair, the same for all waves, and its degrees of freedom.
    #[must_use]
    pub fn variance_between(&self, pairs: &[&Pair]) -> (f64, usize) {
        let of_pairs: Vec<Vec<Wave>> = pairs.iter().map(|pair| self.of(&[*pair]).1).collect();
        let (count, waves) = (pairs.len() as f64, self.plan.candidates.len());
        let squares = (0..waves).map(|index| {
            let middle = of_pairs.iter().map(|waves| waves[index]).sum::<Wave>() / count;
            of_pairs.iter().map(|waves| (waves[index] - middle).norm_sqr()).sum::<f64>()
        });
        let freedom = 2 * waves * pairs.len().saturating_sub(1);
        (squares.sum::<f64>() / freedom.max(1) as f64 / count, freedom)
    }
}

/// Mean over pairs at each position.
fn averaged(pairs: &[&Pair], of: impl Fn(&Pair, usize) -> f64) -> Vec<f64> {
    let points = pairs.first().map_or(0, |pair| pair.forward.force_n.len());
    (0..points).map(|point| mean(pairs.iter().map(|pair| of(pair, point)))).collect()
}
