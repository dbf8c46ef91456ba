//! Tables that a trace adds to fitted values, so that tracing the same logs with the written file gives the same result:
//! the centres of the tolerances, and the zeros and sampling instants of the logs.

use serde::{Deserialize, Serialize};

use super::number_table::number_table;
use crate::axis::Settings;
use crate::effects::{Effect, Windup};

/// A fitted mass or stiffness may deviate from its nominal value by up to this many tolerances. One that is farther off has
/// a wrong unit or belongs to another machine.
pub const MAX_TOLERANCES: f64 = 4.0;

/// How many tolerances friction may move by: it changes with load, temperature and age, and which few users know as well as they declare.
const MAX_FRICTION_TOLERANCES: f64 = 10.0;

/// A declared value that a fit may move: a mechanical one, to which `plant_tolerance_percent` applies, or a setting of the controller,
/// which is exact unless `tolerance_percent` says otherwise.
pub struct Tolerated {
    /// Key in the table of the axis and in its `nominal` table.
    pub key: &'static str,
    /// The value of an axis.
    pub get: fn(&Settings) -> Option<f64>,
    /// Sets the value of an axis.
    pub set: fn(&mut Settings, f64),
    /// Leaves the value of an axis unknown.
    pub clear: fn(&mut Settings),
    /// The value in a `nominal` table.
    pub nominal: fn(&Nominal) -> Option<f64>,
    /// Sets the value in a `nominal` table.
    pub set_nominal: fn(&mut Nominal, f64),
    /// The tolerance of this value alone, percent, if it is declared.
    pub own_tolerance_percent: fn(&Tolerances) -> Option<f64>,
    /// Sets the tolerance of this value alone, percent.
    pub set_tolerance_percent: fn(&mut Tolerances, f64),
    /// Whether the value is a setting of the controller.
    pub is_of_controller: bool,
}

impl Tolerated {
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

    /// The range in which a fit may move a value, from its nominal value and its relative tolerance: up to
    /// [`MAX_TOLERANCES`] in either direction, as a factor, friction further. A lower stiffness is the effect `windup`.
    #[must_use]
    pub fn range(&self, nominal: f64, tolerance: f64) -> [f64; 2] {
        if self.is_poorly_determined() {
            return [nominal * (1.0 - tolerance), nominal * (1.0 + tolerance)];
        }
        let is_friction = ["coulomb_n", "viscous_n_s_per_m", "motor_coulomb_n"].contains(&self.key);
        let most = if is_friction { MAX_FRICTION_TOLERANCES } else { MAX_TOLERANCES };
        let factor = 1.0 + most * tolerance;
        let least = nominal / factor;
        let is_stiffness = self.key == "stiffness_n_per_um";
        let least = if is_stiffness { least.max(Windup::max_stiffness(nominal, tolerance)) } else { least };
        [least, nominal * factor]
    }
}

macro_rules! tolerated {
    ($($group:ident ($is_of_controller:literal): $($key:ident),+;)+) => {
        /// `[axis.NAME.nominal]`: the values before a trace fitted them. Tolerances are centred on them, so that repeated fits do not
        /// drift away. An absent value is equal to that of the axis.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Nominal {
            $($(
                #[doc = concat!("Nominal value of `", stringify!($key), "`.")]
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $key: Option<f64>,
            )+)+
            /// Nominal values of the first effects of the axis, in the same order. Further effects have none.
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            pub effect: Vec<Effect>,
        }

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
            nominal: |nominal| nominal.$key,
            set_nominal: |nominal, value| nominal.$key = Some(value),
            own_tolerance_percent: |tolerances| tolerances.$key,
            set_tolerance_percent: |tolerances, percent| tolerances.$key = Some(percent),
            is_of_controller: $is_of_controller,
        },)+)+];
    };
}

tolerated! {
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

number_table! {
    /// `[axis.NAME.log_offsets]`: zeros and sampling instants of the logs to which the values of an axis were fitted. They
    /// are the initial values when a trace fits them again, and have no other use. An absent value is 0.
    LogOffsets {
        /// Zero of the linear scale relative to that of the motor.
        table_zero_um,
        /// Zero of the tool-point probe relative to that of the table.
        tool_zero_um,
        /// Delay of the linear scale relative to the motor; negative: early.
        table_late_ms,
        /// Delay of the tool-point probe relative to the scale; negative: early.
        tool_late_ms,
        /// Delay of the logged force relative to the motor; negative: early.
        force_late_ms,
        /// Age of the velocity in the velocity loop, in addition to that of a backward difference.
        speed_late_ms,
        /// Delay of the drive's force relative to the reading of the sensors; negative: early.
        drive_late_ms,
        /// Step of the controller's filter; 0: exact discretization.
        filter_step_ms,
        /// Time constant of a drive whose velocity is commanded.
        velocity_time_constant_ms,
        /// Rate 1/Ti of the integral part of such a drive.
        velocity_integral_per_s,
        /// Coulomb friction over the moved mass, of a drive whose velocity is commanded.
        velocity_friction_m_per_s2,
        /// Dead time of a drive whose velocity or position is commanded.
        drive_dead_time_ms,
    }
}
