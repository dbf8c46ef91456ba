//! The step of the parameters to the fit to whole logs, and the results that are replaced by those of whole logs.

use super::WholeLogs;
use super::normal_sums::{NormalSums, normal_sums};
use super::residual_sums::{PieceSquares, residual_sums, rms};
use crate::analysis::residual_analysis::UnexplainedResidual;
use crate::analysis::variable::Variable;
use crate::fit::axis_model::AxisModel;
use crate::fit::normal_equations::{Block, normal, stepped};
use crate::fit::scope_fit::Progress;
use crate::outcome::{AxisTrace, StageResidual, Trace};
use crate::stages::{residual_unit, stage_names};
use crate::task::Task;
use model::axis::Tolerated;
use model::effects::Stage;

/// Damping of the step: the fit to the stretches is near.
const DAMPING: f64 = 1e-6;

/// A piece is reported if its residual exceeds the median of all pieces by this factor, and the largest residual of a model
/// that describes its log.
const MIN_RATIO: f64 = 3.0;

/// Fits the models of all axes to the whole logs, and computes their residuals.
pub fn refine(trace: &mut Trace, whole: &WholeLogs<'_>, progress: &Progress<'_>) {
    let start: Vec<AxisModel> = trace.axes.iter().map(|axis| axis.model.clone()).collect();
    let rounds = trace.axes.iter().map(|axis| axis.fitted_scopes.len()).max().unwrap_or(0);
    for number in 0..rounds {
        progress(&format!("fitting the whole logs, {} of {rounds}", number + 1));
        let sums = normal_sums(whole, trace, number);
        for (axis, sums) in trace.axes.iter_mut().zip(sums) {
            if let Some(sums) = sums {
                axis.take_step(number, sums);
            }
        }
    }
    progress("computing the residuals of the whole logs");
    let max_ratio = trace.options.analysis.max_noise_ratio;
    let squares = residual_sums(whole, trace, 0);
    let held_out = residual_sums(whole, trace, 1);
    let axes = 0..trace.axes.len();
    for (index, start) in axes.zip(&start) {
        let axis = &mut trace.axes[index];
        axis.replace_values(start);
        axis.replace_residuals(index, [&squares, &held_out], max_ratio);
        trace.notes.extend(worst_pieces(&trace.axes[index], index, [&squares, &held_out], max_ratio));
    }
}

impl AxisTrace {
    /// Whether a fit to whole logs may change the model: not if the machine file is that of another machine, or if an earlier
    /// trace wrote it and nothing new was found.
    #[must_use]
    pub fn may_be_refined(&self) -> bool {
        let has_nothing_new = self.model.found().is_empty() && self.model.was_fitted();
        !(self.is_of_another_machine || has_nothing_new)
    }

    /// One step of the parameters of a scope, unless it would move a parameter of an effect to a limit of its range.
    fn take_step(&mut self, number: usize, sums: NormalSums) {
        let scope = &self.fitted_scopes[number].scope;
        let parameters = self.model.free_parameters(scope);
        let block = Block {
            stage: scope.stages[0],
            log: 0,
            number: 0,
            fold: 0,
            weight: 1.0,
            samples: 0,
            squares: sums.squares,
            gradient: sums.gradient,
            curvature: sums.curvature,
        };
        let (curvature, gradient) = normal([&block], &parameters);
        let mut moved = self.model.at(scope, &stepped(&parameters, &curvature, &gradient, DAMPING));
        if moved.first_at_limit().is_none() {
            moved.update_mass_constraint(scope);
            self.model = moved;
        }
    }

    /// Replaces the reported values of the parameters, which were those of `start`.
    fn replace_values(&mut self, start: &AxisModel) {
        for found in &mut self.found {
            let index = start.found().iter().position(|effect| *effect == found.effect);
            if let Some(effect) = index.and_then(|index| self.model.found().get(index)) {
                found.effect = effect.clone();
            }
        }
        for value in &mut self.declared_values {
            let key = Tolerated::with_key(value.key);
            if let Some(fitted) = key.and_then(|key| (key.get)(&self.model.axis.settings)) {
                value.fitted = fitted;
            }
        }
        if self.model.found().is_empty() && self.task == Task::Search {
            self.baseline = self.model.clone();
        }
    }

    /// Replaces the residuals by those of the fitted and of the held-out parts of whole logs.
    fn replace_residuals(&mut self, index: usize, [fit, held_out]: [&[PieceSquares]; 2], max_ratio: f64) {
        for error in &mut self.residuals {
            let has_no_exclusion = error.beside_exclusions == error.after;
            if let Some([before, after]) = rms(fit, index, error.stage) {
                (error.before.fit, error.after.fit) = (before, after);
            }
            if let Some([before, after]) = rms(held_out, index, error.stage) {
                (error.before.validate, error.after.validate) = (before, after);
            }
            if has_no_exclusion {
                error.beside_exclusions = error.after;
            }
        }
        let is_same = |stage: Stage| move |found: &UnexplainedResidual| found.stage == stage;
        for error in &self.residuals {
            let is_known = self.unexplained.iter().any(is_same(error.stage));
            if error.after.fit < max_ratio * error.noise {
                self.unexplained.retain(|found| !is_same(error.stage)(found));
            } else if !is_known {
                self.unexplained.push(UnexplainedResidual {
                    stage: error.stage,
                    axis: self.axis.clone(),
                    rms: error.after.fit,
                    share_percent: 0.0,
                    variable: Variable::None,
                    frequency_hz: None,
                    centre_mm: None,
                });
            }
            for found in self.unexplained.iter_mut().filter(|found| is_same(error.stage)(found)) {
                found.rms = error.after.fit;
            }
        }
    }
}

/// A sentence for each stage with a piece whose residual is far above those of the others.
fn worst_pieces(axis: &AxisTrace, index: usize, sets: [&[PieceSquares]; 2], max_ratio: f64) -> Vec<String> {
    let of_stage = |stage: Stage| {
        let pieces = sets.iter().flat_map(|set| set.iter());
        let residual =
            |piece: &PieceSquares| rms(std::slice::from_ref(piece), index, stage).map(|[_, rms]| rms);
        let all: Vec<(&PieceSquares, f64)> =
            pieces.filter_map(|piece| Some((piece, residual(piece)?))).collect();
        let values: Vec<f64> = all.iter().map(|(_, rms)| *rms).collect();
        let median = numerics::median(&values)?;
        let (piece, largest) = all.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((piece, largest, median))
    };
    let sentence = |error: &StageResidual| {
        let (piece, largest, median) = of_stage(error.stage)?;
        let is_outstanding = largest > MIN_RATIO * median && largest > MIN_RATIO * max_ratio * error.noise;
        is_outstanding.then(|| {
            let [from_s, to_s] = piece.from_to_s;
            let (unit, _) = residual_unit(axis.unit, error.stage);
            format!(
                "{}: from {from_s:.0} to {to_s:.0} s the residual of {} in the {} stage is {largest:.3} {unit} rms; its \
                 median over all such stretches is {median:.3} {unit}.",
                piece.log,
                axis.axis,
                stage_names(&[error.stage])
            )
        })
    };
    axis.residuals.iter().filter_map(sentence).collect()
}
