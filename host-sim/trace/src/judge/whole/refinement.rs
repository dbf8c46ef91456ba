//! The step of the parameters to the fit to whole logs, and the results that are replaced by those of whole logs.

use super::WholeLogs;
use super::normal_sums::{NormalSums, normal_sums};
use super::residual_sums::{PieceSquares, residual_sums, rms};
use crate::analysis::residual_analysis::UnexplainedResidual;
use crate::analysis::variable::Variable;
use crate::fit::axis_model::AxisModel;
use crate::fit::normal_equations::{Block, normal, stepped};
use crate::judge::axis_findings::{AxisFindings, StageResidual};
use crate::judge::declared_value::DeclaredValue;
use crate::judge::findings::Findings;
use crate::judge::found_effect::FoundEffect;
use crate::repair::repaired::Repaired;
use crate::stages::{residual_unit, stage_names};
use crate::task::{Job, Task};
use model::axis::Tolerated;
use model::effects::Stage;

/// Damping of the step: the fit to the stretches is near.
const DAMPING: f64 = 1e-6;

/// A piece is reported if its residual exceeds the median of all pieces by this factor, and the largest residual of a model
/// that describes its log.
const MIN_RATIO: f64 = 3.0;

/// The findings with the values and residuals of all samples. Short logs were searched in all of theirs: their findings stay.
#[must_use]
pub fn with_all_samples(job: &Job<'_>, repaired: &Repaired<'_>, findings: Findings) -> Findings {
    let parts = repaired.parts();
    if !parts.are_long {
        return findings;
    }
    let whole = WholeLogs { repaired, parts };
    let Findings { axes: searched, mut notes } = findings;
    let models: Vec<AxisModel> = searched.iter().map(|axis| axis.model.clone()).collect();
    let fitted = fitted(job, &whole, searched);
    (job.progress)("computing the residuals of the whole logs");
    let max_ratio = job.options.analysis.max_noise_ratio;
    let [fit, held_out] = [0, 1].map(|set| residual_sums(&whole, &fitted, set));
    let mut axes = Vec::with_capacity(fitted.len());
    for (index, (axis, searched)) in fitted.into_iter().zip(&models).enumerate() {
        let axis = with_residuals(with_values(axis, searched), index, [&fit, &held_out], max_ratio);
        notes.extend(worst_pieces(&axis, index, [&fit, &held_out], max_ratio));
        axes.push(axis);
    }
    Findings { axes, notes }
}

/// The axes with their models after a step in each scope.
fn fitted(job: &Job<'_>, whole: &WholeLogs<'_>, searched: Vec<AxisFindings>) -> Vec<AxisFindings> {
    let rounds = searched.iter().map(|axis| axis.fitted_scopes.len()).max().unwrap_or(0);
    (0..rounds).fold(searched, |axes, number| {
        (job.progress)(&format!("fitting the whole logs, {} of {rounds}", number + 1));
        let sums = normal_sums(whole, &axes, number);
        let step = |(axis, sums): (AxisFindings, Option<NormalSums>)| match sums {
            Some(sums) => after_step(axis, number, sums),
            None => axis,
        };
        axes.into_iter().zip(sums).map(step).collect()
    })
}

/// The axis after one step of the parameters of a scope, unless it would move a parameter of an effect to a limit of its range.
fn after_step(axis: AxisFindings, number: usize, sums: NormalSums) -> AxisFindings {
    let scope = &axis.fitted_scopes[number].scope;
    let parameters = axis.model.free_parameters(scope);
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
    let mut moved = axis.model.at(scope, &stepped(&parameters, &curvature, &gradient, DAMPING));
    if moved.first_at_limit().is_some() {
        return axis;
    }
    moved.update_mass_constraint(scope);
    AxisFindings { model: moved, ..axis }
}

/// The axis with the reported values of its model, which were those of the model of the search.
fn with_values(axis: AxisFindings, searched: &AxisModel) -> AxisFindings {
    let model = axis.model;
    let effect_of = |found: FoundEffect| {
        let index = searched.found().iter().position(|effect| *effect == found.effect);
        let effect = index.and_then(|index| model.found().get(index)).cloned();
        FoundEffect { effect: effect.unwrap_or_else(|| found.effect.clone()), ..found }
    };
    let value_of = |value: DeclaredValue| {
        let fitted = Tolerated::with_key(value.key).and_then(|key| (key.get)(&model.axis.settings));
        DeclaredValue { fitted: fitted.unwrap_or(value.fitted), ..value }
    };
    let has_nothing_new = model.found().is_empty() && axis.task == Task::Search;
    AxisFindings {
        found: axis.found.into_iter().map(effect_of).collect(),
        declared_values: axis.declared_values.into_iter().map(value_of).collect(),
        baseline: if has_nothing_new { model.clone() } else { axis.baseline },
        model,
        ..axis
    }
}

/// The axis with the residuals of the fitted and of the held-out parts of whole logs.
fn with_residuals(
    axis: AxisFindings,
    index: usize,
    [fit, held_out]: [&[PieceSquares]; 2],
    max_ratio: f64,
) -> AxisFindings {
    let whole = |mut error: StageResidual| {
        let has_no_exclusion = error.beside_exclusions == error.after;
        if let Some([before, after]) = rms(fit, index, error.stage) {
            (error.before.fit, error.after.fit) = (before, after);
        }
        if let Some([before, after]) = rms(held_out, index, error.stage) {
            (error.before.validate, error.after.validate) = (before, after);
        }
        let beside_exclusions = if has_no_exclusion { error.after } else { error.beside_exclusions };
        StageResidual { beside_exclusions, ..error }
    };
    let residuals: Vec<StageResidual> = axis.residuals.into_iter().map(whole).collect();
    let unexplained = residuals
        .iter()
        .fold(axis.unexplained, |unexplained, error| left(&axis.axis, error, unexplained, max_ratio));
    AxisFindings { residuals, unexplained, ..axis }
}

/// What is unexplained, with the residual of a stage over whole logs.
fn left(
    axis: &str,
    error: &StageResidual,
    mut unexplained: Vec<UnexplainedResidual>,
    max_ratio: f64,
) -> Vec<UnexplainedResidual> {
    if error.after.fit < max_ratio * error.noise {
        unexplained.retain(|found| found.stage != error.stage);
    } else if !unexplained.iter().any(|found| found.stage == error.stage) {
        unexplained.push(UnexplainedResidual {
            stage: error.stage,
            axis: axis.to_owned(),
            rms: error.after.fit,
            share_percent: 0.0,
            variable: Variable::None,
            frequency_hz: None,
            centre_mm: None,
        });
    }
    for found in unexplained.iter_mut().filter(|found| found.stage == error.stage) {
        found.rms = error.after.fit;
    }
    unexplained
}

/// A sentence for each stage with a piece whose residual is far above those of the others.
fn worst_pieces(
    axis: &AxisFindings,
    index: usize,
    sets: [&[PieceSquares]; 2],
    max_ratio: f64,
) -> Vec<String> {
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
