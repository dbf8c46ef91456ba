//! The structure as rigid bodies: Nguyen, Weikert, Wegener, equations (10) to (12).
//!
//! Each body has the six coordinates of equation (10). Joints have stiffness and damping in six directions at a point. The
//! force of each axis acts at its screw, whose line need not pass through a centre of gravity. [`assembly`] computes the
//! matrices of M·q″ + D·q′ + K·q = B·f for small displacements about the current axis positions, [`modes`] the natural
//! frequencies, and [`talk`] the displacement of the tool by accelerations. The crate `plant` integrates the equation.

pub mod assembly;
pub mod modes;
pub mod talk;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

pub use assembly::Assembly;

/// Upper bound of masses (kg), stiffnesses (N/µm) and dampings (N·s/mm).
const GREATEST: f64 = 1e9;

/// Upper bound of the absolute value of positions (mm), directions, and inertias (kg·m²).
const LONGEST_MM: f64 = 1e6;

/// Name of the floor in joints and axes.
pub const GROUND: &str = "ground";

/// Bodies, joints, axes, tool point and workpiece.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    /// Bodies by name.
    pub body: IndexMap<String, Body>,
    /// Joints between two bodies, or a body and the ground.
    pub joint: Vec<Joint>,
    /// Axes by name.
    pub axis: IndexMap<String, Axis>,
    /// The tool point.
    pub tool: Point,
    /// The point relative to which the tool point is measured.
    pub workpiece: Point,
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Mass.
    pub mass_kg: f64,
    /// Elements xx, yy, zz, xy, xz, yz of the inertia tensor about the centre of gravity. The sign of xy, xz, yz is that of
    /// the tensor.
    pub inertia_kg_m2: [f64; 6],
    /// Centre of gravity.
    pub centre_mm: [f64; 3],
}

/// Kind of a joint. [`Part::Joints`] selects joints by kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// Carriages on a rail.
    Guideway,
    /// Between the machine and the floor.
    Foot,
    /// Bodies screwed together.
    Flange,
}

/// Elastic contact of two bodies at several points, with the same stiffness and damping at each point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Kind of the joint.
    pub kind: JointKind,
    /// Name of a body, or "ground".
    pub from: String,
    /// Name of a body, or "ground".
    pub to: String,
    /// Points of contact.
    pub at_mm: Vec<[f64; 3]>,
    /// Stiffness along x, y, z at each point.
    pub stiffness_n_per_um: [f64; 3],
    /// Damping along x, y, z at each point.
    #[serde(default)]
    pub damping_n_s_per_mm: [f64; 3],
    /// Stiffness about x, y, z at each point.
    #[serde(default)]
    pub angular_stiffness_nm_per_mrad: [f64; 3],
    /// Damping about x, y, z at each point.
    #[serde(default)]
    pub angular_damping_nm_s_per_rad: [f64; 3],
}

/// An axis: motor and screw between two bodies, and a scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// The body with the motor, or "ground".
    pub from: String,
    /// The body with the nut.
    pub to: String,
    /// Direction in which `to` moves relative to `from` at a positive command; a vector of any length.
    pub direction: [f64; 3],
    /// A point of the screw's line, at which the drive force acts on `to` and the opposite force on `from`.
    pub at_mm: [f64; 3],
    /// A point of the scale's line.
    pub scale_at_mm: [f64; 3],
    /// Mass of motor and screw, reflected to the table.
    pub motor_mass_kg: f64,
    /// Stiffness of screw, nut and bearings.
    pub stiffness_n_per_um: f64,
    /// Damping along the screw.
    #[serde(default)]
    pub damping_n_s_per_mm: f64,
}

/// A point of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// Name of a body, or "ground".
    pub body: String,
    /// Position of the point.
    pub at_mm: [f64; 3],
}

/// A group of parameters that [`Structure::scaled`] multiplies by a common factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Stiffnesses of all joints of a kind.
    Joints(JointKind),
    /// Stiffnesses of the screws.
    Screws,
    /// Masses and moments of inertia of the bodies.
    Masses,
}

/// Error of a structure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StructureError {
    /// A number is not finite or out of range.
    #[error("{key}: expected {expected}, found {found}")]
    Number {
        /// Key of the number.
        key: String,
        /// The permitted range, in words.
        expected: &'static str,
        /// The number.
        found: f64,
    },
    /// A name is not that of a body.
    #[error("{key}: no body is called \"{name}\"")]
    NoBody {
        /// Key with the name.
        key: String,
        /// The name.
        name: String,
    },
    /// The inertia tensor is not positive definite, or a principal moment exceeds the sum of the other two.
    #[error("body.{0}.inertia_kg_m2: no body has these moments of inertia")]
    Inertia(String),
    /// The structure can move freely in a direction other than those of the axes.
    #[error("a body can move freely in a direction that no axis drives")]
    Loose,
    /// A joint or another axis blocks the motion of an axis.
    #[error("an axis drives in a direction that a joint or another axis blocks")]
    Stuck,
    /// A joint or an axis connects a body with itself.
    #[error("{0}: expected a body other than that of from")]
    Itself(String),
    /// An axis does not move the tool relative to the workpiece.
    #[error("axis.{0}: does not move the tool relative to the workpiece")]
    Idle(String),
}

