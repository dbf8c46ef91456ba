//! The structure in time, exact for forces that stay over a step.
//!
//! With the way of a step, p = h·q′, in the place of the velocity the equation of motion has the rates h·q′ = p and
//! h·p′ = −h²M⁻¹K·q − hM⁻¹D·p + h²M⁻¹B·f, all in the units of q: a matrix that is not ill scaled, whose exponential is what
//! a step makes of state and force. There is nothing for a stiff joint to be unstable with. The forces f are those of
//! the motors and what no linear structure has: of each screw on its nut and back, and of each guide on what it guides.

use nalgebra::{DMatrix, DVector, RowDVector};

use model::bodies::{Assembly, StructureError};

use crate::guide::Free;

/// Forces of one axis over a step, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// On the motor.
    pub motor_n: f64,
    /// Of the screw, on the nut ahead and back on the motor, beyond its spring and damper.
    pub screw_n: f64,
    /// Of what guides the axis, on what it guides, and back.
    pub guide_n: f64,
}

/// A structure that moves.
#[derive(Clone, Debug)]
pub struct Moving {
    /// What a step makes of coordinates, ways of a step, and forces.
    transition: DMatrix<f64>,
    /// Those, one after the other.
    state: DVector<f64>,
    next: DVector<f64>,
    coordinates: usize,
    /// Rows are axes: what state and pushes make of the mean velocity of a guide over a step, and of that at its end.
    guide_mean: DMatrix<f64>,
    guide_end: DMatrix<f64>,
    step_s: f64,
    stretches: DMatrix<f64>,
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
        let pushes = DMatrix::from_fn(n, 3 * axes, |row, column| match column / axes {
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
            (2 * n, inputs, masses.solve(&pushes) * step_s.powi(2)),
        ];
        for (column, width, block) in per_step {
            rates.view_mut((n, column), (n, width)).copy_from(&block);
        }
        let transition = rates.exp().rows(0, 2 * n).into_owned();
        let mut guide_mean = &assembly.guides * transition.rows(0, n) / step_s;
        let stood = &assembly.guides / step_s;
        guide_mean.columns_mut(0, n).zip_apply(&stood, |mean, stood| *mean -= stood);
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

    /// The forces of one axis until others take their place.
    pub fn push(&mut self, axis: usize, push: Push) {
        let axes = self.motors.nrows();
        for (kind, force_n) in [push.motor_n, push.screw_n, push.guide_n].into_iter().enumerate() {
            self.state[2 * self.coordinates + kind * axes + axis] = force_n;
        }
    }

    /// How the guide of an axis would move over the next step as it is pushed now, less what its guide itself pushes.
    #[must_use]
    pub fn free(&self, axis: usize) -> Free<f64> {
        let own = 2 * self.coordinates + 2 * self.motors.nrows() + axis;
        let (mean, end) = (self.guide_mean.row(axis), self.guide_end.row(axis));
        let without = |row: &RowDVector<f64>| row.tr_dot(&self.state) - row[own] * self.state[own];
        Free {
            mean_m_per_s: without(&mean.into_owned()),
            end_m_per_s: without(&end.into_owned()),
            mobility: mean[own],
            stops_n_s_per_m: end[own].recip(),
        }
    }

    /// One step.
    pub fn step(&mut self) {
        let n = self.coordinates;
        self.next.gemv(1.0, &self.transition, &self.state, 0.0);
        self.state.rows_mut(0, 2 * n).copy_from(&self.next);
    }

    /// How fast the motors are, m/s.
    #[must_use]
    pub fn motors_m_per_s(&self) -> DVector<f64> {
        &self.motors * self.state.rows(self.coordinates, self.coordinates) / self.step_s
    }

    /// How fast the scales see their axes go, m/s.
    #[must_use]
    pub fn scales_m_per_s(&self) -> DVector<f64> {
        &self.scales * self.state.rows(self.coordinates, self.coordinates) / self.step_s
    }

    /// How far each nut is ahead of its motor, m.
    #[must_use]
    pub fn stretches_m(&self) -> DVector<f64> {
        &self.stretches * self.state.rows(0, self.coordinates)
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

#[cfg(test)]
mod tests;
