//! The gain in log-likelihood by an effect on held-out logs, and the test whether a loss refutes the effect.

use std::collections::BTreeSet;

use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::fit::normal_equations::block_ranges;
use crate::options::TraceOptions;
use model::effects::Stage;

/// The (negative) gain in log-likelihood per sample, if the residuals of held-out logs refute the effect; `None` otherwise.
/// `residuals` are those without and with the effect.
#[must_use]
pub fn refuting_loss(data: &FitData<'_>, residuals: [&[ResidualSeries]; 2]) -> Option<f64> {
    let cells = cells(data, residuals);
    if let Some(total) = loss_over_all(&cells, data.options) {
        return Some(total);
    }
    // However much one stage gains, no other may lose more than this.
    let stages: BTreeSet<Stage> = cells.iter().map(|cell| cell.stage).collect();
    let of_stage = |stage| {
        let own: Vec<Cell> = cells.iter().copied().filter(|cell| cell.stage == stage).collect();
        gain(&own, None)
    };
    let worst = numerics::min(stages.into_iter().map(of_stage));
    (worst < -data.options.search.max_stage_loss).then_some(worst)
}

/// The loss of all stages together, if it refutes the effect. The limit for a single stage is not applied: what an effect reveals in one
/// stage may be described by an effect that is added later.
#[must_use]
pub fn refuting_loss_over_all(data: &FitData<'_>, residuals: [&[ResidualSeries]; 2]) -> Option<f64> {
    loss_over_all(&cells(data, residuals), data.options)
}

fn loss_over_all(cells: &[Cell], options: &TraceOptions) -> Option<f64> {
    let total = gain(cells, None);
    is_refuted(total, standard_error(cells), options).then_some(total)
}

/// Whether a gain in log-likelihood per sample, with its standard error, refutes an effect.
fn is_refuted(gain: f64, error: f64, options: &TraceOptions) -> bool {
    let limits = &options.validation;
    gain < -limits.max_loss || gain < -limits.min_loss.max(options.search.chance_t * error)
}

/// Σr² of one block of one stage of one log, without and with an effect.
#[derive(Clone, Copy, Debug)]
struct Cell {
    stage: Stage,
    log: usize,
    block: usize,
    squares: [f64; 2],
    samples: usize,
}

fn cells(data: &FitData<'_>, [without, with]: [&[ResidualSeries]; 2]) -> Vec<Cell> {
    let mut cells = Vec::new();
    for (before, after) in without.iter().zip(with) {
        let counts = data.counting(before.stage, before.log);
        let ranges = block_ranges(before.values.len(), 1);
        for (block, range) in ranges.into_iter().enumerate() {
            let squares =
                [before, after].map(|series| series.values[range.clone()].iter().map(|r| r * r).sum::<f64>());
            let samples = range.filter(|&i| counts(i)).count();
            if samples > 0 {
                cells.push(Cell { stage: before.stage, log: before.log, block, squares, samples });
            }
        }
    }
    cells
}

/// Gain in log-likelihood per sample by the effect: ½·ln(Σr² without / Σr² with) of each log with its own noise, averaged
/// over the samples of a stage, summed over the stages. `left_out` is a block (log, number) that is omitted.
fn gain(cells: &[Cell], left_out: Option<(usize, usize)>) -> f64 {
    let mut logs: Vec<Cell> = Vec::new();
    for cell in cells.iter().filter(|cell| left_out != Some((cell.log, cell.block))) {
        match logs.iter_mut().find(|log| (log.stage, log.log) == (cell.stage, cell.log)) {
            Some(log) => {
                log.samples += cell.samples;
                (0..2).for_each(|i| log.squares[i] += cell.squares[i]);
            }
            None => logs.push(*cell),
        }
    }
    let of_stage =
        |stage| logs.iter().filter(move |log| log.stage == stage).map(|log| log.samples).sum::<usize>();
    let of_log = |log: &Cell| {
        let [without, with] = log.squares.map(|squares| squares.max(f64::MIN_POSITIVE));
        0.5 * libm::log(without / with) * log.samples as f64 / of_stage(log.stage) as f64
    };
    logs.iter().map(of_log).sum()
}

