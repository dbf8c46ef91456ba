//! The settings of one axis as declared: controller, filters, limits, mechanics, sensors.
//!
//! In a machine file they are flat keys of the table `[axis.NAME]`. The module `keys` declares each key once, the module `tolerated`
//! those that can have a tolerance. The structs in this module, the list [`KEYS`], and the table of the file in [`crate::machine`] are
//! generated from them.

mod keys;
mod per_notch;
mod per_point;
mod tolerated;

pub(crate) use keys::axis_keys;
pub use per_notch::PerNotch;
pub use per_point::PerPoint;
pub(crate) use tolerated::tolerated_keys;
pub use tolerated::{TOLERATED, Tolerances, Tolerated, is_mass};

use files::log::Unit;
use serde::{Deserialize, Serialize};
use shared::config::{Brake, GantrySettings};
use shared::units::TRAVEL_LIMIT_M;

use crate::friction_curve::Curve;
use crate::range::Range::{self, NotNegative, Positive, UpTo};

/// Full steps per turn of most stepper motors: 1.8° each.
const USUAL_FULL_STEPS: u32 = 200;

/// Control law of the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// Proportional.
    P,
    /// High-order position control: a second-order filter before the gain.
    Hpc,
}

impl Law {
    /// Its usual name.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::P => "P",
            Self::Hpc => "HPC",
        }
    }
}

/// What the position loop commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// The force of the motor, by the declared velocity loop.
    #[default]
    Torque,
    /// The velocity of a drive of unknown bandwidth. Neither its gains nor the masses are needed.
    Velocity,
    /// The position of a stepper motor, in microsteps: there is no loop.
    Stepper,
}

impl Drive {
    /// All kinds.
    pub const ALL: &'static [Self] = &[Self::Torque, Self::Velocity, Self::Stepper];

    /// Its name in a machine file.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Velocity => "velocity",
            Self::Stepper => "stepper",
        }
    }
}

/// Position feedback of the controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Feedback {
    /// Motor reading.
    #[default]
    Motor,
    /// Table scale.
    Table,
    /// Motor reading + low-pass(table − motor).
    Dual,
}

impl Feedback {
    /// Its name in a machine file.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Motor => "motor",
            Self::Table => "table",
            Self::Dual => "dual",
        }
    }
}

/// The name of another axis.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct AxisName(pub String);

/// Which names the keys of an axis have in its file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KeyNames {
    /// Names of linear axes: N, mm, kg. In a file of a rotary axis, with degrees for mm, N·m for N and 1000° for a metre.
    #[default]
    Linear,
    /// Names of rotary axes: N·m, degrees, kg·m².
    Rotary,
}

impl KeyNames {
    /// The unit of the channels of such an axis in a log.
    #[must_use]
    pub const fn log_unit(self) -> Unit {
        match self {
            Self::Linear => Unit::Millimetre,
            Self::Rotary => Unit::Degree,
        }
    }
}

/// A key of an `[axis.NAME]` table.
pub struct Key {
    /// Name of the key in the file.
    pub name: &'static str,
    /// Name of its group in [`Settings`].
    pub group: &'static str,
    /// Range of the number; `None`: the value is not a number.
    pub range: Option<Range>,
    /// Whether an axis declares the key.
    pub is_given: fn(&Settings) -> bool,
    /// Numbers declared by an axis: one, or one for each notch or point.
    pub numbers: fn(&Settings) -> Vec<f64>,
}

/// Type of the field of a key: an `Option`, or a value with a default.
pub(crate) trait Field {
    /// Whether the key is given.
    fn is_given(&self) -> bool;

    /// Whether the key is left out of a written file.
    fn is_absent(&self) -> bool {
        !self.is_given()
    }

