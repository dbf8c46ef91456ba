//! Natural frequencies: M·q″ + K·q = 0.
//!
//! With M = L·Lᵀ, the angular frequencies are the square roots of the eigenvalues of the symmetric matrix L⁻¹·K·L⁻ᵀ.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use super::{Assembly, StructureError};

/// Frequency below which a mode is a free motion: this frequency in Hz, or this fraction of the highest frequency.
/// Machines have no modes at such low frequencies. Rounding moves zero eigenvalues to about 1e-16 of the largest one, and
/// thus zero frequencies to about 1e-8 of the highest one.
const HELD_HZ: f64 = 0.01;
const HELD_FRACTION: f64 = 1e-6;

impl Assembly {
    /// Natural frequencies of the undamped structure with free motors, Hz, in ascending order. The first ones are zero, one
    /// for each axis.
    ///
    /// # Errors
    /// [`StructureError::Loose`] if the mass matrix is not positive definite.
    pub fn natural_frequencies_hz(&self) -> Result<Vec<f64>, StructureError> {
        let root = self.mass.clone().cholesky().ok_or(StructureError::Loose)?.unpack();
        let half = root.solve_lower_triangular(&self.stiffness).ok_or(StructureError::Loose)?;
        let both = root.solve_lower_triangular(&half.transpose()).ok_or(StructureError::Loose)?;
        // Zero eigenvalues may be slightly negative by rounding.
        let frequency = |eigenvalue: &f64| eigenvalue.max(0.0).sqrt() / TAU;
        let mut all: Vec<f64> = both.symmetric_eigenvalues().iter().map(frequency).collect();
        all.sort_by(f64::total_cmp);
        Ok(all)
    }

    /// Checks that the number of free motions is the number of axes.
    ///
    /// # Errors
    /// [`StructureError::Loose`] if there are more free motions, [`StructureError::Stuck`] if there are fewer.
    pub fn check_held(&self) -> Result<(), StructureError> {
        let all = self.natural_frequencies_hz()?;
        let lowest_hz = all.last().map_or(HELD_HZ, |highest| HELD_HZ.max(HELD_FRACTION * highest));
        let free = all.iter().filter(|hz| **hz < lowest_hz).count();
        match free.cmp(&self.axes()) {
            Ordering::Greater => Err(StructureError::Loose),
            Ordering::Less => Err(StructureError::Stuck),
            Ordering::Equal => Ok(()),
        }
    }
}
