//! The matrices of a structure: equation (12) of Nguyen, Weikert, Wegener.
//!
//! The displacement of a point p of a body with the centre of gravity c is u = t + θ × (p − c). A joint of stiffness k
//! between two points adds Jᵀ·k·J to K, where J is the Jacobian of their relative displacement. A screw adds the same term
//! along its line, with the displacement of the motor as an additional coordinate. Coordinates: t (m) and θ (rad) of each
//! body, then the displacement of each motor (m, reflected to the table).

use nalgebra::{DMatrix, DVector, Matrix3, RowDVector, Vector3};

use super::{Axis, Point, Structure, StructureError};

/// Metres in a millimetre.
const MM: f64 = 1e-3;

/// The matrices of M·q″ + D·q′ + K·q = B·f, and the linear maps from q to measured quantities.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// M, kg and kg·m².
    pub mass: DMatrix<f64>,
    /// D.
    pub damping: DMatrix<f64>,
    /// K.
    pub stiffness: DMatrix<f64>,
    /// B: one column per axis, for the force of its motor, N.
    pub drives: DMatrix<f64>,
    /// One row per axis: nut − motor, m.
    pub stretches: DMatrix<f64>,
    /// One row per axis: displacement of the guided body relative to the guiding body, along the axis at the screw, m.
    pub guides: DMatrix<f64>,
    /// One row per axis: displacement of the motor, m.
    pub motors: DMatrix<f64>,
    /// One row per axis: reading of the scale, m.
    pub scales: DMatrix<f64>,
    /// Rows x, y, z: displacement of the tool relative to the workpiece, m.
    pub tool: DMatrix<f64>,
}

impl Assembly {
    /// The matrices of a structure.
    ///
    /// # Errors
    /// If the structure is invalid, see [`Structure::check`], or its axes cannot move as required, see
    /// [`Assembly::check_held`] and [`Assembly::check_driven`].
    pub fn of(structure: &Structure) -> Result<Self, StructureError> {
        structure.check()?;
        let (bodies, axes) = (6 * structure.body.len(), structure.axis.len());
        let all = bodies + axes;
        let square = || DMatrix::zeros(all, all);
        let mut whole = Self {
            mass: square(),
            damping: square(),
            stiffness: square(),
            drives: DMatrix::zeros(all, axes),
            stretches: DMatrix::zeros(axes, all),
            guides: DMatrix::zeros(axes, all),
            motors: DMatrix::zeros(axes, all),
            scales: DMatrix::zeros(axes, all),
            tool: DMatrix::zeros(3, all),
        };
        for (index, body) in structure.body.values().enumerate() {
            let mass = Matrix3::from_diagonal_element(body.mass_kg);
            whole.mass.fixed_view_mut::<3, 3>(6 * index, 6 * index).copy_from(&mass);
            whole.mass.fixed_view_mut::<3, 3>(6 * index + 3, 6 * index + 3).copy_from(&body.inertia());
        }
        for joint in &structure.joint {
            for at in &joint.at_mm {
                let translation = relative(structure, &joint.from, &joint.to, *at);
                let rotation = rotation(structure, &joint.to) - rotation(structure, &joint.from);
                whole.stiffen(&translation, joint.stiffness_n_per_um.map(|k| 1e6 * k));
                whole.stiffen(&rotation, joint.angular_stiffness_nm_per_mrad.map(|k| 1e3 * k));
                whole.damp(&translation, joint.damping_n_s_per_mm.map(|d| 1e3 * d));
                whole.damp(&rotation, joint.angular_damping_nm_s_per_rad);
            }
        }
        for (number, axis) in structure.axis.values().enumerate() {
            whole.drive(structure, number, axis);
        }
        let point = |point: &Point| displacement(structure, &point.body, point.at_mm);
        whole.tool = point(&structure.tool) - point(&structure.workpiece);
        whole.check_held()?;
        whole.check_driven(structure)?;
        Ok(whole)
    }

    /// Number of axes.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.drives.ncols()
    }

    fn drive(&mut self, structure: &Structure, number: usize, axis: &Axis) {
        let motor = 6 * structure.body.len() + number;
        let direction = Vector3::from(axis.direction).normalize();
        let along = |at| relative(structure, &axis.from, &axis.to, at).tr_mul(&direction).transpose();
        let mut stretch: RowDVector<f64> = along(axis.at_mm);
        self.guides.set_row(number, &stretch);
        stretch[motor] = -1.0;
        self.stretches.set_row(number, &stretch);
        self.stiffness += stretch.transpose() * &stretch * (1e6 * axis.stiffness_n_per_um);
        self.damping += stretch.transpose() * &stretch * (1e3 * axis.damping_n_s_per_mm);
        self.mass[(motor, motor)] = axis.motor_mass_kg;
        self.drives[(motor, number)] = 1.0;
        self.motors[(number, motor)] = 1.0;
        self.scales.set_row(number, &along(axis.scale_at_mm));
    }

    fn stiffen(&mut self, rows: &DMatrix<f64>, values: [f64; 3]) {
        self.stiffness += rows.transpose() * diagonal(values) * rows;
    }

    fn damp(&mut self, rows: &DMatrix<f64>, values: [f64; 3]) {
        self.damping += rows.transpose() * diagonal(values) * rows;
    }
}

fn diagonal(values: [f64; 3]) -> DMatrix<f64> {
    DMatrix::from_diagonal(&DVector::from_row_slice(&values))
}

/// Rows x, y, z: displacement of `to` relative to `from` at a point, m.
fn relative(structure: &Structure, from: &str, to: &str, at_mm: [f64; 3]) -> DMatrix<f64> {
    displacement(structure, to, at_mm) - displacement(structure, from, at_mm)
}

/// Rows x, y, z: displacement of a point of a body, m. Zero for the ground, which is not in the list of bodies.
fn displacement(structure: &Structure, name: &str, at_mm: [f64; 3]) -> DMatrix<f64> {
    let mut rows = zero_rows(structure);
    if let Some((index, _, body)) = structure.body.get_full(name) {
        let arm = MM * (Vector3::from(at_mm) - Vector3::from(body.centre_mm));
        rows.fixed_view_mut::<3, 3>(0, 6 * index).fill_with_identity();
        rows.fixed_view_mut::<3, 3>(0, 6 * index + 3).copy_from(&-arm.cross_matrix());
    }
    rows
}

/// Rows x, y, z: rotation of a body, rad.
fn rotation(structure: &Structure, name: &str) -> DMatrix<f64> {
    let mut rows = zero_rows(structure);
    if let Some(index) = structure.body.get_index_of(name) {
        rows.fixed_view_mut::<3, 3>(0, 6 * index + 3).fill_with_identity();
    }
    rows
}

fn zero_rows(structure: &Structure) -> DMatrix<f64> {
    DMatrix::zeros(3, 6 * structure.body.len() + structure.axis.len())
}
