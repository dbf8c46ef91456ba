//! Natural frequencies: M·q″ + K·q = 0.
//!
//! With M = L·Lᵀ they are the roots of the eigenvalues of L⁻¹·K·L⁻ᵀ, which is symmetric.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use super::{Assembly, StructureError};

/// Slower than this nothing holds a body, Hz: zeros come out at millionths of it by rounding, and machines do not swing
/// so slowly.
const HELD_HZ: f64 = 0.01;

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
        let free = self.natural_frequencies_hz()?.iter().filter(|hz| **hz < HELD_HZ).count();
        match free.cmp(&self.axes()) {
            Ordering::Greater => Err(StructureError::Loose),
            Ordering::Less => Err(StructureError::Stuck),
            Ordering::Equal => Ok(()),
        }
    }
}
