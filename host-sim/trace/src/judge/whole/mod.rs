//! Fit and residuals of logs that are too long for a search as a whole.
//!
//! Effects are searched for in stretches ([`crate::input::parts`]). Then each parameter takes one Gauss–Newton step to the
//! normal equations of all samples ([`normal_sums`]), scope by scope, and the residuals of both models are computed over all
//! samples ([`residual_sums`]). The logs are evaluated piece by piece, so that memory does not grow with their length beyond
//! the values themselves. Of the findings, [`refinement`] replaces the values of the parameters and the residuals; confidence
//! intervals, the share of each effect and the analysis of the remaining residuals are those of the stretches.

pub mod normal_sums;
pub mod refinement;
pub mod residual_sums;

use crate::fit::fit_data::FitData;
use crate::input::parts::{Parts, Piece};
use crate::input::signals::Signals;
use crate::repair::repaired::Repaired;
use rayon::prelude::*;

/// Logs that are evaluated piece by piece.
#[derive(Clone, Debug)]
pub struct WholeLogs<'a> {
    /// The logs.
    pub repaired: &'a Repaired<'a>,
    /// Parts that are fitted and held out.
    pub parts: Parts<'a>,
}

impl WholeLogs<'_> {
    /// The results of a function of each piece of a set, in the order of the pieces.
    fn map<T: Send>(&self, set: usize, of: impl Fn(&Piece<'_>, Signals) -> T + Sync) -> Vec<T> {
        let pieces = self.parts.pieces(set);
        let (preparation, late) = self.repaired.preparation();
        let of_piece = |piece: &Piece<'_>| of(piece, preparation.corrected(piece, set, late));
        pieces.par_iter().map(of_piece).collect()
    }

    /// The data of an axis, by its index, in a piece.
    fn data<'a>(&'a self, piece: &'a [Signals; 1], axis: usize) -> FitData<'a> {
        self.repaired.declared.data(piece, axis)
    }
}

#[cfg(test)]
mod tests;
