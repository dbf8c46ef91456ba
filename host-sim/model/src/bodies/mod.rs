//! The structure as rigid bodies: Nguyen, Weikert, Wegener, equations (10) to (12).
//!
//! Each body has the six coordinates of equation (10), joints hold it with stiffness and damping in six directions
//! at a point, and each axis pushes at its screw, which need not lead through a centre of gravity. [`assembly`]
//! makes M·q″ + D·q′ + K·q = B·f of it, for small displacements about the present axis positions; [`modes`] are its
//! natural frequencies, [`talk`] is what an acceleration displaces at the tool; the crate `plant` steps it.

pub mod assembly;
pub mod modes;
pub mod talk;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

pub use assembly::Assembly;

/// No machine has a greater mass (kg), stiffness (N/µm), damping (N·s/mm), or inertia (kg·m²).
const GREATEST: f64 = 1e9;

/// No machine is longer, mm.
const LONGEST_MM: f64 = 1e6;

/// What joints and axes call the floor.
pub const GROUND: &str = "ground";

/// Bodies, what holds them, what drives them, and where they are looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    /// By name.
    pub body: IndexMap<String, Body>,
    /// Between bodies, or a body and the ground.
    pub joint: Vec<Joint>,
    /// By name.
    pub axis: IndexMap<String, Axis>,
    /// The tool point.
    pub tool: Point,
    /// What it is measured against.
    pub workpiece: Point,
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Mass.
    pub mass_kg: f64,
    /// About the centre of gravity: the tensor's xx, yy, zz, xy, xz, yz elements (products of inertia with the
    /// tensor's sign).
    pub inertia_kg_m2: [f64; 6],
    /// Centre of gravity.
    pub centre_mm: [f64; 3],
}

/// What a joint is, by which a part of the structure can be named.
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

/// Elastic contact of two bodies at some points, the same at each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// What it is.
    pub kind: JointKind,
    /// A body, or "ground".
    pub from: String,
    /// A body, or "ground".
    pub to: String,
    /// Where it holds.
    pub at_mm: Vec<[f64; 3]>,
    /// Along x, y, z at each point.
    pub stiffness_n_per_um: [f64; 3],
    /// Along x, y, z at each point.
    #[serde(default)]
    pub damping_n_s_per_mm: [f64; 3],
    /// About x, y, z at each point.
    #[serde(default)]
    pub angular_stiffness_nm_per_mrad: [f64; 3],
    /// About x, y, z at each point.
    #[serde(default)]
    pub angular_damping_nm_s_per_rad: [f64; 3],
}

/// A driven direction: motor and screw between two bodies, and a scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// The body with the motor, or "ground".
    pub from: String,
    /// The body with the nut.
    pub to: String,
    /// Which way `to` goes against `from` for a positive command; of any length.
    pub direction: [f64; 3],
    /// A point of the screw's line: there the drive pushes `to`, and back on `from`.
    pub at_mm: [f64; 3],
    /// A point of the scale's line.
    pub scale_at_mm: [f64; 3],
    /// Motor and screw, reflected to the table.
    pub motor_mass_kg: f64,
    /// Of screw, nut and bearings.
    pub stiffness_n_per_um: f64,
    /// Along the screw.
    #[serde(default)]
    pub damping_n_s_per_mm: f64,
}

/// A point of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// A body, or "ground".
    pub body: String,
    /// Where.
    pub at_mm: [f64; 3],
}

/// A group of parts whose data may be wrong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Stiffness of all joints of a kind.
    Joints(JointKind),
    /// Stiffness of the screws.
    Screws,
    /// Masses and moments of inertia of the bodies.
    Masses,
}

/// What a structure cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StructureError {
    /// A number is no number, or has the wrong sign.
    #[error("{key}: expected {expected}, found {found}")]
    Number {
        /// Which.
        key: String,
        /// What was expected.
        expected: &'static str,
        /// What it is.
        found: f64,
    },
    /// A name that no body has.
    #[error("{key}: no body is called \"{name}\"")]
    NoBody {
        /// Where it is named.
        key: String,
        /// The name.
        name: String,
    },
    /// A moment of inertia is greater than the other two together, or a product too large.
    #[error("body.{0}.inertia_kg_m2: no body has these moments of inertia")]
    Inertia(String),
    /// With its axes held it can still move.
    #[error("the joints leave a body loose in a direction that no axis drives")]
    Loose,
    /// An axis drives against a joint, or against another axis.
    #[error("an axis drives in a direction that a joint, or another axis, holds")]
    Stuck,
    /// Something that leads from a body to itself.
    #[error("{0}: expected another body than in from")]
    Itself(String),
    /// An axis that the tool does not feel.
    #[error("axis.{0}: does not move the tool against the workpiece")]
    Idle(String),
}

impl Structure {
    /// The same with stiffness, or mass, of a part multiplied.
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

    /// Whether it can be built.
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
    /// The tensor of inertia about the centre of gravity, kg·m².
    #[must_use]
    pub fn inertia(&self) -> nalgebra::Matrix3<f64> {
        let [xx, yy, zz, xy, xz, yz] = self.inertia_kg_m2;
        nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// Positive, and no principal moment greater than the other two together.
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
