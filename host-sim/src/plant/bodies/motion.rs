//! The structure in time, exact for forces that stay over a step.
//!
//! With the way of a step, p = h·q′, in the place of the velocity the equation of motion has the rates h·q′ = p and
//! h·p′ = −h²M⁻¹K·q − hM⁻¹D·p + h²M⁻¹B·f, all in the units of q: a matrix that is not ill scaled, whose exponential is what
//! a step makes of state and force. There is nothing for a stiff joint to be unstable with.

use nalgebra::{DMatrix, DVector};

use super::{Assembly, StructureError};

/// A structure that moves.
#[derive(Clone, Debug)]
pub struct Moving {
    /// What a step makes of coordinates, ways of a step, and forces.
    transition: DMatrix<f64>,
    /// Those, one after the other.
    state: DVector<f64>,
    next: DVector<f64>,
    coordinates: usize,
    motors: DMatrix<f64>,
    scales: DMatrix<f64>,
    tool: DMatrix<f64>,
}

impl Moving {
    /// At rest in its middle.
    ///
    /// # Errors
    /// [`StructureError::Loose`] where the masses have no inverse.
    pub fn new(assembly: &Assembly, step_s: f64) -> Result<Self, StructureError> {
        let (n, axes) = (assembly.mass.nrows(), assembly.axes());
        let masses = assembly.mass.clone().cholesky().ok_or(StructureError::Loose)?;
        let mut rates = DMatrix::zeros(2 * n + axes, 2 * n + axes);
        rates.view_mut((0, n), (n, n)).fill_with_identity();
        let per_step = [
            (0, n, masses.solve(&assembly.stiffness) * -step_s.powi(2)),
            (n, n, masses.solve(&assembly.damping) * -step_s),
            (2 * n, axes, masses.solve(&assembly.drives) * step_s.powi(2)),
        ];
        for (column, width, block) in per_step {
            rates.view_mut((n, column), (n, width)).copy_from(&block);
        }
        let transition = rates.exp().rows(0, 2 * n).into_owned();
        Ok(Self {
            transition,
            state: DVector::zeros(2 * n + axes),
            next: DVector::zeros(2 * n),
            coordinates: n,
            motors: assembly.motors.clone(),
            scales: assembly.scales.clone(),
            tool: assembly.tool.clone(),
        })
    }

    /// One step under the motors' forces, N.
    pub fn step(&mut self, forces_n: &[f64]) {
        let n = self.coordinates;
        for (place, force) in self.state.rows_mut(2 * n, forces_n.len()).iter_mut().zip(forces_n) {
            *place = *force;
        }
        self.next.gemv(1.0, &self.transition, &self.state, 0.0);
        self.state.rows_mut(0, 2 * n).copy_from(&self.next);
    }

    /// What the motors show, m from the middle.
    #[must_use]
    pub fn motors_m(&self) -> DVector<f64> {
        &self.motors * self.state.rows(0, self.coordinates)
    }

    /// What the scales show, m from the middle.
    #[must_use]
    pub fn scales_m(&self) -> DVector<f64> {
        &self.scales * self.state.rows(0, self.coordinates)
    }

    /// Tool against workpiece, x, y, z, m from the middle.
    #[must_use]
    pub fn tool_m(&self) -> DVector<f64> {
        &self.tool * self.state.rows(0, self.coordinates)
    }
}
