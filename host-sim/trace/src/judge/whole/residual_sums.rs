//! Residuals over whole logs.

use super::WholeLogs;
use super::normal_sums::bias;
use crate::fit::fit_data::FitData;
use crate::judge::axis_findings::AxisFindings;
use model::effects::Stage;

/// Σr² of one stage of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageSquares {
    /// Index of the axis.
    pub axis: usize,
    /// Stage.
    pub stage: Stage,
    /// Σr² of the declared model and of the model with effects, µm² or N².
    pub squares: [f64; 2],
    /// Number of samples that count.
    pub samples: usize,
}

/// Σr² of a piece.
#[derive(Clone, Debug)]
pub struct PieceSquares {
    /// Start and end of its evaluated samples on the session's clock, s.
    pub from_to_s: [f64; 2],
    /// Source of its log.
    pub log: String,
    /// The stages of all axes.
    pub stages: Vec<StageSquares>,
}

/// Σr² of the pieces of a set.
#[must_use]
pub fn residual_sums(whole: &WholeLogs<'_>, axes: &[AxisFindings], set: usize) -> Vec<PieceSquares> {
    whole.map(set, |piece, signals| {
        let logs = [signals];
        let of_axis = |(index, axis)| of_axis(&whole.data(&logs, index), axis);
        let stages = axes.iter().enumerate().flat_map(of_axis).collect();
        let from_to_s = [piece.evaluated.start, piece.evaluated.end].map(|sample| piece.log.time_s(sample));
        PieceSquares { from_to_s, log: piece.log.source.clone(), stages }
    })
}

fn of_axis(data: &FitData<'_>, axis: &AxisFindings) -> Vec<StageSquares> {
    let mut all = Vec::new();
    for scope in &axis.scopes {
        let bias = bias(data, axis, &scope.stages);
        let data = FitData { bias: &bias, ..*data };
        let [before, after] = [&axis.baseline, &axis.model].map(|model| data.residuals(model, scope));
        for (before, after) in before.iter().zip(&after) {
            let counts = data.counting(after.stage, 0);
            all.push(StageSquares {
                axis: data.axis,
                stage: after.stage,
                squares: [before, after].map(|series| series.values.iter().map(|r| r * r).sum()),
                samples: (0..after.values.len()).filter(|&i| counts(i)).count(),
            });
        }
    }
    all
}

/// Rms of a stage of an axis over some pieces, of both models; `None` without samples that count.
#[must_use]
pub fn rms(pieces: &[PieceSquares], axis: usize, stage: Stage) -> Option<[f64; 2]> {
    let of_stage = pieces.iter().flat_map(|piece| &piece.stages);
    let mut sum = ([0.0; 2], 0);
    for squares in of_stage.filter(|squares| (squares.axis, squares.stage) == (axis, stage)) {
        sum.0[0] += squares.squares[0];
        sum.0[1] += squares.squares[1];
        sum.1 += squares.samples;
    }
    (sum.1 > 0).then(|| sum.0.map(|squares| (squares / sum.1 as f64).sqrt()))
}
