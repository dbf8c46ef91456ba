//! The effects of the catalogue that a law resembles: how much of its values over the fitted logs each of them could describe.
//!
//! An effect takes one step of the linear screening of a search, towards the law in place of the residual. What the effect then adds to the stage is
//! compared with the law sample by sample. A resemblance is no cause: held-out logs supported the law and not the effect.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::analysis::law::samples::{Normal, Samples};
use crate::analysis::law::{FoundLaw, Resemblance};
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::least_squares::derivatives;
use crate::fit::normal_equations::{Column, DerivativeSeries, stepped};
use crate::fit::scope::Scope;
use crate::search::missing_effects::missing_effects;
use model::effects::Effect;

/// Largest number of effects that are stated.
const MOST: usize = 3;

/// Damping of the step, as in the screening of candidates.
const DAMPING: f64 = 1e-4;

/// A law with what an effect is compared with.
struct Compared<'a> {
    data: &'a FitData<'a>,
    model: &'a AxisModel,
    /// The stage of the law alone.
    scope: Scope,
    /// The values of the law.
    law: Vec<ResidualSeries>,
    /// The residuals of the model without the effect.
    without: Vec<ResidualSeries>,
}

/// Sets the effects that laws of an axis resemble, of those that the model does not have.
pub fn compare_with_catalogue(
    data: &FitData<'_>,
    (model, scopes): (&AxisModel, &[Scope]),
    laws: &mut [FoundLaw],
) {
    for law in laws {
        if let Some(scope) = scopes.iter().find(|scope| scope.stages.contains(&law.stage)) {
            law.resembles = resemblances(data, (model, scope), law);
        }
    }
}

/// The effects that could describe at least half of a law, best first; if there are none, the best one.
fn resemblances(
    data: &FitData<'_>,
    (model, scope): (&AxisModel, &Scope),
    law: &FoundLaw,
) -> Vec<Resemblance> {
    let scope = Scope { stages: vec![law.stage], ..scope.clone() };
    let residual_law = law.residual_law();
    let of_log = |log| ResidualSeries { stage: law.stage, log, values: data.law_values(&residual_law, log) };
    let values: Vec<ResidualSeries> = (0..data.logs.len()).map(of_log).collect();
    let without = data.residuals(model, &scope);
    let guesses = missing_effects(data, (model, &values), &scope);
    let compared = Compared { data, model, scope, law: values, without };
    let shares = guesses.into_par_iter().filter(|effect| compared.scope.holds(effect));
    let shares = shares.map(|effect| Resemblance { effect: effect.name(), share: compared.share(effect) });
    best(shares.collect())
}

/// The best of each effect: those with at least half, at most [`MOST`], otherwise the best one.
fn best(mut all: Vec<Resemblance>) -> Vec<Resemblance> {
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    let mut kept: Vec<Resemblance> = Vec::new();
    for one in all.into_iter().filter(|one| one.share > 0.0) {
        let is_known = kept.iter().any(|known| known.effect == one.effect);
        let is_stated = kept.is_empty() || one.share >= Resemblance::MIN_SHARE && kept.len() < MOST;
        if !is_known && is_stated {
            kept.push(one);
        }
    }
    kept
}

impl Compared<'_> {
    /// The part of the law's variance that an effect could describe, at its initial guess or after one step.
    fn share(&self, effect: Effect) -> f64 {
        let Self { data, scope, without, .. } = self;
        let with = self.model.with(effect);
        let at_guess = data.residuals(&with, scope);
        let after_step = self.after_step(&with, &at_guess);
        let of = |residuals: &[ResidualSeries]| {
            let added = without.iter().zip(residuals).map(|(a, b)| DerivativeSeries::of(b, a, 1.0));
            self.described_by(&Arc::new(added.collect()))
        };
        of(&at_guess).max(of(&after_step))
    }

    /// The residuals after one step of the parameters of the last effect of a model towards the law.
    fn after_step(&self, with: &AxisModel, at_guess: &[ResidualSeries]) -> Vec<ResidualSeries> {
        let Self { data, scope, law, without, .. } = self;
        let parameters = with.free_parameters(scope);
        let indices: Vec<usize> = with.indices_of_last(scope).collect();
        let columns = derivatives(data, with, scope, &indices, at_guess);
        let differences = at_guess.iter().zip(without).map(|(with, without)| {
            let values = with.values.iter().zip(&without.values);
            (with.log, values.map(|(with, without)| with - without).collect::<Vec<f64>>())
        });
        let left = |(log, differences): (usize, Vec<f64>)| {
            let law = &law[log];
            let values = law.values.iter().zip(differences).map(|(law, added)| law + added).collect();
            ResidualSeries { values, ..law.clone() }
        };
        let left: Vec<ResidualSeries> = differences.map(left).collect();
        let Some((curvature, gradient, _)) = self.centred(&left, &columns) else { return at_guess.to_vec() };
        let of_effect: Vec<_> = indices.iter().map(|&index| parameters[index]).collect();
        let moved = stepped(&of_effect, &curvature, &gradient, DAMPING);
        let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.coordinate.value).collect();
        for (&index, value) in indices.iter().zip(moved) {
            values[index] = value;
        }
        data.residuals(&with.at(scope, &values), scope)
    }

    /// The part of the law's variance that a multiple of what an effect adds describes; zero if it has the other sign.
    fn described_by(&self, added: &Column) -> f64 {
        let all = self.centred(&self.law, std::slice::from_ref(added));
        all.map_or(0.0, |(curvature, gradient, squares)| {
            let (product, of_effect) = (gradient[0], curvature[(0, 0)]);
            let share = product * product / (of_effect * squares);
            if product > 0.0 && share.is_finite() { share.min(1.0) } else { 0.0 }
        })
    }

    /// `JᵀJ`, `Jᵀr` and Σr² of series and columns without their means, over the samples of a law.
    fn centred(
        &self,
        series: &[ResidualSeries],
        columns: &[Column],
    ) -> Option<(DMatrix<f64>, DVector<f64>, f64)> {
        let samples = Samples::of(self.data, (series, columns), self.scope.stages[0], &[]);
        let Normal { samples, squares, gradient, curvature, .. } = Normal::sum(samples.normal(&[]).iter())?;
        let (n, count) = (columns.len(), samples as f64);
        let mean = |i: usize| curvature[(i + 1, 0)] / count;
        let of_columns =
            DMatrix::from_fn(n, n, |i, j| curvature[(i + 1, j + 1)] - mean(i) * curvature[(0, j + 1)]);
        let products = DVector::from_fn(n, |i, _| gradient[i + 1] - mean(i) * gradient[0]);
        Some((of_columns, products, squares - gradient[0] * gradient[0] / count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_with_half_are_stated_once_or_else_the_best_one() {
        let of = |all: &[(&'static str, f64)]| {
            let all = all.iter().map(|&(effect, share)| Resemblance { effect, share }).collect();
            best(all).into_iter().map(|one| one.effect).collect::<Vec<_>>()
        };
        assert_eq!(of(&[("a", 0.4), ("b", 0.6), ("a", 0.9), ("b", 0.7), ("c", 0.3)]), ["a", "b"]);
        assert_eq!(of(&[("a", 0.1), ("b", 0.3), ("c", 0.0)]), ["b"]);
        assert_eq!(of(&[("a", 0.9), ("b", 0.8), ("c", 0.7), ("d", 0.6)]), ["a", "b", "c"]);
        assert!(of(&[("a", 0.0)]).is_empty());
    }
}