/// Standard error of the gain by jackknife over the blocks of the logs. It is also valid for a gain that depends on a few
/// blocks.
fn standard_error(cells: &[Cell]) -> f64 {
    let blocks: BTreeSet<(usize, usize)> = cells.iter().map(|cell| (cell.log, cell.block)).collect();
    let n = blocks.len().max(2) as f64;
    let gains: Vec<f64> = blocks.into_iter().map(|block| gain(cells, Some(block))).collect();
    let mean = gains.iter().sum::<f64>() / n;
    let squares: f64 = gains.iter().map(|gain| (gain - mean).powi(2)).sum();
    (squares * (n - 1.0) / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::normal_equations::BLOCKS;

    /// Two stages of two logs, 24 blocks each. Σr² per block is 100 without the effect and `with` with the effect.
    fn cells(with: impl Fn(Stage, usize, usize) -> f64) -> Vec<Cell> {
        let mut all = Vec::new();
        for stage in [Stage::Table, Stage::Force] {
            for (log, block) in (0..2).flat_map(|log| (0..BLOCKS).map(move |block| (log, block))) {
                let squares = [100.0, with(stage, log, block)];
                all.push(Cell { stage, log, block, squares, samples: 100 });
            }
        }
        all
    }

    fn refuted(cells: &[Cell]) -> bool {
        is_refuted(gain(cells, None), standard_error(cells), &TraceOptions::default())
    }

    /// A deviation of ±1 that differs from block to block and sums to zero over a log.
    fn sign(block: usize) -> f64 {
        if block.is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    #[test]
    fn the_gain_is_in_log_likelihood_and_its_error_is_that_of_the_mean_over_blocks() {
        // Σr² of the table increases by 4 %: −½·ln 1.04 in one of two stages.
        let cells =
            cells(|stage, _, block| if stage == Stage::Table { 104.0 + 10.0 * sign(block) } else { 100.0 });
        assert!((gain(&cells, None) + 0.5 * 1.04f64.ln()).abs() < 1e-12);
        // d(½·ln Σ) = ½·d/Σ: ±10 of 104 in each of 48 blocks is ½·10/104/√48; with n − 1 degrees of freedom /√47.
        let expected = 0.5 * 10.0 / 104.0 / 47f64.sqrt();
        assert!((standard_error(&cells) / expected - 1.0).abs() < 0.01, "{}", standard_error(&cells));
    }

    #[test]
    fn a_small_loss_must_be_significant_to_refute_and_a_large_one_need_not() {
        // The rms of both stages increases by 2 %, equally in all blocks: significant. The same mean with a scatter of ±60 %
        // between blocks: not significant.
        assert!(refuted(&cells(|_, _, _| 104.0)));
        assert!(!refuted(&cells(|_, _, block| 104.0 + 60.0 * sign(block))));
        // An increase of Σr² by 0.4 % is within the change caused by fitting again.
        assert!(!refuted(&cells(|_, _, _| 100.4)));
        // The entire loss is in one block. Its standard error is as large as the loss, but the rms grows by √2.
        assert!(refuted(&cells(|_, _, block| if block == 3 { 2500.0 } else { 100.0 })));
        assert!(!refuted(&cells(|_, _, _| 96.0)));
    }

    #[test]
    fn a_large_gain_of_one_stage_outweighs_a_small_loss_of_another() {
        let cost = |table: f64| move |stage, _, _| if stage == Stage::Table { table } else { 110.0 };
        assert!(
            !refuted(&cells(cost(25.0))),
            "the residual of the table is halved, that of the force grows by 5 %"
        );
        assert!(
            refuted(&cells(cost(99.0))),
            "the residual of the table decreases by 0.5 %, that of the force grows by 5 %"
        );
    }
}