impl Structure {
    /// This structure with the stiffnesses or masses of a part multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, part: Part, factor: f64) -> Self {
        let mut scaled = self.clone();
        match part {
            Part::Joints(kind) => {
                for joint in scaled.joint.iter_mut().filter(|joint| joint.kind == kind) {
                    joint.stiffness_n_per_um = joint.stiffness_n_per_um.map(|k| factor * k);
                    joint.angular_stiffness_nm_per_mrad =
                        joint.angular_stiffness_nm_per_mrad.map(|k| factor * k);
                }
            }
            Part::Screws => scaled.axis.values_mut().for_each(|axis| axis.stiffness_n_per_um *= factor),
            Part::Masses => {
                for body in scaled.body.values_mut() {
                    body.mass_kg *= factor;
                    body.inertia_kg_m2 = body.inertia_kg_m2.map(|element| factor * element);
                }
            }
        }
        scaled
    }

    /// Checks names and numbers.
    ///
    /// # Errors
    /// The first key that is refused.
    pub fn check(&self) -> Result<(), StructureError> {
        for (name, body) in &self.body {
            let key = |key: &str| format!("body.{name}.{key}");
            positive(key("mass_kg"), body.mass_kg)?;
            finite(&key("centre_mm"), &body.centre_mm)?;
            finite(&key("inertia_kg_m2"), &body.inertia_kg_m2)?;
            if !body.has_a_possible_inertia() {
                return Err(StructureError::Inertia(name.clone()));
            }
        }
        for (index, joint) in self.joint.iter().enumerate() {
            let key = |key: &str| format!("joint[{index}].{key}");
            self.named(key("from"), &joint.from)?;
            self.named(key("to"), &joint.to)?;
            if joint.from == joint.to {
                return Err(StructureError::Itself(key("to")));
            }
            joint.at_mm.iter().try_for_each(|at| finite(&key("at_mm"), at))?;
            not_negative(&key("stiffness_n_per_um"), &joint.stiffness_n_per_um)?;
            not_negative(&key("damping_n_s_per_mm"), &joint.damping_n_s_per_mm)?;
            not_negative(&key("angular_stiffness_nm_per_mrad"), &joint.angular_stiffness_nm_per_mrad)?;
            not_negative(&key("angular_damping_nm_s_per_rad"), &joint.angular_damping_nm_s_per_rad)?;
        }
        for (name, axis) in &self.axis {
            let key = |key: &str| format!("axis.{name}.{key}");
            self.named(key("from"), &axis.from)?;
            self.named(key("to"), &axis.to)?;
            if axis.from == axis.to {
                return Err(StructureError::Itself(key("to")));
            }
            finite(&key("at_mm"), &axis.at_mm)?;
            finite(&key("scale_at_mm"), &axis.scale_at_mm)?;
            finite(&key("direction"), &axis.direction)?;
            positive(key("direction"), axis.direction.iter().map(|part| part * part).sum())?;
            positive(key("motor_mass_kg"), axis.motor_mass_kg)?;
            positive(key("stiffness_n_per_um"), axis.stiffness_n_per_um)?;
            not_negative(&key("damping_n_s_per_mm"), &[axis.damping_n_s_per_mm])?;
        }
        for (key, point) in [("tool", &self.tool), ("workpiece", &self.workpiece)] {
            self.named(format!("{key}.body"), &point.body)?;
            finite(&format!("{key}.at_mm"), &point.at_mm)?;
        }
        Ok(())
    }

    fn named(&self, key: String, name: &str) -> Result<(), StructureError> {
        if name == GROUND || self.body.contains_key(name) {
            return Ok(());
        }
        Err(StructureError::NoBody { key, name: name.to_owned() })
    }
}

impl Body {
    /// The inertia tensor about the centre of gravity, kg·m².
    #[must_use]
    pub fn inertia(&self) -> nalgebra::Matrix3<f64> {
        let [xx, yy, zz, xy, xz, yz] = self.inertia_kg_m2;
        nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// All principal moments are positive, and none exceeds the sum of the other two.
    fn has_a_possible_inertia(&self) -> bool {
        let principal = self.inertia().symmetric_eigenvalues();
        let (least, most) = (principal.min(), principal.max());
        least > 0.0 && 2.0 * most <= principal.sum() * (1.0 + 1e-9)
    }
}

fn positive(key: String, found: f64) -> Result<(), StructureError> {
    if found > 0.0 && found <= GREATEST {
        return Ok(());
    }
    Err(StructureError::Number { key, expected: "a number above 0, at most 1e9", found })
}

fn not_negative(key: &str, values: &[f64]) -> Result<(), StructureError> {
    match values.iter().find(|value| !(0.0..=GREATEST).contains(*value)) {
        Some(&found) => {
            Err(StructureError::Number { key: key.to_owned(), expected: "a number from 0 to 1e9", found })
        }
        None => Ok(()),
    }
}

fn finite(key: &str, values: &[f64]) -> Result<(), StructureError> {
    match values.iter().find(|value| value.is_nan() || value.abs() > LONGEST_MM) {
        Some(&found) => {
            Err(StructureError::Number { key: key.to_owned(), expected: "a number within ±1e6", found })
        }
        None => Ok(()),
    }
}