    /// The declared numbers, if the value is a number or a list with a range.
    fn numbers(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// Type of a key's value.
pub(crate) trait Value {
    /// The value as a number, or as one for each notch.
    fn numbers(&self) -> Vec<f64> {
        Vec::new()
    }
}

impl Value for f64 {
    fn numbers(&self) -> Vec<f64> {
        vec![*self]
    }
}

impl Value for u32 {
    fn numbers(&self) -> Vec<f64> {
        vec![f64::from(*self)]
    }
}

impl Value for PerNotch {
    fn numbers(&self) -> Vec<f64> {
        self.0.clone()
    }
}

impl Value for PerPoint {
    fn numbers(&self) -> Vec<f64> {
        self.0.clone()
    }
}

impl Value for [f64; 2] {}
impl Value for Law {}
impl Value for AxisName {}
impl Value for Curve {}
impl Value for Tolerances {}

impl<T: Value> Field for Option<T> {
    fn is_given(&self) -> bool {
        self.is_some()
    }

    fn numbers(&self) -> Vec<f64> {
        self.as_ref().map(Value::numbers).unwrap_or_default()
    }
}

impl Field for Drive {
    fn is_given(&self) -> bool {
        *self != Self::Torque
    }
}

impl Field for Feedback {
    /// A written file always contains this key.
    fn is_given(&self) -> bool {
        true
    }
}

/// The name of a key in the file.
macro_rules! file_name {
    ($field:ident) => {
        stringify!($field)
    };
    ($field:ident $key:literal) => {
        $key
    };
}

/// The range of a key, if it has one.
macro_rules! range {
    () => {
        None
    };
    ($range:expr) => {
        Some($range)
    };
}

/// Declares the structs of the settings and the list of their keys.
macro_rules! settings {
    ($(
        $(#[$group_doc:meta])*
        $group:ident: $Group:ident {
            $($(#[$doc:meta])* $field:ident $(($key:literal))?: $type:ty $([$range:expr])?,)+
        }
    )+) => {
        /// The declared settings of an axis. An absent value is unknown, or the component does not exist.
        ///
        /// Without the keys of the controller the motor stage is not modelled; without masses the force stage is not.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Settings {
            /// The names of the keys in the file.
            pub names: KeyNames,
            $(
                $(#[$group_doc])*
                pub $group: $Group,
            )+
        }

        $(
            $(#[$group_doc])*
            #[derive(Clone, Debug, Default, PartialEq)]
            pub struct $Group { $(
                $(#[$doc])*
                pub $field: $type,
            )+ }
        )+

        /// All keys, in the order of a written file.
        pub const KEYS: &[Key] = &[$($(Key {
            name: file_name!($field $($key)?),
            group: stringify!($group),
            range: range!($($range)?),
            is_given: |settings| settings.$group.$field.is_given(),
            numbers: |settings| settings.$group.$field.numbers(),
        },)+)+];
    };
}

axis_keys!(settings);

impl Mechanics {
    /// The stiffness between motor and table, if both masses are known.
    #[must_use]
    pub const fn spring_n_per_um(&self) -> Option<f64> {
        match (self.motor_mass_kg, self.table_mass_kg) {
            (Some(_), Some(_)) => self.stiffness_n_per_um,
            _ => None,
        }
    }
}

impl Settings {
    /// Whether a mass above zero is declared.
    #[must_use]
    pub fn has_mass(&self) -> bool {
        self.mechanics.motor_mass_kg.unwrap_or(0.0) + self.mechanics.table_mass_kg.unwrap_or(0.0) > 0.0
    }

    /// Whether the file says what forces stretch the drive train, or how far: by masses or by the stiffness.
    #[must_use]
    pub fn has_drive_train(&self) -> bool {
        self.has_mass() || !self.is_rigid()
    }

    /// Relative tolerance of a declared value, by its key; 0: it is exact.
    #[must_use]
    pub fn tolerance(&self, key: &str) -> f64 {
        Tolerated::with_key(key).map_or(0.0, |value| value.tolerance(self))
    }

    /// These settings with exact values.
    #[must_use]
    pub fn without_tolerances(mut self) -> Self {
        self.mechanics.plant_tolerance_percent = None;
        self.mechanics.tolerance_percent = None;
        self
    }

    /// Travel of four full steps of a stepper motor, mm; `None` without a lead.
    #[must_use]
    pub fn four_full_steps_mm(&self) -> Option<f64> {
        let steps = self.mechanics.full_steps_per_turn.unwrap_or(USUAL_FULL_STEPS);
        Some(4.0 * self.mechanics.lead_mm? / f64::from(steps))
    }

    /// Whether motor and table are one mass, or what is between them cannot be simulated: without both masses, a stiffness says nothing.
    #[must_use]
    pub const fn is_rigid(&self) -> bool {
        self.mechanics.spring_n_per_um().is_none()
    }
}
