//! Cross-validation: error of a fit on data that were not used in it.
//!
//! Each log is divided into [`FOLDS`] parts. For each fold, the fit is repeated without it. Near the optimum, this is one
//! Gauss–Newton step on the normal equations of the other blocks and requires no simulation.

use nalgebra::DVector;

use crate::fit::least_squares::Fitted;
use crate::fit::normal_equations::{FOLDS, normal, stepped};
use crate::fit::scope::Scope;
use crate::options::SearchOptions;
use model::effects::Stage;

/// Share of the samples of a filtered residual whose noise is independent: Σw² of the cubic filter over 11 samples.
const INDEPENDENT: f64 = 0.2;

/// Σr² of one block of one stage, unweighted (µm² or N²), for the fit without the fold of this block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Stage.
    pub stage: Stage,
    /// Index of the log.
    pub log: usize,
    /// Fold.
    pub fold: usize,
    /// Σr².
    pub squares: f64,
    /// Σr² of the fit with this fold.
    pub fitted_squares: f64,
    /// Number of samples that count.
    pub samples: usize,
}

/// Scores of all blocks of a fit, in the order of [`Fitted::blocks`].
#[must_use]
pub fn scores(fitted: &Fitted) -> Vec<Score> {
    let values = DVector::from_iterator(
        fitted.parameters.len(),
        fitted.parameters.iter().map(|parameter| parameter.coordinate.value),
    );
    let steps: Vec<DVector<f64>> = (0..FOLDS)
        .map(|fold| {
            let others = fitted.blocks.iter().filter(|block| block.fold != fold);
            let (curvature, gradient) = normal(others, &fitted.parameters);
            DVector::from_vec(stepped(&fitted.parameters, &curvature, &gradient, 1e-6)) - &values
        })
        .collect();
    fitted
        .blocks
        .iter()
        .map(|block| {
            let step = &steps[block.fold];
            let squares =
                block.squares + 2.0 * block.gradient.dot(step) + step.dot(&(&block.curvature * step));
            Score {
                stage: block.stage,
                log: block.log,
                fold: block.fold,
                squares: squares.max(0.0) / (block.weight * block.weight),
                fitted_squares: block.squares / (block.weight * block.weight),
                samples: block.samples,
            }
        })
        .collect()
}

/// Comparison of two models on held-out data of one stage. Each log is weighted by its length and normalized by its error
/// under the first model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Stage.
    pub stage: Stage,
    /// Fraction of Σr² that the second model removes; negative if Σr² increases.
    pub reduction: f64,
    /// Fraction of Σr² of the fitted data that the second model removes. If the fit without a fold determines its parameters poorly, its error on this fold is
    /// far above the noise, and any change of the model reduces it. The fit with all folds then shows no such reduction.
    pub fitted_reduction: f64,
    /// Mean gain in log-likelihood over the blocks, each with its own noise, divided by its standard error.
    ///
    /// Logarithms are used because an effect may change a few blocks a hundred times as much as the others, which would make
    /// the mean of Σr² uncertain.
    pub t: f64,
    /// Smallest [`Self::t`] that is significant with this number of blocks.
    pub min_t: f64,
    /// Gain in log-likelihood of all samples together, each filtered one of [`INDEPENDENT`] counted.
    pub evidence: f64,
    /// Folds in which the second model is better.
    pub folds_better: usize,
    /// Smallest reduction of any log.
    pub worst_log: f64,
    /// Smallest reduction of any log of the fitted data.
    pub worst_fitted_log: f64,
    /// Gain in log-likelihood per sample, each log with its own noise: ½·ln(Σr² of the first / Σr² of the second), averaged
    /// over the logs with their numbers of samples as weights.
    pub gain: f64,
}

/// Compares models by their scores, stage by stage.
#[must_use]
pub fn compare(
    first: &[Score],
    second: &[Score],
    stages: &[Stage],
    options: &SearchOptions,
) -> Vec<Comparison> {
    stages.iter().map(|&stage| compare_stage(first, second, stage, options)).collect()
}

