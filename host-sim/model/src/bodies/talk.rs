//! In-talk and cross-talk in closed form: what an axis that accelerates displaces at the tool.
//!
//! At rest: an axis j accelerates evenly while the position loops keep every scale on its command. The structure
//! then moves as q = r·x + w, with r the way of all that rides on the axis, K·r = 0 and S·r = eⱼ at the scales S, and w
//! what it bends by, S·w = 0. With the drive forces f unknown, too,
//!
//! ```text
//! | K  −B | |w|   |−M·r·a|            | K  −B | |r|   |0 |
//! | S   0 |·|f| = |   0  |    and     | S   0 |·|0| = |eⱼ|
//! ```
//!
//! so one factorisation gives both, and T·w/a at the tool is the coefficient (equations (7) to (9) of Nguyen, Weikert,
//! Wegener). On a circle of the angular frequency ω the same with K + iωD − ω²M, exactly: in phase with the
//! acceleration is what the fits see, and running the circle both ways takes out the rest.

use nalgebra::{Complex, ComplexField, DMatrix, Matrix3xX};

use super::{Assembly, Structure, StructureError};

/// Of the screw's stiffness: less does not hold an axis.
const FREE_SHARE: f64 = 1e-4;

/// Way of the tool for a metre of an axis, m, that is none.
const LEAST_WAY: f64 = 1e-3;

/// What acceleration does, a column an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Talk {
    /// Rows x, y, z: tool against workpiece beyond what the scales show, µm per m/s². In-talk and cross-talk.
    pub tool_um_s2_per_m: Matrix3xX<f64>,
    /// Rows are axes: drive force, N per m/s², which is the mass that a drive feels.
    pub force_kg: DMatrix<f64>,
}

impl Assembly {
    /// Under an even acceleration.
    ///
    /// # Errors
    /// [`StructureError::Loose`].
    pub fn talk_at_rest(&self) -> Result<Talk, StructureError> {
        let bordered = self.bordered(self.stiffness.clone()).lu();
        let rigid = bordered.solve(&self.commanded()).ok_or(StructureError::Loose)?;
        let rigid = rigid.rows(0, self.mass.nrows());
        let mut loads = DMatrix::zeros(self.mass.nrows() + self.axes(), self.axes());
        loads.rows_mut(0, self.mass.nrows()).copy_from(&-(&self.mass * rigid));
        let bent = bordered.solve(&loads).ok_or(StructureError::Loose)?;
        Ok(self.seen(&bent, 1.0))
    }

    /// On a circle of an angular frequency, rad/s: the part in phase with the acceleration.
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
        // Beyond what the scales show: the structure as one rigid body moves the tool with its scale.
        let rigid = self.bordered(self.stiffness.clone()).lu().solve(&self.commanded());
        let rigid = rigid.ok_or(StructureError::Loose)?;
        let coordinates = self.mass.nrows();
        let bent = whole.rows(0, coordinates) - rigid.rows(0, coordinates);
        whole.rows_mut(0, coordinates).copy_from(&bent);
        Ok(self.seen(&whole, -rad_per_s.powi(-2)))
    }

    /// Where each axis takes the tool against the workpiece: columns of x, y, z, m per metre of its scale.
    ///
    /// # Errors
    /// [`StructureError::Loose`].
    pub fn ways(&self) -> Result<Matrix3xX<f64>, StructureError> {
        let bordered = self.bordered(self.stiffness.clone()).lu();
        let rigid = bordered.solve(&self.commanded()).ok_or(StructureError::Loose)?;
        Ok((&self.tool * rigid.rows(0, self.mass.nrows())).fixed_rows::<3>(0).into_owned())
    }

    /// Whether each axis moves where nothing holds it, and the tool against the workpiece.
    ///
    /// # Errors
    /// [`StructureError::Stuck`], [`StructureError::Idle`].
    pub fn check_driven(&self, structure: &Structure) -> Result<(), StructureError> {
        let bordered = self.bordered(self.stiffness.clone()).lu();
        let rigid = bordered.solve(&self.commanded()).ok_or(StructureError::Stuck)?;
        let forces = rigid.rows(self.mass.nrows(), self.axes());
        for (number, (name, axis)) in structure.axis.iter().enumerate() {
            // A metre against what holds it would take the screw's stiffness or more; rounding leaves some 1e-9 of it.
            let held = forces.column(number).amax() > FREE_SHARE * 1e6 * axis.stiffness_n_per_um;
            if held || !rigid.column(number).iter().copied().all(f64::is_finite) {
                return Err(StructureError::Stuck);
            }
            let way = &self.tool * rigid.rows(0, self.mass.nrows()).column(number);
            if way.norm() < LEAST_WAY {
                return Err(StructureError::Idle(name.clone()));
            }
        }
        Ok(())
    }

    /// What of a solution is seen, per acceleration: the solution times `scale`.
    fn seen(&self, solution: &DMatrix<f64>, scale: f64) -> Talk {
        let (coordinates, axes) = (self.mass.nrows(), self.axes());
        let tool = &self.tool * solution.rows(0, coordinates) * (1e6 * scale);
        Talk {
            tool_um_s2_per_m: tool.fixed_rows::<3>(0).into_owned(),
            force_kg: solution.rows(coordinates, axes) * scale,
        }
    }

    /// The stiffness with the drive forces as unknowns and the scales as conditions.
    fn bordered<T: ComplexField<RealField = f64>>(&self, stiffness: DMatrix<T>) -> DMatrix<T> {
        let (coordinates, axes) = (self.mass.nrows(), self.axes());
        let mut whole = stiffness.resize(coordinates + axes, coordinates + axes, T::zero());
        let drives = self.drives.map(|part| T::from_real(-part));
        whole.view_mut((0, coordinates), (coordinates, axes)).copy_from(&drives);
        let scales = self.scales.map(T::from_real);
        whole.view_mut((coordinates, 0), (axes, coordinates)).copy_from(&scales);
        whole
    }

    /// One metre on the scale of one axis after the other.
    fn commanded(&self) -> DMatrix<f64> {
        let (coordinates, axes) = (self.mass.nrows(), self.axes());
        let mut commanded = DMatrix::zeros(coordinates + axes, axes);
        commanded.rows_mut(coordinates, axes).fill_with_identity();
        commanded
    }
}
