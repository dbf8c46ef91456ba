//! Declared values that a fit may move within a tolerance.

use serde::{Deserialize, Serialize};

use super::Settings;

/// A declared value that a fit may move: a mechanical one, to which `plant_tolerance_percent` applies, or a setting of the controller,
/// which is exact unless `tolerance_percent` says otherwise.
pub struct Tolerated {
    /// Key in the table of the axis, in its `nominal` table and in its `tolerance_percent` table.
    pub key: &'static str,
    /// The value of an axis.
    pub get: fn(&Settings) -> Option<f64>,
    /// Sets the value of an axis.
    pub set: fn(&mut Settings, f64),
    /// Leaves the value of an axis unknown.
    pub clear: fn(&mut Settings),
    /// The tolerance of this value alone, percent, if it is declared.
    pub own_tolerance_percent: fn(&Tolerances) -> Option<f64>,
    /// Sets the tolerance of this value alone, percent.
    pub set_tolerance_percent: fn(&mut Tolerances, f64),
    /// Whether the value is a setting of the controller.
    pub is_of_controller: bool,
}

impl Tolerated {
    /// The value with a key.
    #[must_use]
    pub fn with_key(key: &str) -> Option<&'static Self> {
        TOLERATED.iter().find(|value| value.key == key)
    }

    /// The relative tolerance of the value on an axis; 0: it is exact.
    #[must_use]
    pub fn tolerance(&self, settings: &Settings) -> f64 {
        let mechanics = &settings.mechanics;
        let of_all = mechanics.plant_tolerance_percent.filter(|_| !self.is_of_controller);
        let own = mechanics.tolerance_percent.as_ref().and_then(|table| (self.own_tolerance_percent)(table));
        0.01 * own.or(of_all).unwrap_or(0.0)
    }

    /// Whether few motions determine the value: damping and presliding. A fit would move it to compensate errors of the
    /// simulation, so that it stays within its tolerance.
    #[must_use]
    pub fn is_poorly_determined(&self) -> bool {
        ["damping_n_s_per_m", "presliding_stiffness_n_per_um", "presliding_damping_n_s_per_m"]
            .contains(&self.key)
    }

    /// Whether the value is a mass.
    #[must_use]
    pub fn is_mass(&self) -> bool {
        is_mass(self.key)
    }
}

/// Whether a key of the machine file is that of a mass.
#[must_use]
pub fn is_mass(key: &str) -> bool {
    ["motor_mass_kg", "table_mass_kg"].contains(&key)
}

/// Calls the macro `$then` with the keys of all values that can have a tolerance, by the group of the settings, with a flag whether they
/// are settings of the controller: those of the mechanics first.
macro_rules! tolerated_keys {
    ($then:ident) => {
        $then! {
            mechanics (false):
                motor_mass_kg,
                table_mass_kg,
                stiffness_n_per_um,
                damping_n_s_per_m,
                coulomb_n,
                viscous_n_s_per_m,
                motor_coulomb_n,
                presliding_stiffness_n_per_um,
                presliding_damping_n_s_per_m;
            controller (true):
                position_gain_per_s,
                feedforward_percent,
                velocity_gain_n_s_per_m,
                velocity_integral_time_s;
            sensors (true):
                dual_feedback_time_constant_s;
        }
    };
}

pub(crate) use tolerated_keys;

macro_rules! tolerated {
    ($($group:ident ($is_of_controller:literal): $($key:ident),+;)+) => {
        /// `[axis.NAME.tolerance_percent]`: tolerances of single values, percent, in place of `plant_tolerance_percent`. A setting of
        /// the controller without one is exact.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Tolerances {
            $($(
                #[doc = concat!("Tolerance of `", stringify!($key), "`, percent.")]
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $key: Option<f64>,
            )+)+
        }

        /// All values that can have a tolerance: those of the mechanics, then the settings of the controller.
        pub const TOLERATED: &[Tolerated] = &[$($(Tolerated {
            key: stringify!($key),
            get: |settings| settings.$group.$key,
            set: |settings, value| settings.$group.$key = Some(value),
            clear: |settings| settings.$group.$key = None,
            own_tolerance_percent: |tolerances| tolerances.$key,
            set_tolerance_percent: |tolerances, percent| tolerances.$key = Some(percent),
            is_of_controller: $is_of_controller,
        },)+)+];
    };
}

tolerated_keys!(tolerated);