/// Whether with the second of two fits a stage gains significantly on held-out data and none loses significantly. What has fewer parameters may gain
/// less than an effect has to: a wave of the resolver with a period of its own, near that of the screw, left 2.7 % more than one of the screw.
#[must_use]
pub fn is_better([base, other]: [&Fitted; 2], scope: &Scope, options: &SearchOptions) -> bool {
    let is_simpler = other.parameters.len() < base.parameters.len();
    let min_reduction = if is_simpler { 0.0 } else { options.min_reduction };
    let stages = compare(&scores(base), &scores(other), &scope.stages, options);
    let gains = stages.iter().any(|c| c.t > options.chance_t && c.reduction >= min_reduction);
    let loses = stages.iter().any(|c| c.t <= -options.chance_t && c.reduction <= -min_reduction);
    gains && !loses
}

/// Σr² of one log under both models.
#[derive(Clone, Copy, Default)]
struct OfLog {
    before: f64,
    after: f64,
    fitted: [f64; 2],
    samples: usize,
}

fn compare_stage(first: &[Score], second: &[Score], stage: Stage, options: &SearchOptions) -> Comparison {
    let pairs: Vec<(&Score, &Score)> =
        first.iter().zip(second).filter(|(score, _)| score.stage == stage && score.samples > 0).collect();
    let count = pairs.iter().map(|(a, _)| a.log + 1).max().unwrap_or(0);
    let mut logs = vec![OfLog::default(); count];
    for (a, b) in &pairs {
        let log = &mut logs[a.log];
        log.before += a.squares;
        log.after += b.squares;
        log.fitted[0] += a.fitted_squares;
        log.fitted[1] += b.fitted_squares;
        log.samples += a.samples;
    }
    let total = pairs.iter().map(|(a, _)| a.samples).sum::<usize>().max(1) as f64;
    // Contribution of a block to the total reduction: the Σr² of each log is scaled to its number of samples.
    let reduction = |a: &Score, b: &Score| {
        let log = &logs[a.log];
        (a.squares - b.squares) * log.samples as f64 / (log.before.max(f64::MIN_POSITIVE) * total)
    };
    let reductions: Vec<f64> = pairs.iter().map(|(a, b)| reduction(a, b)).collect();
    let of_block = |(a, b): &(&Score, &Score)| {
        0.5 * libm::log(a.squares.max(f64::MIN_POSITIVE) / b.squares.max(f64::MIN_POSITIVE))
    };
    let gains: Vec<f64> =
        pairs.iter().filter(|(a, _)| a.samples >= options.min_block_samples).map(of_block).collect();
    let n = gains.len().max(2) as f64;
    let mean = gains.iter().sum::<f64>() / n;
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let in_fold =
        |fold: usize| pairs.iter().filter(move |(a, _)| a.fold == fold).map(|(a, b)| reduction(a, b));
    let used = || logs.iter().filter(|log| log.samples > 0);
    let gain_of = |log: &OfLog| {
        let ratio = log.before.max(f64::MIN_POSITIVE) / log.after.max(f64::MIN_POSITIVE);
        0.5 * libm::log(ratio) * log.samples as f64 / total
    };
    let reduced = |before: f64, after: f64| 1.0 - after / before.max(f64::MIN_POSITIVE);
    let fitted_reduction = |log: &OfLog| reduced(log.fitted[0], log.fitted[1]) * log.samples as f64 / total;
    Comparison {
        stage,
        reduction: reductions.iter().sum(),
        fitted_reduction: used().map(fitted_reduction).sum(),
        t: mean / (variance / n).sqrt().max(f64::MIN_POSITIVE),
        min_t: options.min_t_of(gains.len()),
        evidence: INDEPENDENT * used().map(gain_of).sum::<f64>() * total,
        folds_better: (0..FOLDS).filter(|&fold| in_fold(fold).sum::<f64>() > 0.0).count(),
        worst_log: numerics::min(used().map(|l| reduced(l.before, l.after))).min(1.0),
        worst_fitted_log: numerics::min(used().map(|l| reduced(l.fitted[0], l.fitted[1]))).min(1.0),
        gain: used().map(gain_of).sum(),
    }
}
