//! Natural frequencies: M·q″ + K·q = 0.
//!
//! With M = L·Lᵀ they are the roots of the eigenvalues of L⁻¹·K·L⁻ᵀ, which is symmetric.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use super::{Assembly, StructureError};

/// Slower than this nothing holds a body, Hz and share of the fastest mode: machines do not swing so slowly, and
/// rounding leaves zeros at the root of 1e-16 of the fastest.
const HELD_HZ: f64 = 0.01;
const HELD_SHARE: f64 = 1e-6;

impl Assembly {
    /// Natural frequencies of the undamped structure with its motors free, Hz, from the lowest: a zero for each
    /// axis, which nothing holds, comes first.
    ///
    /// # Errors
    /// [`StructureError::Loose`] where the masses have no inverse.
    pub fn natural_frequencies_hz(&self) -> Result<Vec<f64>, StructureError> {
        let root = self.mass.clone().cholesky().ok_or(StructureError::Loose)?.unpack();
        let half = root.solve_lower_triangular(&self.stiffness).ok_or(StructureError::Loose)?;
        let both = root.solve_lower_triangular(&half.transpose()).ok_or(StructureError::Loose)?;
        // Rounding leaves the zeros a little below zero.
        let frequency = |eigenvalue: &f64| eigenvalue.max(0.0).sqrt() / TAU;
        let mut all: Vec<f64> = both.symmetric_eigenvalues().iter().map(frequency).collect();
        all.sort_by(f64::total_cmp);
        Ok(all)
    }

    /// Whether the axes can move, and nothing else.
    ///
    /// # Errors
    /// [`StructureError::Loose`] where something else can, [`StructureError::Stuck`] where an axis cannot.
    pub fn check_held(&self) -> Result<(), StructureError> {
        let all = self.natural_frequencies_hz()?;
        let least = all.last().map_or(HELD_HZ, |fastest| HELD_HZ.max(HELD_SHARE * fastest));
        let free = all.iter().filter(|hz| **hz < least).count();
        match free.cmp(&self.axes()) {
            Ordering::Greater => Err(StructureError::Loose),
            Ordering::Less => Err(StructureError::Stuck),
            Ordering::Equal => Ok(()),
        }
    }
}
