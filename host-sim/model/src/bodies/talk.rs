//! In-talk and cross-talk in closed form: displacement of the tool per acceleration of an axis.
//!
//! Quasi-static: axis j has a constant acceleration a, and the position loops keep every scale at its command. The
//! structure moves as q = r·x + w. Here r is the rigid motion with the axis, K·r = 0 and S·r = eⱼ at the scales S, and w is
//! the elastic deflection, S·w = 0. With the drive forces f as further unknowns,
//!
//! ```text
//! | K  −B | |w|   |−M·r·a|            | K  −B | |r|   |0 |
//! | S   0 |·|f| = |   0  |    and     | S   0 |·|0| = |eⱼ|
//! ```
//!
//! so that one factorisation solves both. The coefficient is T·w/a at the tool (equations (7) to (9) of Nguyen, Weikert,
//! Wegener). On a circle of angular frequency ω, K is replaced by K + iωD − ω²M. The coefficient is then the part in
//! phase with the acceleration; the other part cancels if the circle is travelled in both directions.

use nalgebra::{Complex, ComplexField, DMatrix, Matrix3xX};

use super::{Assembly, Structure, StructureError};

/// Stiffness against the motion of an axis, as a fraction of the screw's stiffness, below which the axis can move freely.
const FREE_FRACTION: f64 = 1e-4;

/// Displacement of the tool per metre of an axis, m, below which the axis does not move the tool.
const MIN_TOOL_TRAVEL: f64 = 1e-3;

/// Response to accelerations, one column per axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Talk {
    /// Rows x, y, z: displacement of the tool relative to the workpiece that the scales do not measure, µm per m/s²: in-talk
    /// and cross-talk.
    pub tool_um_s2_per_m: Matrix3xX<f64>,
    /// One row per axis: drive force, N per m/s², which is the effective mass.
    pub force_kg: DMatrix<f64>,
}

impl Assembly {
    /// Response to a constant acceleration.
    ///
    /// # Errors
    /// [`StructureError::Loose`].
    pub fn talk_at_rest(&self) -> Result<Talk, StructureError> {
        let bordered = self.bordered(self.stiffness.clone()).lu();
        let rigid = bordered.solve(&self.commanded()).ok_or(StructureError::Loose)?;
        let rigid = rigid.rows(0, self.mass.nrows());
        let mut loads = DMatrix::zeros(self.mass.nrows() + self.axes(), self.axes());
        loads.rows_mut(0, self.mass.nrows()).copy_from(&-(&self.mass * rigid));
        let deflection = bordered.solve(&loads).ok_or(StructureError::Loose)?;
        Ok(self.outputs(&deflection, 1.0))
    }

    /// Response on a circle of this angular frequency, rad/s: the part in phase with the acceleration.
    ///
    /// # Errors
    /// [`StructureError::Loose`].
    pub fn talk_at(&self, rad_per_s: f64) -> Result<Talk, StructureError> {
        let complex = |real: f64| Complex::from_real(real);
        let dynamic = (&self.stiffness - &self.mass * rad_per_s.powi(2)).map(complex)
            + (&self.damping * rad_per_s).map(|imaginary| Complex::new(0.0, imaginary));
        let bordered = self.bordered(dynamic).lu();
        let swing = bordered.solve(&self.commanded().map(complex)).ok_or(StructureError::Loose)?;
        let mut whole = swing.map(|part| part.re);
        // The rigid motion, which the scales measure, is subtracted.
        let rigid = self.bordered(self.stiffness.clone()).lu().solve(&self.commanded());
        let rigid = rigid.ok_or(StructureError::Loose)?;
        let coordinates = self.mass.nrows();
        let deflection = whole.rows(0, coordinates) - rigid.rows(0, coordinates);
        whole.rows_mut(0, coordinates).copy_from(&deflection);
        Ok(self.outputs(&whole, -rad_per_s.powi(-2)))
    }

    /// Displacement of the tool relative to the workpiece per displacement of each axis: columns x, y, z, m per metre of the
    /// scale.
    ///
    /// # Errors
    /// [`StructureError::Loose`].
    pub fn ways(&self) -> Result<Matrix3xX<f64>, StructureError> {
        let bordered = self.bordered(self.stiffness.clone()).lu();
        let rigid = bordered.solve(&self.commanded()).ok_or(StructureError::Loose)?;
        Ok((&self.tool * rigid.rows(0, self.mass.nrows())).fixed_rows::<3>(0).into_owned())
    }

    /// Checks that each axis can move freely, and that it moves the tool relative to the workpiece.
    ///
    /// # Errors
    /// [`StructureError::Stuck`], [`StructureError::Idle`].
    pub fn check_driven(&self, structure: &Structure) -> Result<(), StructureError> {
        let bordered = self.bordered(self.stiffness.clone()).lu();
        let rigid = bordered.solve(&self.commanded()).ok_or(StructureError::Stuck)?;
        let forces = rigid.rows(self.mass.nrows(), self.axes());
        for (number, (name, axis)) in structure.axis.iter().enumerate() {
            // Displacing a blocked axis by one metre requires a force of about the screw's stiffness or more. The rounding
            // error of a free axis is about 1e-9 of it.
            let held = forces.column(number).amax() > FREE_FRACTION * 1e6 * axis.stiffness_n_per_um;
            if held || !rigid.column(number).iter().copied().all(f64::is_finite) {
                return Err(StructureError::Stuck);
            }
            let travel = &self.tool * rigid.rows(0, self.mass.nrows()).column(number);
            if travel.norm() < MIN_TOOL_TRAVEL {
                return Err(StructureError::Idle(name.clone()));
            }
        }
        Ok(())
    }

    /// Tool displacements and drive forces of a solution, times `scale`.
    fn outputs(&self, solution: &DMatrix<f64>, scale: f64) -> Talk {
        let (coordinates, axes) = (self.mass.nrows(), self.axes());
        let tool = &self.tool * solution.rows(0, coordinates) * (1e6 * scale);
        Talk {
            tool_um_s2_per_m: tool.fixed_rows::<3>(0).into_owned(),
            force_kg: solution.rows(coordinates, axes) * scale,
        }
    }

    /// The stiffness matrix, bordered with the drive forces as unknowns and the scales as constraints.
    fn bordered<T: ComplexField<RealField = f64>>(&self, stiffness: DMatrix<T>) -> DMatrix<T> {
        let (coordinates, axes) = (self.mass.nrows(), self.axes());
        let mut whole = stiffness.resize(coordinates + axes, coordinates + axes, T::zero());
        let drives = self.drives.map(|part| T::from_real(-part));
        whole.view_mut((0, coordinates), (coordinates, axes)).copy_from(&drives);
        let scales = self.scales.map(T::from_real);
        whole.view_mut((coordinates, 0), (axes, coordinates)).copy_from(&scales);
        whole
    }

    /// Right-hand sides, one column per axis: one metre on the scale of this axis, zero on the others.
    fn commanded(&self) -> DMatrix<f64> {
        let (coordinates, axes) = (self.mass.nrows(), self.axes());
        let mut commanded = DMatrix::zeros(coordinates + axes, axes);
        commanded.rows_mut(coordinates, axes).fill_with_identity();
        commanded
    }
}
