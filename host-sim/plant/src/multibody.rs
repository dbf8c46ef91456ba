//! A structure of rigid bodies in motion, exact for forces that are constant over a step.
//!
//! The equation of motion M·q'' + D·q' + K·q = B·f is written with the travel of a step, p = h·q', in the place of the
//! velocity: h·q' = p, h·p' = −h²M⁻¹K·q − hM⁻¹D·p + h²M⁻¹B·f. All terms then have the units of q, so that the matrix is
//! well scaled; its exponential is the step. This is stable however stiff a joint is. The forces f are those of the
//! motors and what is not linear: of each screw between motor and nut, and of each guide.

use nalgebra::{DMatrix, DVector, RowDVector};

use model::bodies::{Assembly, StructureError};

use crate::guide::FreeStep;

/// Forces of one axis over a step besides the springs and dampers of the structure, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisForces {
    /// On the motor.
    pub motor_n: f64,
    /// Of the screw, on the nut; its reaction is on the motor.
    pub screw_n: f64,
    /// Of the guide, on the body that the axis moves; its reaction is on the body that carries the guide.
    pub guide_n: f64,
}

/// A structure of rigid bodies and its state.
#[derive(Clone, Debug)]
pub struct Multibody {
    /// From coordinates, travel of a step and forces to coordinates and travel one step later.
    transition: DMatrix<f64>,
    /// Coordinates, travel of a step, forces.
    state: DVector<f64>,
    next: DVector<f64>,
    coordinates: usize,
    /// From the state to the mean velocity of each guide over a step; a row per axis.
    guide_mean: DMatrix<f64>,
    /// From the state to the velocity of each guide at the end of the step.
    guide_end: DMatrix<f64>,
    step_s: f64,
    stretches: DMatrix<f64>,
    motors: DMatrix<f64>,
    scales: DMatrix<f64>,
    tool: DMatrix<f64>,
}

impl Multibody {
    /// The assembly at rest at its origin, moved in steps of `step_s`.
    ///
    /// # Errors
    /// [`StructureError::Loose`] where the mass matrix has no inverse.
    pub fn new(assembly: &Assembly, step_s: f64) -> Result<Self, StructureError> {
        let (n, axes) = (assembly.mass.nrows(), assembly.axes());
        let masses = assembly.mass.clone().cholesky().ok_or(StructureError::Loose)?;
        let forces = DMatrix::from_fn(n, 3 * axes, |row, column| match column / axes {
            0 => assembly.drives[(row, column)],
            1 => assembly.stretches[(column - axes, row)],
            _ => assembly.guides[(column - 2 * axes, row)],
        });
        let inputs = 3 * axes;
        let mut rates = DMatrix::zeros(2 * n + inputs, 2 * n + inputs);
        rates.view_mut((0, n), (n, n)).fill_with_identity();
        let per_step = [
            (0, n, masses.solve(&assembly.stiffness) * -step_s.powi(2)),
            (n, n, masses.solve(&assembly.damping) * -step_s),
            (2 * n, inputs, masses.solve(&forces) * step_s.powi(2)),
        ];
        for (column, width, block) in per_step {
            rates.view_mut((n, column), (n, width)).copy_from(&block);
        }
        let transition = rates.exp().rows(0, 2 * n).into_owned();
        let mut guide_mean = &assembly.guides * transition.rows(0, n) / step_s;
        let before = &assembly.guides / step_s;
        guide_mean.columns_mut(0, n).zip_apply(&before, |mean, before| *mean -= before);
        let guide_end = &assembly.guides * transition.rows(n, n) / step_s;
        Ok(Self {
            transition,
            state: DVector::zeros(2 * n + inputs),
            next: DVector::zeros(2 * n),
            coordinates: n,
            guide_mean,
            guide_end,
            step_s,
            stretches: assembly.stretches.clone(),
            motors: assembly.motors.clone(),
            scales: assembly.scales.clone(),
            tool: assembly.tool.clone(),
        })
    }

    /// Sets the forces of one axis for all following steps.
    pub fn set_forces(&mut self, axis: usize, forces: AxisForces) {
        let axes = self.motors.nrows();
        for (kind, force_n) in [forces.motor_n, forces.screw_n, forces.guide_n].into_iter().enumerate() {
            self.state[2 * self.coordinates + kind * axes + axis] = force_n;
        }
    }

    /// Motion of the guide of an axis over the next step under the forces that are set, without that of the guide
    /// itself.
    #[must_use]
    pub fn free_step(&self, axis: usize) -> FreeStep<f64> {
        let own = 2 * self.coordinates + 2 * self.motors.nrows() + axis;
        let (mean, end) = (self.guide_mean.row(axis), self.guide_end.row(axis));
        let without = |row: &RowDVector<f64>| row.tr_dot(&self.state) - row[own] * self.state[own];
        FreeStep {
            mean_m_per_s: without(&mean.into_owned()),
            end_m_per_s: without(&end.into_owned()),
            mobility: mean[own],
            stopping_n_s_per_m: end[own].recip(),
        }
    }

    /// One step under the forces that are set.
    pub fn step(&mut self) {
        let n = self.coordinates;
        self.next.gemv(1.0, &self.transition, &self.state, 0.0);
        self.state.rows_mut(0, 2 * n).copy_from(&self.next);
    }

    /// Velocities of the motors, m/s.
    #[must_use]
    pub fn motors_m_per_s(&self) -> DVector<f64> {
        &self.motors * self.state.rows(self.coordinates, self.coordinates) / self.step_s
    }

    /// Velocities of the axes at their scales, m/s.
    #[must_use]
    pub fn scales_m_per_s(&self) -> DVector<f64> {
        &self.scales * self.state.rows(self.coordinates, self.coordinates) / self.step_s
    }

    /// Stretch of each screw, m: nut − motor.
    #[must_use]
    pub fn stretches_m(&self) -> DVector<f64> {
        &self.stretches * self.state.rows(0, self.coordinates)
    }

    /// Positions of the motors, m from the origin.
    #[must_use]
    pub fn motors_m(&self) -> DVector<f64> {
        &self.motors * self.state.rows(0, self.coordinates)
    }

    /// Positions of the axes at their scales, m from the origin.
    #[must_use]
    pub fn scales_m(&self) -> DVector<f64> {
        &self.scales * self.state.rows(0, self.coordinates)
    }

    /// Tool − workpiece, x, y, z, m from the origin.
    #[must_use]
    pub fn tool_m(&self) -> DVector<f64> {
        &self.tool * self.state.rows(0, self.coordinates)
    }
}

#[cfg(test)]
mod tests;
